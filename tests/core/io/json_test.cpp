#include "core/io/json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace ca2 {
namespace {

std::string nested(std::size_t depth) {
  return std::string(depth, '[') + std::string(depth, ']');
}

TEST(Json, NestsAsDeepAsItMay) {
  EXPECT_FALSE(parse_json(nested(max_json_depth)).is_discarded());
  EXPECT_TRUE(parse_json(nested(max_json_depth + 1)).is_discarded());
  EXPECT_TRUE(parse_json(R"({"a": )" + nested(max_json_depth) + "}").is_discarded());
  EXPECT_TRUE(parse_json(nested(2'000'000)).is_discarded());
  // Beside one another is not inside one another.
  std::string wide = "[1";
  for (int i = 0; i < 1000; ++i) wide += R"(,[{"a": [2]}])";
  EXPECT_EQ(parse_json(wide + "]").size(), 1001u);
}

TEST(Json, BracketsInStringsDoNotNest) {
  const std::string text = std::string(100, '[') + R"(\"\\)" + std::string(100, '{');
  const auto read = parse_json("[\"" + text + "\", [\"\\\\\"]]");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0], std::string(100, '[') + "\"\\" + std::string(100, '{'));
}

TEST(Json, WhatIsNoneIsDiscarded) {
  for (const char* text : {"", "{", "]]", "[\"", "[\"\\", "nul", "\xff"})
    EXPECT_TRUE(parse_json(text).is_discarded()) << text;
}

}  // namespace
}  // namespace ca2
