/// @file Keys and signatures.
#include "messages/signing.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <ca2/command_v1_t.hpp>
#include <ca2/reply_v1_t.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

command_v1_t example() {
  command_v1_t command;
  command.utime = 1'700'000'000'000'000;
  command.sender = "pilot";
  command.target = "robot";
  command.sequence = 7;
  command.command = "capture";
  command.arguments = "{}";
  std::memset(command.code, 0, sizeof(command.code));
  return command;
}

class Signing : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
};

TEST_F(Signing, AKeyIsPrivateAndReadsBack) {
  const auto file = directory_ / "pilot.key";
  const Result<NamedKey> made = make_key(file);
  ASSERT_TRUE(made) << made.error().text();
  EXPECT_EQ(made->sender, "pilot");
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  const Result<NamedKey> read = read_key(file);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->key, made->key);
  EXPECT_NE(made->key, SigningKey{});
  // Never overwritten: who has the old one would be shut out.
  EXPECT_EQ(make_key(file).error().code, ErrorCode::cannot_create);
  EXPECT_NE(make_key(directory_ / "other.key")->key, made->key);
}

TEST_F(Signing, OpenOrDamagedKeysAreRefused) {
  const auto file = directory_ / "pilot.key";
  ASSERT_TRUE(make_key(file));
  ::chmod(file.c_str(), 0644);
  EXPECT_EQ(read_key(file).error().code, ErrorCode::config);
  for (const std::string& text : {std::string(), std::string(63, 'a'), std::string(64, 'g'),
                                  std::string(66, 'a'), std::string(64, 'a') + "\nmore"}) {
    const auto damaged = directory_ / "damaged.key";
    std::ofstream(damaged) << text;
    ::chmod(damaged.c_str(), 0600);
    EXPECT_EQ(read_key(damaged).error().code, ErrorCode::config) << text;
  }
  EXPECT_EQ(make_key(directory_ / "pilot.txt").error().code, ErrorCode::usage);
  EXPECT_EQ(make_key(directory_ / "a b.key").error().code, ErrorCode::usage);
}

TEST_F(Signing, EveryFieldIsUnderTheCode) {
  const Result<NamedKey> key = make_key(directory_ / "pilot.key");
  command_v1_t command = example();
  EXPECT_FALSE(verify(key->key, command));
  sign(key->key, command);
  EXPECT_TRUE(verify(key->key, command));
  const auto changed = [&](auto change) {
    command_v1_t other = command;
    change(other);
    return verify(key->key, other);
  };
  EXPECT_FALSE(changed([](auto& c) { ++c.utime; }));
  EXPECT_FALSE(changed([](auto& c) { c.sender = "pilor"; }));
  EXPECT_FALSE(changed([](auto& c) { c.target = "robos"; }));
  EXPECT_FALSE(changed([](auto& c) { ++c.sequence; }));
  EXPECT_FALSE(changed([](auto& c) { c.command = "drop"; }));
  EXPECT_FALSE(changed([](auto& c) { c.arguments = "{ }"; }));
  EXPECT_FALSE(changed([](auto& c) { c.code[31] ^= 1; }));
  EXPECT_FALSE(verify(make_key(directory_ / "other.key")->key, command));
}

TEST_F(Signing, RepliesToo) {
  const Result<NamedKey> key = make_key(directory_ / "pilot.key");
  reply_v1_t reply{};
  reply.utime = 5;
  reply.sender = "pilot";
  reply.reply = "{}";
  sign(key->key, reply);
  EXPECT_TRUE(verify(key->key, reply));
  reply.reply = "{ }";
  EXPECT_FALSE(verify(key->key, reply));
}

}  // namespace
}  // namespace ca2
