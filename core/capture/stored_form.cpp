#include "core/capture/stored_form.h"

#include "core/capture/view_builder.h"

namespace ca2 {

StoreView stored_form(const HeldView& view, Tracks& tracks, const std::map<int, Pick>& picks, int id,
                      bool automatic) {
  StoreView action;
  action.id = id;
  ViewDetails details;
  details.automatic = automatic;
  details.gates = view.gates;
  for (const auto& [c, camera] : view.cameras) {
    const std::string& name = tracks.camera_names[c];
    details.pictures[name] = camera.pictures.size();
    details.corners[name] = camera.corners.size();
    action.images[name] = mean_image(camera.pictures);
    for (const CameraObservation* picture : camera.pictures) details.stamps[name].push_back(picture->time);
    tracks.cameras[c].release_before(camera.pictures.back()->time);
  }
  for (const auto& [l, lidar] : view.lidars) {
    const std::string& name = tracks.lidar_names[l];
    details.scans[name] = lidar.scans.size();
    for (const LidarObservation* scan : lidar.scans) {
      action.scans[name].push_back(scan->scan);
      details.stamps[name].push_back(scan->time);
    }
    if (const auto pick = picks.find(static_cast<int>(l)); pick != picks.end())
      action.picks[name] = pick->second;
  }
  details.picks = action.picks;
  action.details = details_text(details);
  return action;
}

}  // namespace ca2
