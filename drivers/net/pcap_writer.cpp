#include "drivers/net/pcap_writer.h"

#include <fcntl.h>
#include <pcap/pcap.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <vector>

#include "drivers/net/udp_frame.h"

namespace ca2 {
namespace {

// Above the largest frame (65589 bytes); the same as tcpdump's default and Wireshark's limit.
constexpr int snapshot_length = 262144;
constexpr std::size_t file_header_size = 24, record_header_size = 16;

struct ClosePcap {
  void operator()(pcap_t* pcap) const { pcap_close(pcap); }
};
struct CloseDumper {
  void operator()(pcap_dumper_t* dumper) const { pcap_dump_close(dumper); }
};

}  // namespace

struct PcapWriter::State {
  std::string name;
  PcapWriterOptions options;
  std::unique_ptr<pcap_t, ClosePcap> pcap;
  std::unique_ptr<pcap_dumper_t, CloseDumper> dumper;
  IpAddress destination_v4 = IpAddress::v4_from(std::array<std::uint8_t, 4>{255, 255, 255, 255});
  IpAddress destination_v6 = *parse_ip_address("ff02::1");
  std::string source_text = "127.0.0.1";
  IpAddress source = *parse_ip_address("127.0.0.1");
  std::vector<std::uint8_t> frame;
  std::int64_t flushed = 0;  ///< time of the datagram last flushed at, ns
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = file_header_size;

  tl::unexpected<Error> io_error(const char* what) const {
    const int code = errno;
    return fail(ErrorCode::io, name, std::string(what) + ": " + std::strerror(code),
                code == ENOSPC || code == EDQUOT ? "make room; what was written before stays readable" : "");
  }
};

PcapWriter::PcapWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
PcapWriter::PcapWriter(PcapWriter&&) noexcept = default;
PcapWriter& PcapWriter::operator=(PcapWriter&&) noexcept = default;
PcapWriter::~PcapWriter() = default;

Result<PcapWriter> PcapWriter::create(const std::filesystem::path& file, const PcapWriterOptions& options) {
  auto state = std::make_unique<State>();
  state->name = file.string();
  state->options = options;
  if (!options.destination.empty()) {
    const auto address = parse_ip_address(options.destination);
    if (!address) {
      return fail(ErrorCode::usage, state->name, "'" + options.destination + "' is not a numeric IP address");
    }
    (address->v6 ? state->destination_v6 : state->destination_v4) = *address;
  }
  const int mode = O_WRONLY | O_CREAT | O_CLOEXEC | (options.overwrite ? O_TRUNC : O_EXCL);
  const int descriptor = ::open(file.c_str(), mode, 0644);
  if (descriptor < 0) {
    return fail(ErrorCode::cannot_create, state->name, std::strerror(errno),
                errno == EEXIST ? "choose another name, or remove it" : "");
  }
  std::FILE* stream = fdopen(descriptor, "wb");
  if (stream == nullptr) {
    const int code = errno;
    ::close(descriptor);
    return fail(ErrorCode::cannot_create, state->name, std::strerror(code));
  }
  state->pcap.reset(
      pcap_open_dead_with_tstamp_precision(DLT_EN10MB, snapshot_length, PCAP_TSTAMP_PRECISION_NANO));
  if (state->pcap) state->dumper.reset(pcap_dump_fopen(state->pcap.get(), stream));
  if (!state->dumper) {
    const std::string reason = state->pcap ? pcap_geterr(state->pcap.get()) : "out of memory";
    std::fclose(stream);
    return fail(ErrorCode::cannot_create, state->name, reason);
  }
  return PcapWriter(std::move(state));
}

Result<void> PcapWriter::write(const Datagram& datagram) {
  State& state = *state_;
  if (!state.dumper) return fail(ErrorCode::internal, state.name, "written to after it was closed");
  if (!datagram.source_address.empty() && datagram.source_address != state.source_text) {
    const auto address = parse_ip_address(datagram.source_address);
    if (!address) {
      return fail(ErrorCode::data, state.name,
                  "'" + std::string(datagram.source_address) + "' is not a numeric IP address");
    }
    state.source = *address;
    state.source_text = datagram.source_address;
  }
  const std::size_t missing = datagram.truncated ? 1 : 0;
  const std::size_t size = datagram.payload.size();
  if (size + missing > (state.source.v6 ? largest_payload_v6 : largest_payload_v4)) {
    return fail(ErrorCode::data, state.name,
                "a payload of " + std::to_string(size) + " bytes does not fit a UDP datagram");
  }
  const std::int64_t seconds = datagram.time / 1'000'000'000;
  if (datagram.time < 0 || seconds > std::numeric_limits<std::int32_t>::max()) {
    return fail(ErrorCode::data, state.name,
                "time " + std::to_string(datagram.time) + " ns does not fit a capture file (1970 to 2038)");
  }

  const UdpEndpoints ends{state.source, state.source.v6 ? state.destination_v6 : state.destination_v4,
                          datagram.source_port, datagram.destination_port};
  const UdpFrameHeaders headers =
      udp_frame_headers(ends, datagram.payload, missing, static_cast<std::uint16_t>(state.datagrams));
  state.frame.resize(headers.size + size);
  std::copy_n(headers.bytes.begin(), headers.size, state.frame.begin());
  std::copy(datagram.payload.begin(), datagram.payload.end(),
            state.frame.begin() + static_cast<std::ptrdiff_t>(headers.size));

  pcap_pkthdr record{};
  record.ts.tv_sec = seconds;
  record.ts.tv_usec = datagram.time % 1'000'000'000;  // ns, as the file's precision is
  record.caplen = static_cast<bpf_u_int32>(state.frame.size());
  record.len = static_cast<bpf_u_int32>(state.frame.size() + missing);
  errno = 0;
  pcap_dump(reinterpret_cast<u_char*>(state.dumper.get()), &record, state.frame.data());
  if (std::ferror(pcap_dump_file(state.dumper.get())) != 0) return state.io_error("cannot write");
  ++state.datagrams;
  state.bytes += record_header_size + state.frame.size();

  const bool due =
      state.flushed > datagram.time || datagram.time - state.flushed >= state.options.flush_interval;
  if (state.datagrams == 1 || due) {
    state.flushed = datagram.time;
    return flush();
  }
  return {};
}

Result<void> PcapWriter::flush() {
  if (!state_->dumper) return {};
  if (pcap_dump_flush(state_->dumper.get()) != 0) return state_->io_error("cannot write");
  return {};
}

Result<void> PcapWriter::close() {
  State& state = *state_;
  if (!state.dumper) return {};
  if (auto flushed = flush(); !flushed) {
    state.dumper.reset();
    return flushed;
  }
  const int descriptor = fileno(pcap_dump_file(state.dumper.get()));
  // Pipes and special files cannot be synced, and need not be.
  const bool synced = ::fsync(descriptor) == 0 || errno == EINVAL || errno == ENOTSUP || errno == EROFS;
  if (!synced) {
    auto failure = state.io_error("cannot sync");
    state.dumper.reset();
    return failure;
  }
  state.dumper.reset();
  return {};
}

std::uint64_t PcapWriter::datagrams() const {
  return state_->datagrams;
}

std::uint64_t PcapWriter::bytes() const {
  return state_->bytes;
}

}  // namespace ca2
