// Sixteen beams at a time, whose places are in memory.
#include "drivers/lidar/write_sixteens.h"

#if defined(__x86_64__)
namespace ca2::detail {

CA2_AVX512 std::size_t write_returns_avx512(const FiredBeams& beams, const FiredNames& names,
                                            const ReturnTargets& out, std::size_t at) {
  const auto places = [&](int i, __mmask16 here, __m512i) CA2_AVX512 {
    const auto load = [&](const float* from)
                          CA2_AVX512 { return _mm512_maskz_loadu_ps(here, from + names.first + i); };
    return SixteenPlaces{load(beams.x), load(beams.y), load(beams.z), load(beams.range)};
  };
  const auto beams_of = [&](int i, __mmask16 here) CA2_AVX512 { return load_sixteen(names, i, here); };
  return names.delay ? write_sixteens<true>(names, out, at, beams_of, places)
                     : write_sixteens<false>(names, out, at, beams_of, places);
}

}  // namespace ca2::detail
#endif
