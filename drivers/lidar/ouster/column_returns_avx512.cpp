// Sixteen rows at a time, which stay in registers until they are written.
#include "drivers/lidar/ouster/column_returns.h"
#include "drivers/lidar/write_sixteens.h"

#if defined(__x86_64__)
namespace ca2::detail {
namespace {

template <bool upright>
CA2_AVX512 std::size_t write_rows(const OusterGeometry& geometry, std::size_t column, const FiredNames& names,
                                  const ReturnTargets& out, std::size_t at) {
  const float *const a_rows = geometry.a_lanes.data(), *const b_rows = geometry.b_lanes.data(),
                     *const c_rows = geometry.c_lanes.data();
  const Eigen::Matrix3f& M = geometry.columns[column].turn;
  const Eigen::Vector3f& base = geometry.columns[column].base;
  const __m512 m00 = _mm512_set1_ps(M(0, 0)), m01 = _mm512_set1_ps(M(0, 1)), m02 = _mm512_set1_ps(M(0, 2)),
               m10 = _mm512_set1_ps(M(1, 0)), m11 = _mm512_set1_ps(M(1, 1)), m12 = _mm512_set1_ps(M(1, 2)),
               m20 = _mm512_set1_ps(M(2, 0)), m21 = _mm512_set1_ps(M(2, 1)), m22 = _mm512_set1_ps(M(2, 2));
  const __m512 base_x = _mm512_set1_ps(base.x()), base_y = _mm512_set1_ps(base.y()),
               base_z = _mm512_set1_ps(base.z());
  const __m512 origin = _mm512_set1_ps(static_cast<float>(geometry.origin_range));
  const __m512 thousand = _mm512_set1_ps(1000);
  const auto places = [&](int row, __mmask16 here, __m512i millimetres) CA2_AVX512 {
    const __m512 a = _mm512_maskz_loadu_ps(here, a_rows + row), b = _mm512_maskz_loadu_ps(here, b_rows + row),
                 c = _mm512_maskz_loadu_ps(here, c_rows + row);
    const __m512 range = _mm512_maskz_cvtepi32_ps(0xffff, millimetres) / thousand;
    const __m512 p = range - origin;
    __m512 x = m00 * a + m01 * b, y = m10 * a + m11 * b, z = c;
    if constexpr (!upright) {
      x = x + m02 * c;
      y = y + m12 * c;
      z = m20 * a + m21 * b + m22 * c;
    }
    return SixteenPlaces{p * x + base_x, p * y + base_y, p * z + base_z, range};
  };
  const auto beams = [&](int row, __mmask16 here) CA2_AVX512 { return load_sixteen(names, row, here); };
  return write_sixteens<false>(names, out, at, beams, places);
}

}  // namespace

CA2_AVX512 std::size_t write_ouster_column_avx512(const OusterGeometry& geometry, std::size_t column,
                                                  const FiredNames& names, const ReturnTargets& out,
                                                  std::size_t at) {
  return geometry.columns[column].upright ? write_rows<true>(geometry, column, names, out, at)
                                          : write_rows<false>(geometry, column, names, out, at);
}

}  // namespace ca2::detail
#endif
