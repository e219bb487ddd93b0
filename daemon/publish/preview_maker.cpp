#include "daemon/publish/preview_maker.h"

#include <algorithm>

namespace ca2 {
namespace {

constexpr std::size_t most_waiting = 8;
constexpr std::chrono::seconds longest{5};

}  // namespace

PreviewMaker::PreviewMaker(EventLoop& loop, Heartbeats& heartbeats)
    : loop_(loop), thread_("preview", heartbeats, most_waiting, longest) {}

void PreviewMaker::set_rig(const Rig& rig) {
  names_.clear();
  for (const auto& [name, camera] : rig.cameras) names_.push_back(name);
  for (const auto& [name, lidar] : rig.lidars) names_.push_back(name);
  cameras_.assign(rig.cameras.size(), {});
  lidars_.assign(rig.lidars.size(), {});
}

void PreviewMaker::add(const CameraObservation& observation) {
  if (observation.searched) cameras_.at(static_cast<std::size_t>(observation.camera)) = observation;
}

void PreviewMaker::add(const LidarObservation& observation) {
  if (observation.searched) lidars_.at(static_cast<std::size_t>(observation.lidar)) = observation;
}

void PreviewMaker::make(const std::string& sensor, int width, Answer answer) {
  const auto name = std::find(names_.begin(), names_.end(), sensor);
  if (name == names_.end()) {
    return answer(fail(ErrorCode::usage, "", "the rig has no sensor '" + sensor.substr(0, 64) + "'"));
  }
  const auto index = static_cast<std::size_t>(name - names_.begin());
  std::function<Result<Preview>()> draw;
  if (index < cameras_.size()) {
    draw = [observation = cameras_[index], width] { return preview_of(observation, width); };
  } else {
    draw = [observation = lidars_[index - cameras_.size()], width] { return preview_of(observation, width); };
  }
  const bool taken = thread_.submit([this, draw = std::move(draw), answer] {
    auto preview = std::make_shared<Result<Preview>>(draw());
    loop_.post([preview, answer] { answer(std::move(*preview)); });
  });
  if (!taken) answer(fail(ErrorCode::unavailable, "", "too many previews are asked for"));
}

}  // namespace ca2
