/// @file What sensor sends a stream of datagrams, told from the datagrams alone.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace ca2 {

struct StreamIdentity {
  std::string vendor;  ///< "Ouster", "Velodyne"; empty: not recognised
  std::string model;   ///< "VLP-16", "128 beams"; several when the packets leave it open; empty: not known
  std::string kind;    ///< "lidar", "IMU", "position", "zone", "unknown"
  std::vector<std::pair<std::string, std::string>> details;  ///< what the packets say, in the order to show
  std::optional<std::uint64_t>
      lost;  ///< packets missing between the first and the last; empty: cannot be told
};

/// Looks at the datagrams of one size from one sender to one port.
class Recogniser {
 public:
  Recogniser() = default;
  Recogniser(const Recogniser&) = delete;
  Recogniser& operator=(const Recogniser&) = delete;
  virtual ~Recogniser() = default;

  /// `payload` has the size that the recogniser was made for; `time` in ns.
  virtual void add(std::span<const std::uint8_t> payload, std::int64_t time) = 0;
  virtual StreamIdentity identity() const = 0;
};

/// For a stream that starts with `payload`: never null, at worst one that says "unknown".
std::unique_ptr<Recogniser> make_recogniser(std::span<const std::uint8_t> payload);

/// By vendor; null where the first datagram cannot be theirs.
std::unique_ptr<Recogniser> make_ouster_recogniser(std::span<const std::uint8_t> payload);
std::unique_ptr<Recogniser> make_velodyne_recogniser(std::span<const std::uint8_t> payload);

}  // namespace ca2
