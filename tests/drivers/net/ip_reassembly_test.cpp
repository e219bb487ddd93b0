#include "drivers/net/ip_reassembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/drivers/net/frames.h"

namespace ca2 {
namespace {

using namespace ca2::test;

/// The bytes must outlive the packet, as a frame does.
struct Fragment {
  IpPacket packet;
  explicit Fragment(const Bytes& bytes, std::size_t offset, std::size_t size, bool more,
                    std::uint32_t id = 1) {
    packet.source = *parse_ip_address("192.0.2.7");
    packet.protocol = protocol_udp;
    packet.id = id;
    packet.offset = static_cast<std::uint32_t>(offset);
    packet.more = more;
    packet.fragment = true;
    packet.payload = std::span(bytes).subspan(offset, size);
  }
};

bool equal(std::span<const std::uint8_t> left, const Bytes& right) {
  return std::equal(left.begin(), left.end(), right.begin(), right.end());
}

const Bytes data = pattern(4000);
constexpr std::int64_t ms = 1'000'000;

TEST(IpReassembly, TakesFragmentsInEveryOrderAndTwice) {
  std::mt19937_64 random(2);
  std::vector<Fragment> pieces;
  for (std::size_t at = 0; at < 4000; at += 400) pieces.emplace_back(data, at, 400, at + 400 < 4000);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Fragment> sent = pieces;
    sent.push_back(pieces[random() % pieces.size()]);
    std::shuffle(sent.begin(), sent.end(), random);
    IpReassembler reassembler;
    PacketCounters counters;
    int complete = 0;
    for (const Fragment& piece : sent) {
      if (const auto whole = reassembler.add(piece.packet, 0, counters)) {
        ++complete;
        EXPECT_TRUE(equal(whole->payload, data));
      }
    }
    EXPECT_EQ(complete, 1);
    // A repetition after the end starts a datagram of its own, which never completes.
    EXPECT_EQ(counters.fragments_repeated + reassembler.pending(), 1u);
    EXPECT_EQ(counters.fragments, sent.size());
  }
}

TEST(IpReassembly, GivesUpDatagramsThatOverlapAndDisagree) {
  const Bytes other = pattern(4000, 9);
  struct Case {
    const char* name;
    Fragment first, second;
  };
  const std::vector<Case> cases{
      {"same place, other bytes", Fragment(data, 800, 400, true), Fragment(other, 800, 400, true)},
      {"partly over it", Fragment(data, 800, 400, true), Fragment(data, 1000, 400, true)},
      {"round it", Fragment(data, 800, 400, true), Fragment(data, 400, 1200, true)},
      {"beyond the last", Fragment(data, 800, 400, false), Fragment(data, 1600, 400, true)},
      {"another last", Fragment(data, 800, 400, false), Fragment(data, 1200, 400, false)},
      {"a last before the end", Fragment(data, 800, 400, true), Fragment(data, 400, 400, false)},
  };
  for (const Case& c : cases) {
    IpReassembler reassembler;
    PacketCounters counters;
    EXPECT_FALSE(reassembler.add(c.first.packet, 0, counters)) << c.name;
    EXPECT_FALSE(reassembler.add(c.second.packet, 0, counters)) << c.name;
    EXPECT_EQ(counters.overlapping, 1u) << c.name;
    EXPECT_EQ(reassembler.pending(), 0u) << c.name;
  }
}

TEST(IpReassembly, StartsAnewWhenAnIdComesRoundWithinTheAge) {
  const Bytes next = pattern(4000, 5);
  IpReassembler reassembler;
  PacketCounters counters;
  EXPECT_FALSE(reassembler.add(Fragment(data, 0, 2000, true).packet, 0, counters));
  EXPECT_FALSE(reassembler.add(Fragment(next, 0, 2000, true).packet, 10 * ms, counters));
  const auto whole = reassembler.add(Fragment(next, 2000, 2000, false).packet, 11 * ms, counters);
  ASSERT_TRUE(whole);
  EXPECT_TRUE(equal(whole->payload, next));
  EXPECT_EQ(counters.overlapping, 1u);
}

TEST(IpReassembly, ForgetsAfterTheAgeInEitherDirectionOfTime) {
  for (const std::int64_t later : {2001 * ms, -2001 * ms}) {
    IpReassembler reassembler;
    PacketCounters counters;
    EXPECT_FALSE(reassembler.add(Fragment(data, 0, 2000, true).packet, 0, counters));
    EXPECT_FALSE(reassembler.add(Fragment(data, 2000, 2000, false).packet, later, counters));
    EXPECT_EQ(counters.incomplete, 1u);
    EXPECT_EQ(reassembler.pending(), 1u);
    reassembler.give_up(counters);
    EXPECT_EQ(counters.incomplete, 2u);
  }
}

TEST(IpReassembly, HoldsNoMoreThanItsLimit) {
  ReassemblyLimits limits;
  limits.datagrams = 8;
  IpReassembler reassembler(limits);
  PacketCounters counters;
  for (std::uint32_t id = 0; id < 1000; ++id) {
    EXPECT_FALSE(reassembler.add(Fragment(data, 0, 2000, true, id).packet, 0, counters));
    EXPECT_LE(reassembler.pending(), 8u);
  }
  EXPECT_EQ(counters.incomplete, 992u);
  EXPECT_TRUE(reassembler.add(Fragment(data, 2000, 2000, false, 992).packet, 0, counters))
      << "the oldest kept";
}

TEST(IpReassembly, RefusesImpossibleFragments) {
  IpReassembler reassembler;
  PacketCounters counters;
  Fragment odd(data, 0, 1001, true);  // only the last may not be a multiple of 8
  Fragment empty(data, 0, 0, true);
  Fragment beyond(data, 0, 1000, false);
  beyond.packet.offset = 65000;  // reaches past 65535
  Fragment cut(data, 0, 1000, true);
  cut.packet.cut = true;
  for (const Fragment& piece : {odd, empty, beyond, cut}) {
    EXPECT_FALSE(reassembler.add(piece.packet, 0, counters));
  }
  EXPECT_EQ(counters.fragments_invalid, 3u);
  EXPECT_EQ(counters.fragments_cut, 1u);
  EXPECT_EQ(reassembler.pending(), 0u);
}

}  // namespace
}  // namespace ca2
