#include <cmath>
#include <cstring>

#include "core/io/cloud_files.h"
#include "tests/fuzz/fuzz_target.h"

namespace ca2::fuzz {
namespace {

std::string npy(const std::string& dictionary, const std::string& body) {
  return std::string("\2\x93NUMPY\1\0", 9) + static_cast<char>(dictionary.size()) + '\0' + dictionary + body;
}

}  // namespace

/// The first byte chooses the format.
std::vector<std::string> seeds() {
  const std::string ply = std::string(1, '\0') + "ply\nformat ";
  const std::string vertices =
      " 1.0\nelement vertex 2\nproperty float x\nproperty double y\nproperty float z\nproperty uchar "
      "intensity\nproperty short ring\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
  return {ply + "ascii" + vertices + "1 2 3 4 5\n1e3 nan -2 0 65535\n",
          ply + "binary_little_endian" + vertices + std::string(38, '\x41'),
          "\1ring;intensity;x;y;z\n1;2;3;4;5\n2;;nan;+1;0\n",
          "\1# made by hand\n1 2 3\n\"4\"\t5 6\r\n",
          "\1"
          "1,2,3,4\n1e30,inf,-1,0\n",
          npy("{'descr': '<f4', 'fortran_order': False, 'shape': (2, 4), }", std::string(32, '\x40')),
          npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }", std::string(24, '\x40'))};
}

}  // namespace ca2::fuzz

/// Whatever is read is a consistent scan.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using ca2::fuzz::require;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto scan = data[0] % 3 == 0   ? ca2::parse_ply(text, "input")
                    : data[0] % 3 == 1 ? ca2::parse_cloud_csv(text, "input")
                                       : ca2::parse_npy(text, "input");
  if (!scan) {
    require(!scan.error().problems.empty(), "an error without a problem");
    return 0;
  }
  require(scan->ring.empty() || scan->ring.size() == scan->size(), "rings");
  require(scan->intensity.empty() || scan->intensity.size() == scan->size(), "intensities");
  for (const Eigen::Vector3f& p : scan->points)
    require(p.allFinite() || p.array().isNaN().all(), "a point half NaN");
  return 0;
}
