#include "core/capture/lidar_detector.h"

#include "core/features/lidar_sights.h"

namespace ca2 {

LidarObservation LidarDetector::detect(std::int64_t time, std::shared_ptr<const Scan> scan) {
  LidarObservation observation;
  observation.lidar = lidar_;
  observation.time = time;
  for (const BoardCandidate& candidate : finder_.find(*scan)) {
    observation.sights.push_back(sight_of(*scan, board_, candidate));
    observation.novelty.push_back(background_.before(*scan, candidate.returns));
  }
  background_.add(*scan, time);
  observation.scan = std::move(scan);
  return observation;
}

}  // namespace ca2
