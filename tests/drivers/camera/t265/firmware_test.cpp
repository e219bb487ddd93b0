#include "drivers/camera/t265/firmware.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temporary_directory.h"

namespace ca2::t265 {
namespace {

TEST(T265Firmware, IsKnownByItsSha1) {
  const test::TemporaryDirectory directory;
  const auto file = directory / "firmware.mvcmd";
  std::ofstream(file) << "abc";
  // FIPS 180's example.
  const auto good = read_firmware(file, "A9993E364706816ABA3E25717850C26C9CD0D89D");
  ASSERT_TRUE(good) << good.error().text();
  EXPECT_EQ(*good, "abc");
  const auto wrong = read_firmware(file);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::config);
  const std::string text = wrong.error().text();
  EXPECT_NE(text.find("a9993e364706816aba3e25717850c26c9cd0d89d"), std::string::npos) << text;
  EXPECT_NE(text.find(firmware_sha1), std::string::npos) << text;
}

TEST(T265Firmware, WhereItComesFromIsSaidWhenItIsAbsent) {
  const auto absent = read_firmware("/nowhere/target.mvcmd");
  ASSERT_FALSE(absent);
  const std::string text = absent.error().text();
  EXPECT_NE(text.find("/nowhere/target.mvcmd"), std::string::npos) << text;
  EXPECT_NE(text.find("target-0.2.0.951.mvcmd"), std::string::npos) << text;
  EXPECT_NE(text.find("librealsense"), std::string::npos) << text;
}

}  // namespace
}  // namespace ca2::t265
