#include "drivers/net/pcap_reader.h"

#include <pcap/pcap.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/io/files.h"
#include "drivers/net/datagram_batch.h"
#include "drivers/net/udp_dissector.h"

namespace ca2 {
namespace {

// A batch ends at either: enough to spread a call's cost, little enough to stay in the second-level cache.
constexpr std::size_t batch_datagrams = 64;
constexpr std::size_t batch_bytes = 256 * 1024;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
struct ClosePcap {
  void operator()(pcap_t* pcap) const { pcap_close(pcap); }
};

/// ns since 1970, or nothing where a damaged record's seconds do not fit.
std::optional<std::int64_t> record_time(const pcap_pkthdr& header) {
  std::int64_t time = 0;
  // With nanosecond precision asked for, tv_usec holds nanoseconds.
  if (__builtin_mul_overflow(static_cast<std::int64_t>(header.ts.tv_sec), std::int64_t{1'000'000'000},
                             &time) ||
      __builtin_add_overflow(time, static_cast<std::int64_t>(header.ts.tv_usec), &time)) {
    return std::nullopt;
  }
  return time;
}

}  // namespace

struct PcapReader::State {
  State(std::string file_name, LinkType link, DatagramFilter filter, ReassemblyLimits limits)
      : name(std::move(file_name)), dissector(link, std::move(filter), limits) {}

  std::string name;
  std::unique_ptr<pcap_t, ClosePcap> pcap;
  UdpDissector dissector;
  DatagramBatch batch;
  std::int64_t last_time = 0;  ///< ns
  bool at_end = false;
  std::string damage;  ///< why the rest cannot be read, to be said once what came before was delivered

  /// Reads one record. False at the end of what can be read.
  bool step() {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int got = pcap_next_ex(pcap.get(), &header, &data);
    if (got == 1) {
      if (const auto time = record_time(*header)) {
        last_time = *time;
      } else {
        ++dissector.counters.bad_times;
      }
      if (const auto found = dissector.add({data, header->caplen}, header->len, last_time)) {
        batch.add(found->datagram, found->source);
      }
      return true;
    }
    at_end = true;
    dissector.finish();
    if (got == PCAP_ERROR_BREAK) return false;  // the regular end
    if (std::feof(pcap_file(pcap.get())) != 0) {
      ++dissector.counters.cut_records;  // the recorder was killed, or the file copied while it grew
    } else {
      damage = pcap_geterr(pcap.get());
    }
    return false;
  }
};

PcapReader::PcapReader(std::unique_ptr<State> state) : state_(std::move(state)) {}
PcapReader::~PcapReader() = default;

Result<std::unique_ptr<PcapReader>> PcapReader::open_stream(std::FILE* file, const std::string& name,
                                                            const PcapOptions& options) {
  std::unique_ptr<std::FILE, CloseFile> stream(file);
  Result<std::vector<IpAddress>> sources = parse_sources(options.sources);
  if (!sources) return fail(std::move(sources.error()));
  char reason[PCAP_ERRBUF_SIZE] = {};
  std::unique_ptr<pcap_t, ClosePcap> pcap(
      pcap_fopen_offline_with_tstamp_precision(stream.get(), PCAP_TSTAMP_PRECISION_NANO, reason));
  if (!pcap) {
    return fail(
        ErrorCode::data, name, std::string("not a readable capture file: ") + reason,
        "captures are pcap or pcapng files, as tcpdump, Wireshark and `ca2 record packets` write them");
  }
  (void)stream.release();  // pcap_close closes it
  const int number = pcap_datalink(pcap.get());
  const std::optional<LinkType> link = link_type_from(number);
  if (!link) {
    const char* description = pcap_datalink_val_to_description_or_dlt(number);
    return fail(ErrorCode::data, name, std::string("link type ") + description + " is not read here",
                "capture on an Ethernet, loopback or the \"any\" device");
  }
  auto state = std::make_unique<State>(name, *link, DatagramFilter{options.ports, std::move(*sources)},
                                       options.reassembly);
  state->pcap = std::move(pcap);
  return std::unique_ptr<PcapReader>(new PcapReader(std::move(state)));
}

Result<std::unique_ptr<PcapReader>> PcapReader::open(const std::filesystem::path& file,
                                                     const PcapOptions& options) {
  const Result<int> fd = open_for_reading(file);
  if (!fd) return fail(fd.error());
  return open_stream(fdopen(*fd, "rb"), file.string(), options);
}

Result<std::unique_ptr<PcapReader>> PcapReader::open_memory(std::span<const std::uint8_t> content,
                                                            const std::string& name,
                                                            const PcapOptions& options) {
  // fmemopen wants a pointer to non-const for its writing modes; with "r" it only reads.
  std::FILE* stream = content.empty()
                          ? std::fopen("/dev/null", "rbe")
                          : fmemopen(const_cast<std::uint8_t*>(content.data()), content.size(), "rb");
  if (stream == nullptr) return fail(ErrorCode::io, name, std::strerror(errno));
  return open_stream(stream, name, options);
}

Result<PacketBatch> PcapReader::next_batch(std::chrono::milliseconds) {
  State& state = *state_;
  state.batch.clear();
  while (!state.at_end && state.batch.size() < batch_datagrams && state.batch.bytes() < batch_bytes) {
    if (!state.step()) break;
  }
  if (state.batch.size() > 0) return PacketBatch{PacketEvent::packets, state.batch.view()};
  if (!state.damage.empty()) {
    return fail(
        ErrorCode::data, state.name,
        "record " + std::to_string(state.dissector.counters.records + 1) + " is damaged: " + state.damage,
        "what came before it was read");
  }
  return PacketBatch{PacketEvent::end, {}};
}

const PacketCounters& PcapReader::counters() const {
  return state_->dissector.counters;
}

}  // namespace ca2
