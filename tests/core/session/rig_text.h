/// @file A rig with one of everything.
#pragma once

namespace ca2::test {

inline constexpr const char* rig_text = R"(version: 1
board:
  type: checkerboard
  columns: 8
  rows: 5
  square: 0.040
  outline: {width: 0.420, height: 0.297, center: [0.001, -0.002]}
cameras:
  left:
    frame: left_camera_optical
    image_size: [1388, 1038]
    intrinsics: {model: pinhole_radtan, parameters: [1000.1, 1001.2, 690.3, 520.4, -0.1, 0.01, 1e-4, -2e-4, 0]}
    source: {driver: aravis, id: "Allied Vision-50-0503"}
  right:
    intrinsics: {model: kannala_brandt}
lidars:
  top:
    frame: top_lidar
    metadata: top.json
    source: {driver: ouster, host: 192.0.2.7, port: 7502}
  front:
    model: VLP-16
    calibration: front.yaml
extrinsics:
  - {parent: left, child: top, translation: [0.1, -0.2, 0.3], rotation: {x: 0.5, y: -0.5, z: 0.5, w: 0.5}}
  - {parent: left, child: right, translation: [0.5, 0, 0], rotation: {x: 0, y: 0, z: 0, w: 1}, fixed: true}
)";

}  // namespace ca2::test
