#include "drivers/recording/ordered_detection.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "core/capture/camera_detector.h"
#include "core/capture/lidar_detector.h"

namespace ca2 {
namespace {

/// A frame on its way.
struct Job {
  RecordedFrame frame;
  bool started = false, done = false;
  std::unique_ptr<SearchedFrame> result = std::make_unique<SearchedFrame>();

  bool picture() const { return frame.image != nullptr; }
};

}  // namespace

struct OrderedDetection::State {
  RecordingReader& reader;
  std::size_t look_ahead;
  std::vector<CameraDetector> cameras;
  std::vector<LidarDetector> lidars;
  std::vector<char> camera_busy, lidar_busy;

  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::unique_ptr<Job>> jobs;  ///< in order
  bool ended = false, stopping = false;
  std::vector<std::jthread> workers;

  State(const Rig& rig, RecordingReader& reader_in, int threads)
      : reader(reader_in), look_ahead(4 * static_cast<std::size_t>(threads) + 4) {
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) cameras.emplace_back(rig.board, static_cast<int>(c));
    for (std::size_t l = 0; l < rig.lidars.size(); ++l) lidars.emplace_back(rig.board, static_cast<int>(l));
    camera_busy.assign(cameras.size(), 0);
    lidar_busy.assign(lidars.size(), 0);
    for (int i = 0; i < threads; ++i) workers.emplace_back([this] { work(); });
  }

  ~State() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
  }

  char& busy(const Job& job) {
    return (job.picture() ? camera_busy : lidar_busy)[static_cast<std::size_t>(job.frame.sensor)];
  }

  /// The first frame that waits, of a sensor whose frames before it are done. Under the lock.
  Job* find_job() {
    for (const auto& job : jobs) {
      if (!job->started && busy(*job) == 0) return job.get();
    }
    return nullptr;
  }

  void work() {
    std::unique_lock lock(mutex);
    for (;;) {
      Job* job = nullptr;
      changed.wait(lock, [&] { return stopping || (job = find_job()) != nullptr; });
      if (stopping) return;
      job->started = true;
      char& sensor = busy(*job);  // found while the job has its frame
      sensor = 1;
      lock.unlock();
      search(*job);
      lock.lock();
      job->done = true;
      sensor = 0;
      changed.notify_all();
    }
  }

  void search(Job& job) {
    const auto sensor = static_cast<std::size_t>(job.frame.sensor);
    job.result->arrival = job.frame.arrival;
    if (job.picture())
      job.result->observation = cameras[sensor].detect(job.frame.time, std::move(job.frame.image));
    else
      job.result->observation = lidars[sensor].detect(job.frame.time, std::move(job.frame.scan));
  }
};

OrderedDetection::OrderedDetection(const Rig& rig, RecordingReader& reader, int threads)
    : state_(std::make_unique<State>(rig, reader, std::max(1, threads))) {}

OrderedDetection::~OrderedDetection() = default;

std::unique_ptr<SearchedFrame> OrderedDetection::next() {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  while (!s.ended && s.jobs.size() < s.look_ahead) {
    // Reading takes as long as searching: not under the lock.
    lock.unlock();
    std::optional<RecordedFrame> frame = s.reader.next();
    lock.lock();
    if (!frame) {
      s.ended = true;
      break;
    }
    s.jobs.push_back(std::make_unique<Job>());
    s.jobs.back()->frame = std::move(*frame);
    s.changed.notify_all();
    if (s.jobs.front()->done) break;
  }
  if (s.jobs.empty()) return nullptr;
  s.changed.wait(lock, [&] { return s.jobs.front()->done; });
  std::unique_ptr<SearchedFrame> result = std::move(s.jobs.front()->result);
  s.jobs.pop_front();
  return result;
}

}  // namespace ca2
