#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/robot_message_seeds.h"
#include "tools/ca2/import_log.h"

namespace ca2::fuzz {

std::vector<std::string> seeds() {
  const auto event = [](int number, std::uint64_t time, const std::string& channel, const std::string& data) {
    return big_endian(0xEDA1DA01, 4) + big_endian(static_cast<std::uint64_t>(number), 8) +
           big_endian(time, 8) + big_endian(channel.size(), 4) + big_endian(data.size(), 4) + channel + data;
  };
  std::vector<std::string> out;
  const std::vector<std::string> messages = robot_message_seeds();
  for (std::size_t i = 0; i + 1 < messages.size(); ++i) {
    out.push_back(event(0, 1'700'000'000'000'000, "LEFT", messages[0]) +
                  event(1, 1'700'000'000'000'007, "TOP", messages.back()) +
                  event(2, 1'700'000'000'000'100, "OTHER", messages[i]));
  }
  return out;
}

}  // namespace ca2::fuzz

/// What a plan names can be looked for in the log.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace ca2;
  static const fuzz::File file("log.lcm");
  static const Rig rig = [] {
    Rig two;
    two.cameras["left"];
    two.lidars["top"];
    return two;
  }();
  file.write({reinterpret_cast<const char*>(data), size});
  const auto plan = plan_log(file.path, rig, {}, 0.02);
  if (!plan) {
    fuzz::require(!plan.error().problems.empty(), "an error without a problem");
    return 0;
  }
  for (const LogGroup& group : plan->groups) {
    std::map<std::string, Image> images;
    std::map<std::string, Scan> scans;
    if (load_log_view(file.path, group, rig, images, scans))
      fuzz::require(images.size() + scans.size() == group.size(), "a part of a view is missing");
  }
  return 0;
}
