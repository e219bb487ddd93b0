/// @file Everything that is on the wire, sorted by who sends it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/net/datagram.h"
#include "drivers/survey/recogniser.h"

namespace ca2 {

/// Datagrams of one size from one sender to one port.
struct StreamSummary {
  std::string source_address;
  std::uint16_t destination_port = 0;
  std::size_t size = 0;  ///< bytes of a datagram
  bool cut = false;      ///< only so much of them was recorded: who sends them cannot be told
  std::uint64_t datagrams = 0;
  std::int64_t first = 0, last = 0;  ///< ns
  StreamIdentity identity;

  /// Per second; 0 for fewer than two.
  double rate() const;
};

/// Collects streams; pure. Bounded: what comes after `most_streams` different ones is only counted.
class Survey {
 public:
  void add(const Datagram& datagram);

  /// By sender, port and size; recognised streams before others of the same sender and port.
  std::vector<StreamSummary> streams() const;
  std::uint64_t unlisted() const { return unlisted_; }  ///< datagrams of streams beyond the bound

 private:
  struct Stream {
    std::uint64_t datagrams = 0;
    std::int64_t first = 0, last = 0;
    std::unique_ptr<Recogniser> recogniser;
  };
  static constexpr std::size_t most_streams = 256;

  using Key = std::tuple<std::string, std::uint16_t, std::size_t, bool>;  ///< sender, port, size, cut

  std::map<Key, Stream> streams_;
  std::uint64_t unlisted_ = 0;
};

}  // namespace ca2
