#include "drivers/net/udp_receiver.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace ca2 {
namespace {

constexpr std::size_t batch = 64;

/// Bytes from one buffer to the next: aligned for the kernel's copy, and off the powers of two, at which the
/// datagrams of a batch would fight for the same few sets of the cache.
std::size_t stride_for(std::size_t largest_payload) {
  constexpr std::size_t line = 64, odd_lines = 21;
  return (largest_payload + line - 1) / line * line + odd_lines * line;
}

std::int64_t nanoseconds(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

UdpReceiver::UdpReceiver(int fd, std::uint16_t port, std::size_t largest_payload)
    : fd_(fd),
      port_(port),
      largest_(largest_payload),
      stride_(stride_for(largest_payload)),
      buffer_(new std::uint8_t[batch * stride_]),
      messages_(batch),
      vectors_(batch),
      senders_(batch),
      controls_(batch),
      texts_(batch) {
  for (std::size_t i = 0; i < batch; ++i) {
    vectors_[i] = {buffer_.get() + i * stride_, largest_};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_name = &senders_[i];
    messages_[i].msg_hdr.msg_control = controls_[i].bytes;
  }
}

void UdpReceiver::read_notes(msghdr& header, Datagram& datagram, PacketCounters& counters) {
  bool stamped = false;
  for (cmsghdr* note = CMSG_FIRSTHDR(&header); note != nullptr; note = CMSG_NXTHDR(&header, note)) {
    if (note->cmsg_level != SOL_SOCKET) continue;
    if (note->cmsg_type == SCM_TIMESTAMPNS) {
      timespec time{};
      std::memcpy(&time, CMSG_DATA(note), sizeof time);
      datagram.time = nanoseconds(time);
      stamped = true;
    } else if (note->cmsg_type == SO_RXQ_OVFL) {
      // Left out while it is zero, so also when it wraps to zero: the next one makes up for it.
      std::uint32_t dropped = 0;
      std::memcpy(&dropped, CMSG_DATA(note), sizeof dropped);
      counters.kernel_dropped += dropped_.update(dropped);
    }
  }
  if (!stamped) {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    datagram.time = nanoseconds(now);
    ++counters.without_kernel_time;
  }
}

int UdpReceiver::receive(const DatagramFilter& filter, std::vector<Datagram>& datagrams,
                         PacketCounters& counters) {
  for (mmsghdr& message : messages_) {  // the kernel writes the lengths over
    message.msg_hdr.msg_namelen = sizeof(sockaddr_storage);
    message.msg_hdr.msg_controllen = sizeof(Control);
  }
  const int got = ::recvmmsg(fd_, messages_.data(), batch, MSG_DONTWAIT, nullptr);
  if (got < 0) return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR ? 0 : errno;
  for (std::size_t i = 0; i < static_cast<std::size_t>(got); ++i) {
    msghdr& header = messages_[i].msg_hdr;
    Datagram datagram;
    read_notes(header, datagram, counters);
    const IpAddress sender = address_of(senders_[i]);
    if (!filter.wants_source(sender)) {
      ++counters.other_source;
      continue;
    }
    datagram.source_address = texts_[i].of(sender);
    datagram.source_port = port_of(senders_[i]);
    datagram.destination_port = port_;
    datagram.payload = {buffer_.get() + i * stride_, std::min<std::size_t>(messages_[i].msg_len, largest_)};
    datagram.truncated = (header.msg_flags & MSG_TRUNC) != 0;
    if (datagram.truncated) ++counters.cut_short;
    ++counters.datagrams;
    counters.bytes += datagram.payload.size();
    datagrams.push_back(datagram);
  }
  return 0;
}

}  // namespace ca2
