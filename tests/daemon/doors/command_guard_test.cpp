/// @file Which signed commands are obeyed.
#include "daemon/doors/command_guard.h"

#include <gtest/gtest.h>

#include <cstring>

namespace ca2 {
namespace {

using Verdict = CommandGuard::Verdict;

constexpr std::int64_t start = 1'700'000'000'000'000, second = 1'000'000;  // us

SigningKey key_of(std::uint8_t byte) {
  SigningKey key;
  key.fill(byte);
  return key;
}

command_v1_t command(std::int64_t time, std::int64_t sequence, const SigningKey& key) {
  command_v1_t out{};
  out.utime = time;
  out.sender = "pilot";
  out.target = "robot";
  out.sequence = sequence;
  out.command = "capture";
  out.arguments = "{}";
  sign(key, out);
  return out;
}

class Guard : public testing::Test {
 protected:
  CommandGuard guard_{{{"pilot", key_of(1)}, {"copilot", key_of(2)}}, "robot", start};
};

TEST_F(Guard, FreshAndNewIsObeyedOnce) {
  const command_v1_t first = command(start + second, 7, key_of(1));
  EXPECT_EQ(guard_.judge(first, start + 2 * second), Verdict::good);
  EXPECT_EQ(guard_.judge(first, start + 2 * second), Verdict::replayed);
  EXPECT_EQ(guard_.judge(command(start + 2 * second, 6, key_of(1)), start + 2 * second), Verdict::replayed);
  EXPECT_EQ(guard_.judge(command(start + 2 * second, 8, key_of(1)), start + 2 * second), Verdict::good);
  EXPECT_EQ(guard_.refused(), 2u);
}

TEST_F(Guard, TheWindowOfTime) {
  const std::int64_t now = start + 100 * second;
  EXPECT_EQ(guard_.judge(command(now - 6 * second, 1, key_of(1)), now), Verdict::stale);
  EXPECT_EQ(guard_.judge(command(now + 6 * second, 2, key_of(1)), now), Verdict::stale);
  EXPECT_EQ(guard_.judge(command(now - 4 * second, 3, key_of(1)), now), Verdict::good);
  EXPECT_EQ(guard_.judge(command(now + 4 * second, 4, key_of(1)), now), Verdict::good);
}

/// A restart forgets the numbers: what was sent before it must not count again.
TEST_F(Guard, NothingFromBeforeTheStart) {
  EXPECT_EQ(guard_.judge(command(start - 1, 1, key_of(1)), start + second), Verdict::stale);
}

TEST_F(Guard, WhoIsNotKnownOrSignsWrongly) {
  const std::int64_t now = start + second;
  EXPECT_EQ(guard_.judge(command(now, 1, key_of(2)), now), Verdict::wrong_code);
  command_v1_t unsigned_one = command(now, 1, key_of(1));
  std::memset(unsigned_one.code, 0, sizeof(unsigned_one.code));
  EXPECT_EQ(guard_.judge(unsigned_one, now), Verdict::wrong_code);
  command_v1_t stranger = command(now, 1, key_of(1));
  stranger.sender = "stranger";
  EXPECT_EQ(guard_.judge(stranger, now), Verdict::unknown_sender);
  EXPECT_EQ(guard_.refused(), 3u);
  // A forged number must not shut the true sender out.
  command_v1_t forged = command(now, 1000, key_of(3));
  EXPECT_EQ(guard_.judge(forged, now), Verdict::wrong_code);
  EXPECT_EQ(guard_.judge(command(now, 2, key_of(1)), now), Verdict::good);
}

TEST_F(Guard, AnotherHostIsNoOffence) {
  command_v1_t other = command(start + second, 1, key_of(1));
  other.target = "elsewhere";
  sign(key_of(1), other);
  EXPECT_EQ(guard_.judge(other, start + second), Verdict::for_another_host);
  EXPECT_EQ(guard_.refused(), 0u);
  EXPECT_EQ(guard_.judge(command(start + second, 1, key_of(1)), start + second), Verdict::good);
}

}  // namespace
}  // namespace ca2
