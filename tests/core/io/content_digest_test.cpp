#include "core/io/content_digest.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace ca2 {
namespace {

TEST(ContentDigest, IsTheSameHoweverTheContentIsCut) {
  std::mt19937 random(1);
  std::string content;
  for (int i = 0; i < 1000; ++i) content += static_cast<char>(random());
  const std::uint64_t whole = ContentDigest::of(content);
  for (int round = 0; round < 50; ++round) {
    ContentDigest digest;
    for (std::string_view rest = content; !rest.empty();) {
      const std::size_t size = std::min<std::size_t>(rest.size(), random() % 40);
      digest.add(rest.substr(0, size));
      rest.remove_prefix(size);
    }
    EXPECT_EQ(digest.value(), whole);
  }
  EXPECT_EQ(ContentDigest().value(), ContentDigest::of(""));
}

TEST(ContentDigest, ChangesWithEveryByte) {
  const std::string content = "twenty bytes in all.";
  for (std::size_t i = 0; i < content.size(); ++i) {
    std::string other = content;
    other[i] ^= 1;
    EXPECT_NE(ContentDigest::of(other), ContentDigest::of(content));
    EXPECT_NE(ContentDigest::of(content.substr(0, i)), ContentDigest::of(content));
  }
}

}  // namespace
}  // namespace ca2
