#include "tools/sim/scenario_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

#include "core/io/files.h"
#include "core/io/yaml_reader.h"
#include "core/session/pose_yaml.h"
#include "drivers/lidar/model.h"

namespace ca2 {
namespace {

constexpr std::array<std::string_view, 6> scenario_keys{"truth", "views",     "scene",
                                                        "noise", "recording", "seed"};

/// A key that holds one number, its bounds, and where it goes.
struct NumberKey {
  std::string_view name;
  double least, most;
  double* target;
};

class ScenarioParser {
 public:
  ScenarioParser(const std::filesystem::path& file, ScenarioFile& out) : reader_(file.string()), out_(out) {}

  /// The keys that are not the rig's; the rig has been read.
  std::vector<Problem> parse(const YamlNode& root) {
    truth(reader_.require(root, "truth", "the scenario"));
    views(root.find("views"));
    scene(root.find("scene"));
    noise(root.find("noise"));
    carrying(root.find("recording"));
    if (const auto seed = reader_.integer(root.find("seed"), 0, std::numeric_limits<long long>::max())) {
      scenario().seed = static_cast<std::uint64_t>(*seed);
    }
    return reader_.problems();
  }

 private:
  Scenario& scenario() { return out_.scenario; }

  /// A map of single numbers; `others` are its further keys, which the caller reads.
  bool number_map(const YamlNode* node, std::string_view what, const std::vector<NumberKey>& keys,
                  const std::vector<std::string_view>& others = {}) {
    std::vector<std::string_view> known = others;
    for (const NumberKey& key : keys) known.push_back(key.name);
    if (!reader_.map(node, what, known)) return false;
    for (const NumberKey& key : keys) {
      *key.target = reader_.number(node->find(key.name), key.least, key.most).value_or(*key.target);
    }
    return true;
  }

  void whole(const YamlNode& map, std::string_view key, int least, int most, int& target) {
    if (const auto value = reader_.integer(map.find(key), least, most)) target = static_cast<int>(*value);
  }

  void interval(const YamlNode& map, std::string_view key, double most, double& low, double& high) {
    const YamlNode* node = map.find(key);
    const auto values = reader_.numbers(node, 2, most);
    if (!values) return;
    low = (*values)[0];
    high = (*values)[1];
    if (!(low >= 0 && low <= high)) {
      reader_.problem(*node, std::string(key) + " must be [least, most], neither below 0");
    }
  }

  bool is_sensor(const std::string& name) const {
    return out_.scenario.cameras.contains(name) || out_.scenario.lidars.contains(name);
  }

  std::string sensor(const YamlNode* node) {
    const auto name = reader_.text(node);
    if (!name) return {};
    if (is_sensor(*name)) return *name;
    std::vector<std::string_view> known;
    for (const auto& [camera, value] : out_.scenario.cameras) known.push_back(camera);
    for (const auto& [lidar, value] : out_.scenario.lidars) known.push_back(lidar);
    reader_.problem(*node, "there is no sensor '" + *name + "'", suggest(*name, known));
    return {};
  }

  void truth(const YamlNode* node) {
    if (!reader_.map(node, "truth", {"extrinsics", "intrinsics_error", "hide_intrinsics"})) return;
    std::vector<RigExtrinsic> links;
    if (const YamlNode* list = node->find("extrinsics"); reader_.sequence(list, "extrinsics")) {
      for (const YamlNode& item : list->items) {
        if (!reader_.map(&item, "an extrinsic", {"parent", "child", "translation", "rotation"})) continue;
        RigExtrinsic link;
        link.parent = sensor(reader_.require(item, "parent", "the extrinsic"));
        link.child = sensor(reader_.require(item, "child", "the extrinsic"));
        const auto pose = read_pose(reader_, item, "the extrinsic");
        if (link.parent.empty() || link.child.empty() || !pose) continue;
        link.T_parent_child = *pose;
        links.push_back(link);
      }
    }
    mount(*node, links);
    number_map(
        node->find("intrinsics_error"), "intrinsics_error",
        {{"pixel", 0, 100, &out_.intrinsics_error.pixel}, {"focal", 0, 0.2, &out_.intrinsics_error.focal}});
    out_.intrinsics_error.hide = reader_.boolean(node->find("hide_intrinsics")).value_or(false);
  }

  /// Follows the true extrinsics from the reference, the first LiDAR, to every sensor.
  void mount(const YamlNode& node, const std::vector<RigExtrinsic>& links) {
    std::map<std::string, Pose> T_rig;
    if (!scenario().lidars.empty()) {
      T_rig[scenario().lidars.begin()->first] = Pose{};
    } else {
      // Without a LiDAR the first camera looks along the rig's x axis, upright.
      Pose T_rig_camera;
      T_rig_camera.R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
      T_rig[scenario().cameras.begin()->first] = T_rig_camera;
    }
    for (std::size_t pass = 0; pass <= links.size(); ++pass) {
      for (const RigExtrinsic& link : links) {
        if (T_rig.contains(link.parent) && !T_rig.contains(link.child)) {
          T_rig[link.child] = T_rig[link.parent] * link.T_parent_child;
        } else if (T_rig.contains(link.child) && !T_rig.contains(link.parent)) {
          T_rig[link.parent] = T_rig[link.child] * link.T_parent_child.inverse();
        }
      }
    }
    const auto mounted = [&](const std::string& name, Pose& T_rig_sensor) {
      if (T_rig.contains(name)) {
        T_rig_sensor = T_rig[name];
      } else {
        reader_.problem(node, "nothing says where sensor '" + name + "' is",
                        "connect it to the others in truth: extrinsics");
      }
    };
    for (auto& [name, camera] : scenario().cameras) mounted(name, camera.T_rig_camera);
    for (auto& [name, lidar] : scenario().lidars) mounted(name, lidar.T_rig_lidar);
  }

  void views(const YamlNode* node) {
    Placement& placement = scenario().placement;
    constexpr double max_angle = 1.4;  // rad: beyond, no sensor sees the print
    if (!number_map(
            node, "views",
            {{"roll", 0, 3.15, &placement.max_roll}, {"pixel_margin", 0, 1000, &placement.pixel_margin}},
            {"count", "distance", "tilt", "min_rings", "min_returns", "groups"})) {
      return;
    }
    whole(*node, "count", 1, 100000, scenario().views);
    interval(*node, "distance", 100, placement.min_distance, placement.max_distance);
    interval(*node, "tilt", max_angle, placement.min_tilt, placement.max_tilt);
    whole(*node, "min_rings", 0, 1000, placement.min_rings);
    whole(*node, "min_returns", 0, 1000000, placement.min_returns);
    const YamlNode* groups = node->find("groups");
    if (!reader_.sequence(groups, "groups")) return;
    for (const YamlNode& group : groups->items) {
      if (!reader_.sequence(&group, "a group")) continue;
      std::vector<std::string> names;
      for (const YamlNode& item : group.items) {
        if (std::string name = sensor(&item); !name.empty()) names.push_back(std::move(name));
      }
      if (names.empty()) {
        reader_.problem(group, "a group needs at least one sensor");
      } else {
        placement.groups.push_back(std::move(names));
      }
    }
  }

  void carrying(const YamlNode* node) {
    Carrying& carrying = scenario().carrying;
    if (!number_map(node, "recording",
                    {{"away", 0, 1, &carrying.away},
                     {"tremor", 0, 0.1, &carrying.tremor},
                     {"drift", 0, 0.1, &carrying.drift},
                     {"camera_rate", 1, 200, &carrying.camera_rate},
                     {"lost_pictures", 0, 0.9, &carrying.lost_pictures},
                     {"clock_offset", -1, 1, &carrying.clock_offset}},
                    {"hold", "move", "triggered"})) {
      return;
    }
    carrying.triggered = reader_.boolean(node->find("triggered")).value_or(carrying.triggered);
    constexpr double longest = 60;  // s
    interval(*node, "hold", longest, carrying.min_hold, carrying.max_hold);
    interval(*node, "move", longest, carrying.min_move, carrying.max_move);
  }

  void scene(const YamlNode* node) {
    Room& room = scenario().room.emplace();
    if (!number_map(node, "scene",
                    {{"rig_height", 0.1, 10, &room.rig_height},
                     {"hand_cover", 0, 0.09, &room.hand_cover},
                     {"bend", -0.1, 0.1, &scenario().bend}},
                    {"size", "furniture", "person", "second_person", "wrong_objects"})) {
      return;
    }
    const YamlNode* size_node = node->find("size");
    if (const auto size = reader_.numbers(size_node, 3, 200)) {
      if (std::any_of(size->begin(), size->end(), [](double edge) { return edge < 2; })) {
        reader_.problem(*size_node, "a room's edges must be 2 m or more");
      }
      room.length = (*size)[0];
      room.width = (*size)[1];
      room.height = (*size)[2];
      if (room.rig_height >= room.height)
        reader_.problem(*size_node, "the rig stands higher than the ceiling");
    }
    whole(*node, "furniture", 0, 1000, room.furniture);
    room.person = reader_.boolean(node->find("person")).value_or(room.person);
    room.second_person = reader_.boolean(node->find("second_person")).value_or(room.second_person);
    const YamlNode* wrong = node->find("wrong_objects");
    if (!number_map(wrong, "wrong_objects", {{"fraction", 0, 1, &scenario().wrong_fraction}}, {"kind"}))
      return;
    if (const auto kind = reader_.text(wrong->find("kind"))) {
      constexpr std::array<std::string_view, 2> kinds{"panel", "moved"};
      if (*kind != kinds[0] && *kind != kinds[1]) {
        reader_.problem(*wrong->find("kind"), "there is no kind '" + *kind + "'", suggest(*kind, kinds));
      }
      scenario().wrong_object = *kind == kinds[0] ? WrongObject::panel : WrongObject::moved;
    }
  }

  void camera_noise(const YamlNode* node, CameraNoise& noise) {
    if (!number_map(node, "camera noise",
                    {{"sigma", 0, 1, &noise.sigma},
                     {"blur", 0, 20, &noise.blur},
                     {"vignetting", 0, 1, &noise.vignetting},
                     {"corner_sigma", 0, 100, &noise.corner_sigma}},
                    {"bits"})) {
      return;
    }
    whole(*node, "bits", 8, 16, noise.bits);
    if (noise.bits != 8 && noise.bits != 16) reader_.problem(*node->find("bits"), "bits must be 8 or 16");
  }

  void lidar_noise(const YamlNode* node, LidarNoise& noise) {
    if (!number_map(node, "lidar noise",
                    {{"range_sigma", 0, 1, &noise.range_sigma},
                     {"range_bias", -1, 1, &noise.range_bias},
                     {"reflectivity_bias", -1, 1, &noise.reflectivity_bias},
                     {"divergence", 0, 0.1, &noise.divergence},
                     {"beam_width", 0, 0.1, &noise.beam_width},
                     {"pulse_length", 0, 10, &noise.pulse_length},
                     {"dropout", 0, 1, &noise.dropout},
                     {"intensity_sigma", 0, 1, &noise.intensity_sigma}},
                    {"sweeps"})) {
      return;
    }
    whole(*node, "sweeps", 1, 1000, noise.sweeps);
  }

  /// `cameras` and `lidars` hold for all of a kind, `sensors` for one by name on top.
  void noise(const YamlNode* node) {
    if (!reader_.map(node, "noise", {"cameras", "lidars", "sensors"})) return;
    for (auto& [name, camera] : scenario().cameras) camera_noise(node->find("cameras"), camera.noise);
    for (auto& [name, lidar] : scenario().lidars) lidar_noise(node->find("lidars"), lidar.noise);
    const YamlNode* sensors = node->find("sensors");
    if (!reader_.map(sensors, "sensors")) return;
    for (const YamlNode& item : sensors->items) {
      if (const auto camera = scenario().cameras.find(item.key); camera != scenario().cameras.end()) {
        camera_noise(&item, camera->second.noise);
      } else if (const auto lidar = scenario().lidars.find(item.key); lidar != scenario().lidars.end()) {
        lidar_noise(&item, lidar->second.noise);
      } else {
        reader_.key_problem(item, "there is no sensor '" + item.key + "'");
      }
    }
  }

  YamlReader reader_;
  ScenarioFile& out_;
};

/// The true sensors that the rig's keys describe.
void equip(ScenarioFile& out, std::vector<Problem>& problems) {
  const std::string where = out.file.string();
  for (const auto& [name, rig_camera] : out.rig.cameras) {
    if (!rig_camera.intrinsics || rig_camera.width == 0) {
      problems.push_back({where, "camera '" + name + "' needs intrinsics and image_size",
                          "they are the true ones; truth: hide_intrinsics keeps them from the session"});
      continue;
    }
    out.scenario.cameras[name].camera = *rig_camera.intrinsics;
  }
  for (const auto& [name, rig_lidar] : out.rig.lidars) {
    LidarModelSpec spec;
    spec.model = rig_lidar.model;
    if (!rig_lidar.metadata.empty()) spec.metadata = out.file.parent_path() / rig_lidar.metadata;
    if (!rig_lidar.calibration.empty()) spec.calibration = out.file.parent_path() / rig_lidar.calibration;
    Result<BeamTable> beams = make_beam_table(spec);
    if (!beams) {
      for (const Problem& problem : beams.error().problems) {
        problems.push_back({problem.where.empty() ? where : problem.where,
                            "lidar '" + name + "': " + problem.what, problem.hint});
      }
      continue;
    }
    SimulatedLidar& lidar = out.scenario.lidars[name];
    lidar.beams = std::move(*beams);
    // An Ouster fires at encoder positions; a Velodyne at its own clock, wherever the head is.
    const auto model = find_lidar_model(spec.model);
    lidar.noise.free_running_azimuth = spec.metadata.empty() && !(model && (*model)->ouster());
  }
}

}  // namespace

Result<ScenarioFile> read_scenario(const std::filesystem::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  Result<Rig> rig = parse_rig(*text, file, {scenario_keys.begin(), scenario_keys.end()});
  std::vector<Problem> problems;
  if (!rig) return fail(rig.error());
  ScenarioFile out;
  out.file = file;
  out.rig = std::move(*rig);
  out.scenario.name = file.stem().string();
  out.scenario.board = out.rig.board;
  equip(out, problems);
  if (problems.empty()) {
    const Result<YamlNode> root = parse_yaml(*text, file.string());
    if (!root) return fail(root.error());
    problems = ScenarioParser(file, out).parse(*root);
  }
  if (!problems.empty()) return fail(ErrorCode::config, std::move(problems));
  return out;
}

Rig stated_rig(const ScenarioFile& file) {
  Rig rig = file.rig;
  std::mt19937_64 rng = view_generator(file.scenario, 0);
  for (auto& [name, camera] : rig.cameras) {
    std::uniform_real_distribution<double> unit(-1, 1);
    const double focal = 1 + file.intrinsics_error.focal * unit(rng);
    const double cx = file.intrinsics_error.pixel * unit(rng);
    const double cy = file.intrinsics_error.pixel * unit(rng);
    if (file.intrinsics_error.hide) {
      camera.intrinsics.reset();
      continue;
    }
    CameraParameters& parameters = camera.intrinsics->parameters;
    parameters.head<2>() *= focal;
    parameters[2] += cx;
    parameters[3] += cy;
  }
  return rig;
}

}  // namespace ca2
