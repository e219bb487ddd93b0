#include "core/io/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>

#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

std::size_t entries(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory), {}));
}

TEST(Files, WritesWholeAndReplaces) {
  const test::TemporaryDirectory directory;
  const auto file = directory / "a.yaml";
  const std::string binary("first\0second\n", 13);
  ASSERT_TRUE(write_atomically(file, binary));
  EXPECT_EQ(read_text(file).value(), binary);
  ASSERT_TRUE(write_atomically(file, "new"));
  EXPECT_EQ(read_text(file).value(), "new");
  EXPECT_EQ(entries(directory.path()), 1u);  // no temporary stays behind
}

TEST(Files, ReadersSeeOldOrNewNeverAMixture) {
  const test::TemporaryDirectory directory;
  const auto file = directory / "a";
  const std::string a(100000, 'a'), b(50000, 'b');
  ASSERT_TRUE(write_atomically(file, a));
  std::thread writer([&] {
    for (int i = 0; i < 30; ++i) EXPECT_TRUE(write_atomically(file, i % 2 ? a : b));
  });
  for (int i = 0; i < 200; ++i) {
    const auto content = read_text(file);
    ASSERT_TRUE(content);
    EXPECT_TRUE(*content == a || *content == b);
  }
  writer.join();
}

TEST(Files, ErrorsNameTheFileAndTheReason) {
  const test::TemporaryDirectory directory;
  const auto missing = read_text(directory / "none");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::io);
  EXPECT_NE(missing.error().text().find("none: cannot be opened: No such file"), std::string::npos);
  EXPECT_EQ(read_text(directory.path()).error().code, ErrorCode::io);
  const auto nowhere = write_atomically(directory / "no" / "where", "x");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, ErrorCode::cannot_create);
  // A directory is in the way: what was there stays, and no temporary is left.
  std::filesystem::create_directory(directory / "taken");
  EXPECT_FALSE(write_atomically(directory / "taken", "x"));
  EXPECT_EQ(entries(directory.path()), 1u);
}

TEST(Files, RefusesWhatIsTooLarge) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(write_atomically(directory / "a", std::string(1000, 'x')));
  EXPECT_TRUE(read_text(directory / "a", 1000));
  EXPECT_EQ(read_text(directory / "a", 999).error().code, ErrorCode::data);
  // A device has no size: the limit must hold all the same.
  EXPECT_EQ(read_text("/dev/zero", 5000).error().code, ErrorCode::data);
}

TEST(Files, NewFilesAreNeverOverwritten) {
  const test::TemporaryDirectory directory;
  ASSERT_TRUE(write_new(directory / "a", "1"));
  const auto again = write_new(directory / "a", "2");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::cannot_create);
  EXPECT_EQ(read_text(directory / "a").value(), "1");
}

}  // namespace
}  // namespace ca2
