/// @file The UDP datagrams of a capture file.
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/net/ip_reassembly.h"
#include "drivers/net/packet_source.h"

namespace ca2 {

struct PcapOptions {
  std::vector<std::uint16_t> ports;  ///< destination ports to deliver; empty: all
  std::vector<std::string> sources;  ///< numeric source addresses to deliver; empty: all
  ReassemblyLimits reassembly;
};

/// Reads pcap files (microseconds or nanoseconds, either byte order) and pcapng: Ethernet with VLAN tags,
/// Linux cooked v1 and v2, BSD loopback, raw IP; IPv4 and IPv6, fragments put together. A record cut off at
/// the end is counted and ends the file; a datagram is stamped with its last fragment's time, as the kernel
/// does it. Checksums are not looked at: captures of a sending host and of several tools carry wrong ones.
class PcapReader : public PacketSource {
 public:
  /// Errors: `data` for what is no capture file or has a link type that cannot hold IP, `io` where the file
  /// cannot be opened, `usage` for a source that is no numeric address.
  static Result<std::unique_ptr<PcapReader>> open(const std::filesystem::path& file,
                                                  const PcapOptions& options = {});
  /// A capture in memory, which must outlive the reader; `name` stands in for the file's name in errors.
  static Result<std::unique_ptr<PcapReader>> open_memory(std::span<const std::uint8_t> content,
                                                         const std::string& name,
                                                         const PcapOptions& options = {});
  ~PcapReader() override;

  Result<PacketBatch> next_batch(std::chrono::milliseconds timeout = {}) override;
  const PacketCounters& counters() const override;

 private:
  struct State;
  explicit PcapReader(std::unique_ptr<State> state);
  static Result<std::unique_ptr<PcapReader>> open_stream(std::FILE* file, const std::string& name,
                                                         const PcapOptions& options);
  std::unique_ptr<State> state_;
};

}  // namespace ca2
