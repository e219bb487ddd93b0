/// @file A booted T265 as a CameraSource of two imagers.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <thread>

#include "drivers/camera/camera_source.h"
#include "drivers/camera/frame_count.h"
#include "drivers/camera/frame_queue.h"
#include "drivers/camera/frame_watch.h"
#include "drivers/camera/t265/device.h"
#include "drivers/camera/t265/device_time.h"
#include "drivers/camera/t265/exposure.h"
#include "drivers/shared_pool.h"
#include "drivers/usb/usb_reader.h"

namespace ca2::t265 {

struct CameraOptions {
  Exposure exposure;
  /// Without a picture: the device hangs. Opening again takes a second, so it is not worth a false alarm.
  std::chrono::milliseconds silence{1000};
};

class T265Camera : public CameraSource {
 public:
  /// Reads the factory calibration.
  static Result<std::unique_ptr<T265Camera>> create(std::unique_ptr<Device> device,
                                                    const CameraOptions& options);
  ~T265Camera() override;

  const std::vector<CameraStream>& streams() const override { return streams_; }
  std::string description() const override;
  double frame_rate() const override { return rate_; }

  Result<void> start() override;
  CameraPoll next(std::chrono::milliseconds timeout) override;
  void stop() override;
  void interrupt() noexcept override { queue_.interrupt(); }

  Result<void> set_control(const std::string& name, const std::string& value) override;
  std::map<std::string, CameraControl> controls() const override;
  CameraCounters counters() const override;
  CameraCounters counters_of(int stream) const override;

 private:
  T265Camera(std::unique_ptr<Device> device, const CameraOptions& options, std::vector<CameraStream> streams,
             std::vector<StreamEntry> entries);

  // In the device's event thread.
  void received(ByteSpan bytes);
  void deliver(const Picture& picture);
  void happened(const Event& event);
  // In the keeper's thread: the clock and the exposure, while streaming.
  void keep();
  void write_exposure();

  const std::unique_ptr<Device> device_;
  const CameraOptions options_;
  const std::vector<CameraStream> streams_;
  const std::vector<StreamEntry> entries_;
  const double rate_;  ///< Hz

  FrameQueue queue_{8};
  // Of the thread that reads pictures:
  SharedPool<Image> pool_;
  std::vector<std::uint8_t> memory_;  ///< of the next picture
  std::unique_ptr<UsbReader> pictures_, events_;
  std::thread keeper_;
  bool started_ = false;
  FrameWatch watch_;   ///< of the thread that calls next()
  bool lost_ = false;  ///< next() has said so
  struct Losses {
    std::atomic<std::uint64_t> incomplete{0}, missed{0};
  };
  Losses losses_[2];  ///< by stream
  // Of the event thread, while the readers live.
  std::uint64_t begin_ = 0;  ///< device time; what is older was left over from an earlier run
  FrameCount counts_[2];     ///< by stream
  bool pictured_ = false;    ///< a picture has come since the start

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  bool stopping_ = false;  ///< on our request
  bool stopped_ = false;   ///< the device says so
  DeviceTime time_;
  Exposure exposure_;          ///< as wanted
  bool exposure_due_ = false;  ///< not written yet
  std::string exposure_problem_;
  std::uint32_t seen_exposure_ = 0;  ///< us, of the last picture
  float seen_gain_ = 0;              ///< factor, of the last picture
};

}  // namespace ca2::t265
