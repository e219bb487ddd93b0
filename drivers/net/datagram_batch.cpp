#include "drivers/net/datagram_batch.h"

namespace ca2 {

void DatagramBatch::clear() {
  payloads_.clear();
  offsets_.clear();
  sizes_.clear();
  datagrams_.clear();
}

void DatagramBatch::add(const Datagram& datagram, const IpAddress& source) {
  const std::size_t place = datagrams_.size();
  if (texts_.size() <= place) texts_.emplace_back();
  offsets_.push_back(payloads_.size());
  sizes_.push_back(datagram.payload.size());
  payloads_.insert(payloads_.end(), datagram.payload.begin(), datagram.payload.end());
  Datagram& kept = datagrams_.emplace_back(datagram);
  kept.source_address = texts_[place].of(source);
  kept.payload = {};
}

std::span<const Datagram> DatagramBatch::view() {
  const std::span<const std::uint8_t> all(payloads_);
  for (std::size_t i = 0; i < datagrams_.size(); ++i) {
    datagrams_[i].payload = all.subspan(offsets_[i], sizes_[i]);
  }
  return datagrams_;
}

}  // namespace ca2
