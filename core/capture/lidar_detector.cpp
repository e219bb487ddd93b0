#include "core/capture/lidar_detector.h"

#include "core/features/lidar_sights.h"

namespace ca2 {

LidarObservation LidarDetector::detect(std::int64_t time, std::shared_ptr<const Scan> scan) {
  LidarObservation observation;
  observation.lidar = lidar_;
  observation.time = time;
  const std::vector<BoardCandidate> candidates = finder_.find(*scan);
  observation.sights = sights_of(*scan, board_, candidates);
  for (const BoardCandidate& candidate : candidates) {
    observation.novelty.push_back(background_.before(*scan, candidate.returns));
  }
  background_.add(*scan, time);
  observation.scan = std::move(scan);
  return observation;
}

}  // namespace ca2
