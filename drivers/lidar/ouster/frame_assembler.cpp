#include "drivers/lidar/ouster/frame_assembler.h"

#include <algorithm>

namespace ca2 {
namespace {

/// Packets of newer frames after which an unfinished one is given out.
constexpr int hold = 8;
/// Frames under way at most.
constexpr std::size_t most_slots = 3;

}  // namespace

OusterFrameAssembler::OusterFrameAssembler(const OusterMetadata& metadata, bool extra_fields)
    : format_(make_ouster_format(metadata)), extra_fields_(extra_fields) {
  const int per_packet = format_.columns;
  expected_.resize(static_cast<std::size_t>((format_.frame_columns + per_packet - 1) / per_packet));
  for (int id = 0; id < format_.frame_columns; ++id) {
    if (metadata.in_window(id)) expected_[static_cast<std::size_t>(id / per_packet)] = true;
  }
  expected_count_ = static_cast<int>(std::count(expected_.begin(), expected_.end(), true));
}

/// How many frames a is after b, across the wrap of the counter.
std::int64_t OusterFrameAssembler::later(std::uint32_t a, std::uint32_t b) const {
  const std::int64_t modulus = format_.frame_modulus();
  std::int64_t d = (static_cast<std::int64_t>(a) - b) % modulus;
  if (d < -modulus / 2) d += modulus;
  if (d >= modulus / 2) d -= modulus;
  return d;
}

void OusterFrameAssembler::push(std::span<const std::uint8_t> packet, std::uint32_t frame_id,
                                std::int64_t host_time, LidarCounters& counters, const Sink& sink) {
  bool any_valid = false;
  for (int i = 0; i < format_.columns; ++i) {
    any_valid = any_valid || format_.valid(format_.column(packet.data(), i));
  }
  // A packet without one valid column (the sensor is starting up) must not move frames along.
  if (!any_valid) {
    counters.invalid_columns += static_cast<std::uint64_t>(format_.columns);
    return;
  }
  Slot* slot = slot_for(frame_id, counters, sink);
  if (!slot) return;
  add_columns(*slot, packet.data(), host_time, counters);
  close_finished(counters, sink);
}

OusterFrameAssembler::Slot* OusterFrameAssembler::slot_for(std::uint32_t frame_id, LidarCounters& counters,
                                                           const Sink& sink) {
  const auto same = [&](const Slot& slot) { return slot.frame.frame_id == frame_id; };
  const auto found = std::find_if(slots_.begin(), slots_.end(), same);
  if (found != slots_.end()) {
    late_run_ = 0;
    return &*found;
  }
  if (closed_ && later(frame_id, *closed_) <= 0) {
    ++counters.late;
    // A whole frame of nothing but old packets: the sensor has started to count anew.
    if (++late_run_ <= std::max(expected_count_, hold)) return nullptr;
    ++counters.restarts;
    flush(counters, sink);
    closed_.reset();
  }
  late_run_ = 0;
  if (slots_.size() == most_slots) {
    // Older than all that are under way: it would be the one to close.
    if (later(frame_id, slots_.front().frame.frame_id) < 0) {
      ++counters.late;
      return nullptr;
    }
    close_oldest(counters, sink);
  }
  const auto newer = [&](const Slot& slot) { return later(slot.frame.frame_id, frame_id) > 0; };
  const auto at = std::find_if(slots_.begin(), slots_.end(), newer);
  return &*slots_.insert(at, fresh_slot(frame_id));
}

OusterFrameAssembler::Slot OusterFrameAssembler::fresh_slot(std::uint32_t frame_id) {
  Slot slot;
  if (!spare_.empty()) {
    slot = std::move(spare_.back());
    spare_.pop_back();
  }
  OusterFrame& frame = slot.frame;
  const auto columns = static_cast<std::size_t>(format_.frame_columns);
  const std::size_t pixels = columns * static_cast<std::size_t>(format_.pixels);
  frame.rows = format_.pixels;
  frame.columns = format_.frame_columns;
  frame.frame_id = frame_id;
  frame.packets = 0;
  frame.missing_packets = 0;
  frame.clock.clear();
  frame.timestamp.assign(columns, 0);
  frame.status.assign(columns, 0);
  frame.measurement_id.assign(columns, 0);
  // Pixels of columns that never come are zeroed when the frame is given out.
  const OusterProfile& profile = *format_.profile;
  for (int i = 0; i < (profile.dual() ? 2 : 1); ++i) {
    frame.range[i].resize(pixels);
    frame.reflectivity[i].resize(pixels);
    if (extra_fields_ && profile.signal[i].present()) frame.signal[i].resize(pixels);
  }
  if (extra_fields_ && profile.near_ir.present()) frame.near_ir.resize(pixels);
  slot.received.assign(expected_.size(), false);
  slot.expected_received = 0;
  return slot;
}

void OusterFrameAssembler::add_columns(Slot& slot, const std::uint8_t* packet, std::int64_t host_time,
                                       LidarCounters& counters) {
  OusterFrame& frame = slot.frame;
  std::int64_t device_time = 0;
  int fresh = 0, repeated = 0;
  for (int i = 0; i < format_.columns; ++i) {
    const std::uint8_t* column = format_.column(packet, i);
    const int id = format_.measurement_id(column);
    if (id >= format_.frame_columns) {
      ++counters.bad_columns;
      continue;
    }
    if (!format_.valid(column)) {
      ++counters.invalid_columns;
      continue;
    }
    // Only by valid columns: the ids of others may be anything.
    const auto index = static_cast<std::size_t>(id / format_.columns);
    if (!slot.received[index]) {
      slot.received[index] = true;
      if (expected_[index]) ++slot.expected_received;
    }
    if (frame.status[static_cast<std::size_t>(id)] != 0) {
      ++repeated;
      continue;
    }
    decode_column(frame, column, id);
    if (device_time == 0) device_time = static_cast<std::int64_t>(format_.timestamp(column));
    ++fresh;
  }
  if (fresh == 0) {
    if (repeated > 0) ++counters.duplicates;
    return;
  }
  counters.repeated_columns += static_cast<std::uint64_t>(repeated);
  ++counters.lidar_packets;
  ++frame.packets;
  frame.clock.push_back({device_time, host_time});
}

void OusterFrameAssembler::decode_column(OusterFrame& frame, const std::uint8_t* column, int id) const {
  const OusterProfile& profile = *format_.profile;
  const auto at = static_cast<std::size_t>(id);
  frame.timestamp[at] = format_.timestamp(column);
  frame.measurement_id[at] = static_cast<std::uint16_t>(id);
  frame.status[at] = profile.legacy() ? load<std::uint32_t>(column + format_.column_bytes - 4)
                                      : load<std::uint16_t>(column + 10);
  const std::size_t first = at * static_cast<std::size_t>(format_.pixels);
  OusterPixels out;
  const auto place = [&](auto& field) { return field.empty() ? nullptr : &field[first]; };
  for (int i = 0; i < 2; ++i) {
    out.range[i] = place(frame.range[i]);
    out.reflectivity[i] = place(frame.reflectivity[i]);
    out.signal[i] = place(frame.signal[i]);
  }
  out.near_ir = place(frame.near_ir);
  profile.decode(format_.pixel(column, 0), format_.pixels, out);
}

void OusterFrameAssembler::close_oldest(LidarCounters& counters, const Sink& sink) {
  Slot slot = std::move(slots_.front());
  slots_.pop_front();
  OusterFrame& frame = slot.frame;
  closed_ = frame.frame_id;
  const auto rows = static_cast<std::size_t>(frame.rows);
  const auto clear = [&](auto& field, std::size_t column) {
    if (!field.empty()) std::fill_n(field.begin() + static_cast<std::ptrdiff_t>(column * rows), rows, 0);
  };
  for (std::size_t column = 0; column < frame.status.size(); ++column) {
    if (frame.status[column] != 0) continue;
    for (int i = 0; i < 2; ++i) {
      clear(frame.range[i], column);
      clear(frame.reflectivity[i], column);
      clear(frame.signal[i], column);
    }
    clear(frame.near_ir, column);
  }
  frame.missing_packets = expected_count_ - slot.expected_received;
  counters.missing_packets += static_cast<std::uint64_t>(frame.missing_packets);
  // A frame of which every packet brought nothing new does not exist.
  if (frame.packets > 0) {
    ++counters.frames;
    if (frame.missing_packets > 0) ++counters.incomplete_frames;
    sink(frame);
  }
  spare_.push_back(std::move(slot));
}

void OusterFrameAssembler::close_finished(LidarCounters& counters, const Sink& sink) {
  while (!slots_.empty()) {
    int newer = 0;
    for (std::size_t i = 1; i < slots_.size(); ++i) newer += slots_[i].frame.packets;
    const bool complete = slots_.front().expected_received >= expected_count_;
    if (!complete && newer < hold) return;
    close_oldest(counters, sink);
  }
}

void OusterFrameAssembler::flush(LidarCounters& counters, const Sink& sink) {
  while (!slots_.empty()) close_oldest(counters, sink);
}

}  // namespace ca2
