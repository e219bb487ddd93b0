#include "drivers/net/ip_reassembly.h"

#include <algorithm>
#include <cstring>

namespace ca2 {
namespace {

constexpr std::uint32_t largest_datagram = 65535;

}  // namespace

IpReassembler::Fit IpReassembler::fit_of(const Pending& datagram, const IpPacket& fragment, Range range) {
  if (datagram.total != 0 && range.end > datagram.total) return Fit::overlapping;
  if (!fragment.more) {
    const bool other_end = datagram.total != 0 && datagram.total != range.end;
    const bool beyond = !datagram.ranges.empty() && datagram.ranges.back().end > range.end;
    if (other_end || beyond) return Fit::overlapping;
  }
  for (const Range& held : datagram.ranges) {
    if (range.end <= held.begin || range.begin >= held.end) continue;
    const bool inside = held.begin <= range.begin && range.end <= held.end;
    const bool same = inside && std::memcmp(datagram.bytes.data() + range.begin, fragment.payload.data(),
                                            fragment.payload.size()) == 0;
    return same ? Fit::repeated : Fit::overlapping;
  }
  return Fit::fresh;
}

void IpReassembler::insert(Pending& datagram, const IpPacket& fragment, Range range) {
  if (!fragment.more) datagram.total = range.end;
  if (datagram.bytes.size() < range.end) datagram.bytes.resize(range.end);
  std::memcpy(datagram.bytes.data() + range.begin, fragment.payload.data(), fragment.payload.size());
  auto& ranges = datagram.ranges;
  auto next =
      std::find_if(ranges.begin(), ranges.end(), [&](const Range& held) { return held.begin >= range.end; });
  const bool joins_next = next != ranges.end() && next->begin == range.end;
  const bool joins_previous = next != ranges.begin() && std::prev(next)->end == range.begin;
  if (joins_previous && joins_next) {
    std::prev(next)->end = next->end;
    ranges.erase(next);
  } else if (joins_previous) {
    std::prev(next)->end = range.end;
  } else if (joins_next) {
    next->begin = range.begin;
  } else {
    ranges.insert(next, range);
  }
}

void IpReassembler::expire(std::int64_t now, PacketCounters& counters) {
  // Captures of several interfaces step back a little, and a damaged stamp may say anything: both
  // directions count as old.
  const auto too_old = [&](const Pending& datagram) {
    const auto difference = static_cast<std::uint64_t>(now) - static_cast<std::uint64_t>(datagram.time);
    const auto age = static_cast<std::int64_t>(difference);
    return age > limits_.age || age < -limits_.age;
  };
  for (std::size_t i = pending_.size(); i-- > 0;) {
    if (!too_old(pending_[i])) continue;
    ++counters.incomplete;
    close(i);
  }
}

IpReassembler::Pending& IpReassembler::open(const Key& key, std::int64_t time, PacketCounters& counters) {
  if (pending_.size() >= limits_.datagrams) {
    ++counters.incomplete;
    close(0);
  }
  Pending& datagram = pending_.emplace_back();
  datagram.key = key;
  datagram.time = time;
  if (!spare_.empty()) {
    datagram.bytes = std::move(spare_.back());
    spare_.pop_back();
    datagram.bytes.clear();
  }
  return datagram;
}

void IpReassembler::close(std::size_t index) {
  spare_.push_back(std::move(pending_[index].bytes));
  pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(index));
}

std::optional<IpPacket> IpReassembler::add(const IpPacket& fragment, std::int64_t time,
                                           PacketCounters& counters) {
  ++counters.fragments;
  expire(time, counters);
  if (fragment.cut) {
    ++counters.fragments_cut;
    return std::nullopt;
  }
  const std::size_t size = fragment.payload.size();
  const bool impossible = size == 0 || fragment.offset > largest_datagram ||
                          size > largest_datagram - fragment.offset || (fragment.more && size % 8 != 0);
  if (impossible || fragment.length_mismatch) {
    ++counters.fragments_invalid;
    return std::nullopt;
  }
  const Range range{fragment.offset, fragment.offset + static_cast<std::uint32_t>(size)};
  const Key key{fragment.source, fragment.destination, fragment.id, fragment.protocol};

  auto found = std::find_if(pending_.begin(), pending_.end(),
                            [&](const Pending& datagram) { return datagram.key == key; });
  if (found != pending_.end()) {
    switch (fit_of(*found, fragment, range)) {
      case Fit::repeated:
        ++counters.fragments_repeated;
        return std::nullopt;
      case Fit::overlapping:
        ++counters.overlapping;
        close(static_cast<std::size_t>(found - pending_.begin()));
        // The start of a datagram that reuses the id of one whose tail was lost deserves its own chance.
        if (fragment.offset != 0) return std::nullopt;
        found = pending_.end();
        break;
      case Fit::fresh:
        break;
    }
  }
  Pending& datagram = found != pending_.end() ? *found : open(key, time, counters);
  insert(datagram, fragment, range);
  const bool complete = datagram.total != 0 && datagram.ranges.size() == 1 && datagram.ranges[0].begin == 0 &&
                        datagram.ranges[0].end == datagram.total;
  if (!complete) return std::nullopt;

  done_.swap(datagram.bytes);
  IpPacket packet = fragment;
  packet.payload = std::span<const std::uint8_t>(done_).first(datagram.total);
  packet.fragment = packet.more = false;
  packet.offset = 0;
  ++counters.reassembled;
  close(static_cast<std::size_t>(&datagram - pending_.data()));
  return packet;
}

void IpReassembler::give_up(PacketCounters& counters) {
  counters.incomplete += pending_.size();
  pending_.clear();
}

}  // namespace ca2
