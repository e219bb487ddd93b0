#include "core/board/types/aprilgrid_prints.h"

extern "C" {
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
}

#include <memory>

namespace ca2 {

const AprilPrints& aprilgrid_prints() {
  static const AprilPrints all = [] {
    const std::unique_ptr<apriltag_family_t, decltype(&tag36h11_destroy)> family(tag36h11_create(),
                                                                                 &tag36h11_destroy);
    AprilPrints list(family->ncodes);
    for (std::uint32_t id = 0; id < family->ncodes; ++id) {
      for (std::uint32_t i = 0; i < family->nbits; ++i) {
        const bool white = ((family->codes[id] >> (family->nbits - 1 - i)) & 1) != 0;
        // The library's own tags have a border of one cell.
        list[id][family->bit_y[i] + aprilgrid_border - 1][family->bit_x[i] + aprilgrid_border - 1] = white;
      }
    }
    return list;
  }();
  return all;
}

}  // namespace ca2
