#include "daemon/sensors/lidar_sensor.h"

#include <mutex>
#include <tuple>

#include "core/types/text.h"
#include "daemon/config/check_sources.h"
#include "daemon/log.h"
#include "daemon/sensors/lidar_stream.h"
#include "daemon/sensors/ouster_metadata.h"
#include "drivers/net/udp_source.h"

namespace ca2 {
namespace {

constexpr std::chrono::milliseconds poll_time{200};

class LidarSensor : public SensorDevice {
 public:
  LidarSensor(const LidarAddress& address, std::filesystem::path file, InputSink& sink)
      : address_(address), file_(std::move(file)), sink_(sink) {}

  /// `asks`: the file of its metadata is what the sensor answers.
  void add(int index, const std::string& name, const RigLidar& lidar, const std::string& host, bool asks) {
    lidars_.push_back({index, name, lidar, host, asks, nullptr, 0});
  }

  Result<void> open() override {
    for (Lidar& lidar : lidars_) {
      if (lidar.asks) {
        if (const auto fetched = fetch_metadata(lidar.host, lidar.rig.metadata); !fetched) return fetched;
      }
      auto stream = LidarStream::open(lidar.rig, file_, lidar.host);
      if (!stream) return fail(stream.error());
      lidar.stream = std::make_unique<LidarStream>(std::move(*stream));
    }
    UdpSourceOptions options;
    options.ports = {address_.port};
    options.socket.address = address_.local_address;
    options.socket.multicast_group = address_.multicast_group;
    options.socket.interface = address_.interface;
    auto source = UdpSource::open(options);
    if (!source) return fail(source.error());
    if (const std::string& warning = (*source)->sockets()[0].warning; !warning.empty()) {
      log::warning("sensor", warning);
    }
    const std::lock_guard lock(mutex_);
    source_ = std::move(*source);
    if (interrupted_) source_->stop();
    return {};
  }

  Step step() override {
    const Result<PacketBatch> batch = source_->next_batch(poll_time);
    if (!batch) return {Event::lost, batch.error().text()};
    for (const Datagram& datagram : batch->datagrams) {
      for (Lidar& lidar : lidars_) {
        if (!lidar.host.empty() && datagram.source_address != lidar.host) continue;
        sink_.datagram(lidar.name, datagram);
        lidar.stream->push(datagram,
                           [&](const TimedScan& scan) { sink_.scan(lidar.index, scan.time, scan.scan); });
      }
    }
    return {};
  }

  void close() override {
    for (Lidar& lidar : lidars_) {
      lidar.lost_before += lost(lidar);
      lidar.stream.reset();
    }
    const std::lock_guard lock(mutex_);
    source_.reset();
  }

  void interrupt() noexcept override {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    if (source_) source_->stop();
  }

  std::map<std::string, SensorHealth> health() const override {
    std::map<std::string, SensorHealth> all;
    for (const Lidar& lidar : lidars_) {
      SensorHealth& health = all[lidar.name];
      health.lost = lidar.lost_before + lost(lidar);
      if (!lidar.stream) continue;
      health.device = lidar.stream->model() + formatted(" on UDP port %d", address_.port) +
                      (lidar.host.empty() ? "" : " from " + lidar.host);
      health.clock_sigma = lidar.stream->clock_sigma();
    }
    return all;
  }

 private:
  struct Lidar {
    int index = 0;
    std::string name;
    RigLidar rig;
    std::string host;
    bool asks = false;                    ///< for its metadata
    std::unique_ptr<LidarStream> stream;  ///< while it is open
    std::uint64_t lost_before = 0;        ///< packets, until it was closed
  };

  /// Packets since it was opened.
  std::uint64_t lost(const Lidar& lidar) const {
    return (lidar.stream ? lidar.stream->lost() : 0) + (source_ ? source_->counters().kernel_dropped : 0);
  }

  LidarAddress address_;
  std::filesystem::path file_;
  InputSink& sink_;
  std::vector<Lidar> lidars_;

  std::mutex mutex_;  ///< source_ as interrupt() sees it
  std::unique_ptr<UdpSource> source_;
  bool interrupted_ = false;
};

}  // namespace

std::vector<std::unique_ptr<SensorDevice>> make_lidar_sensors(const Rig& rig,
                                                              const std::filesystem::path& file,
                                                              const std::filesystem::path& state,
                                                              InputSink& sink) {
  using Key = std::tuple<std::uint16_t, std::string, std::string, std::string>;
  std::map<Key, std::unique_ptr<LidarSensor>> by_socket;
  int index = 0;
  for (const auto& [name, lidar] : rig.lidars) {
    std::vector<Problem> judged_already;
    const LidarAddress address = read_lidar_address(name, lidar, judged_already);
    auto& sensor =
        by_socket[{address.port, address.local_address, address.multicast_group, address.interface}];
    if (!sensor) sensor = std::make_unique<LidarSensor>(address, file, sink);
    const bool asks = lidar.metadata == kept_metadata(state, name).string();
    sensor->add(index++, name, lidar, address.host, asks);
  }
  std::vector<std::unique_ptr<SensorDevice>> sensors;
  for (auto& [key, sensor] : by_socket) sensors.push_back(std::move(sensor));
  return sensors;
}

}  // namespace ca2
