/// @file A released LCM type is never edited: what is in the field would no longer understand it.
#include <gtest/gtest.h>

#include <ca2/command_v1_t.hpp>
#include <ca2/extrinsics_v1_t.hpp>
#include <ca2/preview_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>
#include <ca2/status_v1_t.hpp>
#include <ca2/view_v1_t.hpp>
#include <cinttypes>
#include <filesystem>
#include <fstream>
#include <map>

#include "core/types/text.h"

namespace ca2 {
namespace {

template <class Type>
std::pair<std::string, std::string> fingerprint() {
  return {Type::getTypeName(), formatted("%016" PRIx64, Type::getHash())};
}

const std::filesystem::path messages = std::filesystem::path(CA2_SOURCE_DIR) / "messages";

TEST(Fingerprints, NoReleasedTypeHasMoved) {
  const std::map<std::string, std::string> now{
      fingerprint<command_v1_t>(), fingerprint<extrinsics_v1_t>(), fingerprint<pose_v1_t>(),
      fingerprint<preview_v1_t>(), fingerprint<reply_v1_t>(),      fingerprint<sensor_v1_t>(),
      fingerprint<status_v1_t>(),  fingerprint<transform_v1_t>(),  fingerprint<view_v1_t>()};
  std::ifstream file(messages / "fingerprints.txt");
  std::map<std::string, std::string> golden;
  for (std::string name, value; file >> name >> value;) golden[name] = value;
  EXPECT_EQ(now, golden) << "a changed type needs a new name (status_v2_t); a new one, a line in "
                            "messages/fingerprints.txt";
  for (const auto& entry : std::filesystem::directory_iterator(messages / "lcm")) {
    EXPECT_TRUE(golden.count(entry.path().stem().string())) << entry.path() << " is not checked here";
  }
}

}  // namespace
}  // namespace ca2
