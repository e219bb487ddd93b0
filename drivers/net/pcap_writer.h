/// @file Datagrams into a capture file that Wireshark, VeloView and the vendors' tools open.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/types/result.h"
#include "drivers/net/datagram.h"

namespace ca2 {

struct PcapWriterOptions {
  bool overwrite = false;  ///< else an existing file is an error
  /// Numeric address datagrams are shown as sent to, for the family it is of. The receiving socket does not
  /// say it, and nothing needs it: the default is broadcast (IPv6: all nodes), as Velodyne's sensors send.
  std::string destination;
  std::int64_t flush_interval = 1'000'000'000;  ///< ns of the datagrams' time
};

/// Writes nanosecond pcap files: every datagram one record with Ethernet, IP and UDP headers made up round
/// it, whatever its size (up to what UDP can carry). What was written reaches the disk's cache at least every
/// flush interval, so a crash loses no more; a record torn by it ends the file for PcapReader, and no more.
class PcapWriter {
 public:
  /// Errors: `cannot_create`, `usage` for a destination that is no address.
  static Result<PcapWriter> create(const std::filesystem::path& file, const PcapWriterOptions& options = {});
  PcapWriter(PcapWriter&&) noexcept;
  PcapWriter& operator=(PcapWriter&&) noexcept;
  ~PcapWriter();

  /// An empty source address stands for 127.0.0.1. A truncated datagram is written as missing one byte: it
  /// reads back as truncated. Errors: `io` (disk full), `data` for a payload UDP cannot carry, a source that
  /// is no address, or a time outside 1970 to 2038, which the format cannot hold.
  Result<void> write(const Datagram& datagram);

  /// Hands everything written so far to the operating system.
  Result<void> flush();

  /// Flushes, syncs to the disk and closes. The destructor closes too, but cannot say what went wrong.
  Result<void> close();

  std::uint64_t datagrams() const;
  std::uint64_t bytes() const;  ///< of the file

 private:
  struct State;
  explicit PcapWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ca2
