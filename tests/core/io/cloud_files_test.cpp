/// @file Clouds in the formats of others, damaged; whole ones are in tests/tools/ca2/import_command_test.cpp.
#include "core/io/cloud_files.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

/// Blanks separate where there is no comma: of such a line nothing is left.
TEST(CloudCsv, ALineOfQuotesHasNoNumbers) {
  for (const char* text : {"\"\n", "\"\" \"\"\n1 2 3\n", "# made by hand\n\"\r\n"}) {
    const auto scan = parse_cloud_csv(text, "scan.csv");
    ASSERT_FALSE(scan) << text;
    EXPECT_NE(scan.error().text().find("fewer than three numbers"), std::string::npos) << scan.error().text();
  }
}

TEST(CloudPly, ARingThatIsNoNumberIsRingZero) {
  const auto scan = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float ring\nend_header\n1 2 3 nan\n1 2 3 inf\n1 2 3 7\n",
      "scan.ply");
  ASSERT_TRUE(scan) << scan.error().text();
  EXPECT_EQ(scan->ring, (std::vector<std::uint16_t>{0, 0, 7}));
}

}  // namespace
}  // namespace ca2
