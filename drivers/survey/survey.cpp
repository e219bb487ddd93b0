#include "drivers/survey/survey.h"

#include <algorithm>

namespace ca2 {

double StreamSummary::rate() const {
  // In floating point: damaged stamps may lie further apart than 64 bits of ns.
  const double elapsed = static_cast<double>(last) - static_cast<double>(first);
  return datagrams < 2 || elapsed <= 0 ? 0 : static_cast<double>(datagrams - 1) * 1e9 / elapsed;
}

void Survey::add(const Datagram& datagram) {
  const Key key{std::string(datagram.source_address), datagram.destination_port, datagram.payload.size(),
                datagram.truncated};
  auto found = streams_.find(key);
  if (found == streams_.end()) {
    if (streams_.size() >= most_streams) {
      ++unlisted_;
      return;
    }
    found = streams_.emplace(key, Stream{}).first;
    found->second.first = datagram.time;
    // What is left of one that was cut could have another sensor's size.
    found->second.recogniser =
        make_recogniser(datagram.truncated ? std::span<const std::uint8_t>() : datagram.payload);
  }
  Stream& stream = found->second;
  ++stream.datagrams;
  stream.last = datagram.time;
  stream.recogniser->add(datagram.payload, datagram.time);
}

std::vector<StreamSummary> Survey::streams() const {
  std::vector<StreamSummary> all;
  for (const auto& [key, stream] : streams_) {
    StreamSummary summary;
    std::tie(summary.source_address, summary.destination_port, summary.size, summary.cut) = key;
    summary.datagrams = stream.datagrams;
    summary.first = stream.first;
    summary.last = stream.last;
    summary.identity = stream.recogniser->identity();
    all.push_back(std::move(summary));
  }
  std::stable_sort(all.begin(), all.end(), [](const StreamSummary& a, const StreamSummary& b) {
    return std::tuple(a.source_address, a.destination_port, a.identity.vendor.empty()) <
           std::tuple(b.source_address, b.destination_port, b.identity.vendor.empty());
  });
  return all;
}

}  // namespace ca2
