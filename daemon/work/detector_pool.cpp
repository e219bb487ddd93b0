#include "daemon/work/detector_pool.h"

#include "core/capture/camera_detector.h"
#include "core/capture/lidar_detector.h"
#include "daemon/work/thread_name.h"
#include "daemon/work/thread_priority.h"

namespace ca2 {
namespace {

constexpr int thread_count = 2;
constexpr std::chrono::milliseconds idle_beat{500}, beat_margin{2000};
constexpr std::chrono::seconds longest_search{10};
constexpr std::size_t most_shed = 1000;  // while a search is stuck

}  // namespace

DetectorPool::DetectorPool(const Rig& rig, ObservationSink sink, Heartbeats& heartbeats) {
  for (int camera = 0; camera < static_cast<int>(rig.cameras.size()); ++camera) {
    Lane& lane = cameras_.emplace_back();
    const auto detector = std::make_shared<CameraDetector>(rig.board, camera);
    lane.search = [detector, out = sink.camera](Frame frame) {
      out(detector->detect(frame.time, std::move(frame.image)));
    };
    lane.report_shed = [camera, out = sink.camera](std::int64_t time) {
      CameraObservation shed;
      shed.camera = camera;
      shed.time = time;
      shed.searched = false;
      out(std::move(shed));
    };
  }
  for (int lidar = 0; lidar < static_cast<int>(rig.lidars.size()); ++lidar) {
    Lane& lane = lidars_.emplace_back();
    const auto detector = std::make_shared<LidarDetector>(rig.board, lidar);
    lane.search = [detector, out = sink.lidar](Frame frame) {
      out(detector->detect(frame.time, std::move(frame.scan)));
    };
    lane.report_shed = [lidar, out = sink.lidar](std::int64_t time) {
      LidarObservation shed;
      shed.lidar = lidar;
      shed.time = time;
      shed.searched = false;
      out(std::move(shed));
    };
  }
  for (int i = 0; i < thread_count; ++i) {
    const std::string name = "detector " + std::to_string(i + 1);
    threads_.emplace_back([this, name, beat = heartbeats.add(name)] {
      name_thread("ca2-" + name);
      let_receivers_go_first();
      run(*beat);
    });
  }
}

DetectorPool::~DetectorPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void DetectorPool::add(int camera, std::int64_t time, std::shared_ptr<const Image> image) {
  add(cameras_.at(static_cast<std::size_t>(camera)), {time, std::move(image), nullptr});
}

void DetectorPool::add(int lidar, std::int64_t time, std::shared_ptr<const Scan> scan) {
  add(lidars_.at(static_cast<std::size_t>(lidar)), {time, nullptr, std::move(scan)});
}

void DetectorPool::add(Lane& lane, Frame frame) {
  {
    const std::lock_guard lock(mutex_);
    if (lane.waiting && lane.shed.size() < most_shed) lane.shed.push_back(lane.waiting->time);
    lane.waiting = std::move(frame);
  }
  wake_.notify_one();
}

/// The sensor that has waited longest.
DetectorPool::Lane* DetectorPool::next() {
  Lane* oldest = nullptr;
  for (std::vector<Lane>* lanes : {&cameras_, &lidars_}) {
    for (Lane& lane : *lanes) {
      if (lane.busy || !lane.waiting) continue;
      if (!oldest || lane.waiting->time < oldest->waiting->time) oldest = &lane;
    }
  }
  return oldest;
}

void DetectorPool::run(Heartbeat& heartbeat) {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    heartbeat.beat(idle_beat + beat_margin);
    Lane* const lane = next();
    if (!lane) {
      wake_.wait_for(lock, idle_beat);
      continue;
    }
    Frame frame = std::move(*lane->waiting);
    lane->waiting.reset();
    const std::vector<std::int64_t> shed = std::exchange(lane->shed, {});
    lane->busy = true;
    lock.unlock();
    heartbeat.beat(longest_search);
    for (const std::int64_t time : shed) lane->report_shed(time);
    lane->search(std::move(frame));
    lock.lock();
    lane->busy = false;
  }
}

}  // namespace ca2
