#include "tests/support/lidar_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ca2::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180, kNone = std::numeric_limits<double>::infinity();

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  bool chance(double p) { return between(0, 1) < p; }
  double normal() {
    const double u = between(1e-12, 1), v = between(0, 2 * std::numbers::pi);
    return std::sqrt(-2 * std::log(u)) * std::cos(v);
  }
  std::mt19937_64& engine() { return engine_; }

 private:
  std::mt19937_64 engine_;
};

Pose upright(double x, double y, double z, double yaw) {
  return {so3_exp({0, 0, yaw}), {x, y, z}};
}

SceneShape box(const Pose& T, double x, double y, double z) {
  return {SceneShape::Kind::box, T, {x / 2, y / 2, z / 2}};
}

SceneShape capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), b - a);
  return {SceneShape::Kind::capsule, Pose::from_quaternion(q, (a + b) / 2), {radius, (b - a).norm() / 2, 0}};
}

/// First crossing of a unit sphere scaled by `radii`, at `centre`.
double cast_ellipsoid(Eigen::Vector3d o, Eigen::Vector3d d, const Eigen::Vector3d& radii) {
  o = o.cwiseQuotient(radii);
  d = d.cwiseQuotient(radii);
  const double a = d.squaredNorm(), b = o.dot(d), disc = b * b - a * (o.squaredNorm() - 1);
  if (disc < 0) return kNone;
  const double t = (-b - std::sqrt(disc)) / a;
  return t > 0 ? t : kNone;
}

double cast_capsule(const Eigen::Vector3d& o, const Eigen::Vector3d& d, double radius, double half) {
  double best = kNone;
  for (const double end : {-half, half}) {
    best =
        std::min(best, cast_ellipsoid(o - Eigen::Vector3d(0, 0, end), d, Eigen::Vector3d::Constant(radius)));
  }
  const double a = d.head<2>().squaredNorm(), b = o.head<2>().dot(d.head<2>());
  const double disc = b * b - a * (o.head<2>().squaredNorm() - radius * radius);
  if (a > 1e-12 && disc >= 0) {
    const double t = (-b - std::sqrt(disc)) / a;
    if (t > 0 && std::abs(o.z() + t * d.z()) < half) best = std::min(best, t);
  }
  return best;
}

double cast_slabs(const Eigen::Vector3d& o, const Eigen::Vector3d& d, const Eigen::Vector3d& half,
                  bool leave) {
  double enter = -kNone, exit = kNone;
  for (int k = 0; k < 3; ++k) {
    const double inverse = 1 / (std::abs(d(k)) < 1e-12 ? 1e-12 : d(k));
    const double a = (-half(k) - o(k)) * inverse, b = (half(k) - o(k)) * inverse;
    enter = std::max(enter, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  if (leave) return exit;
  return enter <= exit && enter > 0 ? enter : kNone;
}

/// Everything but the board; the sensor is at the origin.
struct Stage {
  std::vector<SceneShape> shapes;  ///< the plate is the first
};

void add_table(std::vector<SceneShape>& shapes, double x, double y, double floor, double yaw, Dice& dice) {
  const double length = dice.between(0.8, 1.6), depth = dice.between(0.5, 0.9),
               top = dice.between(0.45, 0.78);
  const Pose T = upright(x, y, floor, yaw);
  shapes.push_back(box(T * upright(0, 0, top, 0), length, depth, 0.04));
  for (const double sx : {-0.5, 0.5}) {
    for (const double sy : {-0.5, 0.5}) {
      shapes.push_back(
          box(T * upright(sx * (length - 0.06), sy * (depth - 0.06), top / 2, 0), 0.05, 0.05, top));
    }
  }
  if (dice.chance(0.6)) {  // a screen, or a small box; one of the board's very size nobody could tell from it
    const bool screen = dice.chance(0.5);
    const double width = screen ? dice.between(0.52, 0.62) : dice.between(0.2, 0.34), height = 0.6 * width;
    shapes.push_back(box(T * upright(0, 0, top + 0.02 + height / 2, dice.between(-0.5, 0.5)), width,
                         screen ? 0.03 : dice.between(0.1, 0.3), height));
  }
}

void furnish(std::vector<SceneShape>& shapes, const Eigen::Vector3d& room, const Eigen::Vector3d& middle,
             const SceneSetup& setup, double floor, Dice& dice) {
  const auto on_wall = [&](double depth, double& x, double& y, double& yaw) {
    const int wall = static_cast<int>(dice.between(0, 4));
    const double along = dice.between(-0.8, 0.8);
    yaw = wall < 2 ? std::numbers::pi / 2 : 0;
    const double sign = wall % 2 == 0 ? 1 : -1;
    x = middle.x() + (wall < 2 ? sign * (room.x() / 2 - depth / 2) : along * room.x() / 2);
    y = middle.y() + (wall < 2 ? along * room.y() / 2 : sign * (room.y() / 2 - depth / 2));
  };
  double x = 0, y = 0, yaw = 0;
  const int cabinets = static_cast<int>(dice.between(2, 5));
  for (int i = 0; i < cabinets; ++i) {
    const double depth = dice.between(0.3, 0.6), height = dice.between(0.7, 2.1);
    on_wall(depth, x, y, yaw);
    shapes.push_back(box(upright(x, y, floor + height / 2, yaw), dice.between(0.5, 1.2), depth, height));
  }
  for (int i = 0; i < 3; ++i) {  // pictures and boards on the walls
    on_wall(0.03, x, y, yaw);
    shapes.push_back(box(upright(x, y, floor + dice.between(1.2, 1.7), yaw), dice.between(0.4, 1.2), 0.03,
                         dice.between(0.3, 0.9)));
  }
  const auto on_floor = [&](double clear) {
    do {
      x = middle.x() + dice.between(-0.42, 0.42) * room.x();
      y = middle.y() + dice.between(-0.42, 0.42) * room.y();
    } while (std::hypot(x, y) < clear);
    yaw = dice.between(-3, 3);
  };
  for (int i = 0; i < 2; ++i) {
    on_floor(1.5);
    add_table(shapes, x, y, floor, yaw, dice);
  }
  const int boxes = static_cast<int>(dice.between(2, 6));
  for (int i = 0; i < boxes; ++i) {
    on_floor(1.2);
    const double height = dice.between(0.25, 0.9);
    shapes.push_back(
        box(upright(x, y, floor + height / 2, yaw), dice.between(0.3, 0.7), dice.between(0.3, 0.7), height));
  }
  on_floor(1.6);  // an open door
  shapes.push_back(box(upright(x, y, floor + 1, yaw), 0.85, 0.04, 2.0));
  if (dice.chance(0.5)) {  // a panel on a stand, nearly of the board's size
    on_floor(1.6);
    const double scale = dice.chance(0.5) ? 0.7 : 1.35;
    shapes.push_back(box(upright(x, y, floor + dice.between(0.8, 1.4), yaw), scale * setup.width, 0.02,
                         scale * setup.height));
    shapes.push_back(capsule({x, y, floor}, {x, y, floor + 0.7}, 0.02));
  }
}

/// Who holds the plate: hands at two opposite places of its rim, arms bent to the shoulders, the body
/// upright behind it.
void add_person(std::vector<SceneShape>& shapes, const Pose& T_board, const SceneSetup& setup, double floor,
                Dice& dice) {
  const Eigen::Vector3d away(T_board.t.x(), T_board.t.y(), 0), back = away.normalized();
  const Eigen::Vector3d side(-back.y(), back.x(), 0);
  const double gap = dice.between(0.22, 0.45);
  const Eigen::Vector3d foot = T_board.t + gap * back + dice.between(-0.1, 0.1) * side;
  const double height = dice.between(1.6, 1.9);
  const Eigen::Vector3d chest(foot.x(), foot.y(), floor + 0.72 * height);
  const double yaw = std::atan2(back.y(), back.x());
  shapes.push_back(
      {SceneShape::Kind::ellipsoid, upright(chest.x(), chest.y(), chest.z() - 0.1, yaw), {0.13, 0.22, 0.36}});
  shapes.push_back({SceneShape::Kind::ellipsoid,
                    upright(chest.x(), chest.y(), floor + height - 0.12, yaw),
                    {0.1, 0.08, 0.13}});
  for (const double s : {-1.0, 1.0}) {
    const Eigen::Vector3d hip(foot.x() + s * 0.1 * side.x(), foot.y() + s * 0.1 * side.y(),
                              floor + 0.48 * height);
    shapes.push_back(capsule(hip, {hip.x(), hip.y(), floor + 0.08}, 0.075));
    const Eigen::Vector3d shoulder = chest + s * 0.22 * side + Eigen::Vector3d(0, 0, 0.13);
    // The rim point farthest to this side, or somewhat below it.
    Eigen::Vector3d best = T_board.t;
    double most = -1e9;
    for (int k = 0; k < 36; ++k) {
      const double a = k * std::numbers::pi / 18, c = std::cos(a), d = std::sin(a);
      const double reach = std::min(setup.width / 2 / std::max(1e-9, std::abs(c)),
                                    setup.height / 2 / std::max(1e-9, std::abs(d)));
      const Eigen::Vector3d rim = T_board * Eigen::Vector3d(c * reach, d * reach, 0);
      const double value = s * side.dot(rim - T_board.t) - 0.3 * std::abs(rim.z() - T_board.t.z() + 0.05);
      if (value > most) most = value, best = rim;
    }
    const Eigen::Vector3d hand = best + 0.012 * (best - T_board.t).normalized() + 0.02 * back;
    const Eigen::Vector3d elbow = (hand + shoulder) / 2 + Eigen::Vector3d(0, 0, -0.12) + s * 0.08 * side;
    shapes.push_back(
        {SceneShape::Kind::ellipsoid, {Eigen::Matrix3d::Identity(), hand}, Eigen::Vector3d::Constant(0.035)});
    shapes.push_back(capsule(hand, elbow, 0.035));
    shapes.push_back(capsule(elbow, shoulder, 0.045));
  }
}

Stage make_stage(const SceneSensor& sensor, const SceneSetup& setup, Dice& dice, Pose& T_board) {
  Stage stage;
  const double floor = -sensor.mount_height;
  const Eigen::Vector3d room(dice.between(7, 13), dice.between(7, 12), dice.between(2.7, 3.5));
  const Eigen::Vector3d middle(dice.between(-0.8, 0.8), dice.between(-0.8, 0.8), floor + room.z() / 2);
  const double most = std::min({setup.farthest, room.x() / 2 - 1.4, room.y() / 2 - 1.4});
  const double distance = dice.between(std::min(setup.nearest, most), most),
               azimuth = dice.between(-3.1, 3.1);
  const double elevation = dice.between(sensor.least_elevation, sensor.most_elevation);
  const Eigen::Vector3d ahead(std::cos(azimuth) * std::cos(elevation),
                              std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
  // z away from the sensor, tilted about a random axis across the line of sight, turned in its plane.
  const Eigen::Vector3d axis = so3_exp(ahead * dice.between(-3, 3)) * ahead.unitOrthogonal();
  const Eigen::Matrix3d facing =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ahead).toRotationMatrix();
  T_board = {so3_exp(axis * dice.between(0, setup.tilt)) * facing * so3_exp({0, 0, dice.between(-3, 3)}),
             distance * ahead};
  stage.shapes.push_back(box(T_board, setup.width, setup.height, 0.006));
  // The front face is the plane that counts.
  T_board.t -= 0.003 * T_board.R.col(2);
  stage.shapes.push_back({SceneShape::Kind::room, {Eigen::Matrix3d::Identity(), middle}, room / 2});
  add_person(stage.shapes, T_board, setup, floor, dice);
  if (setup.furniture) furnish(stage.shapes, room, middle, setup, floor, dice);
  return stage;
}

struct Hit {
  double range = kNone;
  int shape = -1;
};

class Caster {
 public:
  explicit Caster(const Stage& stage) : stage_(stage) {
    for (const SceneShape& shape : stage.shapes) reach_.push_back(shape.bounding_radius());
  }
  Hit cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    Hit hit;
    for (std::size_t i = 0; i < reach_.size(); ++i) {
      const Eigen::Vector3d to = stage_.shapes[i].T_scene_shape.t - origin;
      const double along = to.dot(direction);
      if (stage_.shapes[i].kind != SceneShape::Kind::room &&
          (along < -reach_[i] || to.squaredNorm() - along * along > reach_[i] * reach_[i])) {
        continue;
      }
      const double range = stage_.shapes[i].cast(origin, direction);
      if (range < hit.range) hit = {range, static_cast<int>(i)};
    }
    return hit;
  }

 private:
  const Stage& stage_;
  std::vector<double> reach_;
};

struct Beam {
  Eigen::Vector3d origin, direction;
};

Beam beam_at(const SceneSensor& sensor, std::size_t ring, double column) {
  const double angle =
      std::numbers::pi - 2 * std::numbers::pi * column / sensor.columns + sensor.azimuth[ring];
  const double c = std::cos(angle), s = std::sin(angle), e = sensor.elevation[ring];
  return {{sensor.radius * c, sensor.radius * s, sensor.lift[ring]},
          {c * std::cos(e), s * std::cos(e), std::sin(e)}};
}

}  // namespace

double SceneShape::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d o = T_scene_shape.R.transpose() * (origin - T_scene_shape.t);
  const Eigen::Vector3d d = T_scene_shape.R.transpose() * direction;
  switch (kind) {
    case Kind::ellipsoid:
      return cast_ellipsoid(o, d, half);
    case Kind::capsule:
      return cast_capsule(o, d, half.x(), half.y());
    case Kind::box:
    case Kind::room:
      break;
  }
  return cast_slabs(o, d, half, kind == Kind::room);
}

double SceneShape::bounding_radius() const {
  return kind == Kind::capsule ? half.x() + half.y() : half.norm();
}

SceneSensor SceneSensor::vlp16() {
  SceneSensor s;
  s.name = "VLP-16";
  for (int ring = 0; ring < 16; ++ring) s.elevation.push_back((2 * ring - 15) * kDegree);
  s.azimuth.assign(16, 0);
  s.lift.assign(16, 0);
  s.columns = 1800;
  s.divergence = 3e-3;
  s.mount_height = 1.1;
  s.least_elevation = -6 * kDegree, s.most_elevation = 6 * kDegree;
  return s;
}

SceneSensor SceneSensor::os0_128() {
  SceneSensor s;
  s.name = "OS0-128";
  for (int ring = 0; ring < 128; ++ring) {
    s.elevation.push_back((45.0 - 90.0 * ring / 127) * kDegree);
    s.azimuth.push_back((4.22 - 2.81 * (ring % 4)) * kDegree);  // staggered, as in its metadata
  }
  s.lift.assign(128, 0.036);
  s.radius = 0.0277;
  s.columns = 1024;
  s.divergence = 6e-3;
  s.mount_height = 1.0;
  s.least_elevation = -20 * kDegree, s.most_elevation = 15 * kDegree;
  return s;
}

SceneSensor SceneSensor::hdl64e() {
  SceneSensor s;
  s.name = "HDL-64E";
  for (int ring = 0; ring < 64; ++ring) {  // two blocks; a third and half a degree between beams
    const bool lower = ring < 32;
    s.elevation.push_back((lower ? -24.33 + 0.5 * ring : -8.33 + (ring - 32) / 3.0) * kDegree);
    s.azimuth.push_back((ring % 2 == 0 ? 1 : -1) * (lower ? 6.0 : 3.5) * kDegree);
    s.lift.push_back(lower ? 0.16 - 0.001 * (ring % 32) : 0.215 - 0.0005 * (ring % 32));
  }
  s.columns = 2083;
  s.divergence = 2e-3;
  s.mount_height = 1.73;
  s.least_elevation = -12 * kDegree, s.most_elevation = -6 * kDegree;
  return s;
}

namespace {

/// What one pulse gives: at edges its footprint may meet two surfaces, and the range lies between them.
Hit measure(const Caster& caster, const SceneSensor& sensor, const Beam& beam, bool edge, bool& mixed,
            Dice& dice) {
  Hit hit = caster.cast(beam.origin, beam.direction);
  mixed = false;
  if (!edge) return hit;
  const Eigen::Vector3d side = beam.direction.unitOrthogonal(), up = beam.direction.cross(side);
  std::array<Hit, 6> part;
  for (Hit& h : part) {
    const double a = dice.between(-0.5, 0.5) * sensor.divergence,
                 b = dice.between(-0.5, 0.5) * sensor.divergence;
    h = caster.cast(beam.origin, (beam.direction + a * side + b * up).normalized());
  }
  const auto [near, far] =
      std::minmax_element(part.begin(), part.end(), [](auto& a, auto& b) { return a.range < b.range; });
  if (far->range - near->range < 0.03) return hit;
  mixed = true;
  if (far->range - near->range > 1.5 || dice.chance(0.3)) return dice.chance(0.5) ? *near : *far;
  double sum = 0;
  for (const Hit& h : part) sum += h.range / static_cast<double>(part.size());
  return {sum, near->shape};
}

void hand_over(Scene& scene, ScanForm form, const SceneSensor& sensor, Dice& dice) {
  Scan& scan = scene.scan;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (form == ScanForm::nan_grid || form == ScanForm::bare || scan.points[i].allFinite())
      order.push_back(i);
  }
  if (form == ScanForm::shuffled) std::shuffle(order.begin(), order.end(), dice.engine());
  Scan out;
  std::vector<std::uint8_t> labels;
  for (const std::size_t i : order) {
    const bool missing = !scan.points[i].allFinite();
    out.points.push_back(missing && form == ScanForm::bare ? Eigen::Vector3f::Zero().eval() : scan.points[i]);
    if (form != ScanForm::bare) out.ring.push_back(scan.ring[i]);
    if (form == ScanForm::full || form == ScanForm::nan_grid) out.column.push_back(scan.column[i]);
    labels.push_back(scene.on_board[i]);
  }
  if (form != ScanForm::bare) out.rings = static_cast<int>(sensor.elevation.size());
  if (!out.column.empty()) out.columns = sensor.columns;
  scene.scan = std::move(out);
  scene.on_board = std::move(labels);
}

}  // namespace

Scene make_scene(const SceneSensor& sensor, const SceneSetup& setup, ScanForm form, std::uint64_t seed) {
  Dice dice(seed);
  const std::size_t rings = sensor.elevation.size(), columns = static_cast<std::size_t>(sensor.columns);
  for (;;) {
    Scene scene;
    const Stage stage = make_stage(sensor, setup, dice, scene.T_lidar_board);
    scene.plane = board_plane(scene.T_lidar_board);
    scene.noise = dice.between(0.008, 0.02);
    const Caster caster(stage);
    std::vector<Hit> clean(rings * columns);
    std::size_t plate = 0, seen = 0;
    for (std::size_t r = 0; r < rings; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        const Beam beam = beam_at(sensor, r, static_cast<double>(c));
        clean[r * columns + c] = caster.cast(beam.origin, beam.direction);
        seen += clean[r * columns + c].shape == 0;
        plate += std::isfinite(stage.shapes[0].cast(beam.origin, beam.direction));
      }
    }
    scene.hidden = 1 - static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(plate, 1));
    if (plate < 20 || scene.hidden > 0.15) continue;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t c = 0; c < columns; ++c) {  // firing order: a column at a time
      for (std::size_t r = 0; r < rings; ++r) {
        const double range = clean[r * columns + c].range;
        bool edge = false;
        for (const std::size_t k : {(c + 1) % columns, (c + columns - 1) % columns}) {
          edge = edge || std::abs(clean[r * columns + k].range - range) > 0.03;
        }
        for (const std::size_t k : {r + 1, r - 1}) {
          edge = edge || (k < rings && std::abs(clean[k * columns + c].range - range) > 0.03);
        }
        const Beam beam = beam_at(sensor, r, static_cast<double>(c));
        bool mixed = false;
        const Hit hit = measure(caster, sensor, beam, edge, mixed, dice);
        const double measured = hit.range + scene.noise * dice.normal();
        const bool missing = dice.chance(0.01) || hit.range > 60;
        const Eigen::Vector3d p = beam.origin + measured * beam.direction;
        scene.scan.points.push_back(missing ? Eigen::Vector3f::Constant(nan).eval() : p.cast<float>().eval());
        scene.scan.ring.push_back(static_cast<std::uint16_t>(r));
        scene.scan.column.push_back(static_cast<std::uint32_t>(c));
        scene.on_board.push_back(hit.shape == 0 && !mixed && !missing);
      }
    }
    scene.shapes = stage.shapes;
    hand_over(scene, form, sensor, dice);
    return scene;
  }
}

}  // namespace ca2::test
