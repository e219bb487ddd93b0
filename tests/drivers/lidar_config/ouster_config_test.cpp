#include "drivers/lidar_config/ouster_config.h"

#include <gtest/gtest.h>

#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/lidar/ouster/metadata.h"
#include "tests/drivers/lidar_config/fake_ouster.h"

namespace ca2 {
namespace {

using namespace ca2::test;
using namespace std::chrono_literals;
using nlohmann::json;

/// Firmware 1.x.
std::string tcp_answer(FakeOuster& sensor, const std::string& request) {
  const std::lock_guard lock(sensor.mutex);
  std::istringstream words(request);
  std::string command, key, value;
  words >> command >> key;
  std::getline(words >> std::ws, value);
  if (command == "get_config_param") return sensor.config.dump() + "\n";
  if (command == "get_calibration_status") return "error: Command not recognized.\n";
  if (command.rfind("get_", 0) == 0) return sensor.section(command.substr(4)).dump() + "\n";
  sensor.log.push_back(request.substr(0, request.size() - 1));
  if (command == "set_config_param") {
    if (value == "3x3") return "error: invalid lidar mode\n";
    json parsed = json::parse(value, nullptr, false);
    sensor.staged[key] = parsed.is_discarded() ? json(value) : parsed;
  } else if (command == "reinitialize") {
    sensor.reinitialize();
  }
  return command + "\n";
}

OusterConfigOptions options_for(std::uint16_t http_port, std::uint16_t tcp_port) {
  OusterConfigOptions options;
  options.http.port = http_port;
  options.http.timeout = 2000ms;
  options.tcp.port = tcp_port;
  options.tcp.timeout = 2000ms;
  options.poll = 5ms;
  return options;
}

std::uint16_t unused_port() {
  return FakeTcp([](const std::string&) { return ""; }).port;
}

/// The sensor with the firmware of the parameter.
class Firmwares : public testing::TestWithParam<const char*> {
 protected:
  Firmwares() {
    const std::string way = GetParam();
    if (way == "TCP") {
      sensor.config.erase("udp_dest");
      sensor.config["udp_ip"] = "192.0.2.50";
      sensor.config.erase("operating_mode");
      sensor.config["auto_start_flag"] = 1;
      tcp = std::make_unique<FakeTcp>(
          [this](const std::string& request) { return tcp_answer(sensor, request); });
    } else {
      http = std::make_unique<FakeOusterHttp>(sensor, way == "HTTP commands");
    }
    options = options_for(http ? http->port : unused_port(), tcp ? tcp->port : unused_port());
  }

  OusterConfig connected() {
    auto config = OusterConfig::connect("127.0.0.1", options);
    if (!config) throw std::runtime_error(config.error().text());
    return std::move(*config);
  }

  FakeOuster sensor;
  std::unique_ptr<FakeOusterHttp> http;
  std::unique_ptr<FakeTcp> tcp;
  OusterConfigOptions options;
};

TEST_P(Firmwares, AreToldApartAndGiveMetadataThatDecodes) {
  const OusterConfig config = connected();
  EXPECT_EQ(config.api(), GetParam());
  const auto metadata = config.read_metadata();
  ASSERT_TRUE(metadata) << metadata.error().text();
  const auto parsed = parse_ouster_metadata(*metadata, "sensor");
  ASSERT_TRUE(parsed) << parsed.error().text();
  EXPECT_EQ(parsed->pixels_per_column, 32);
  EXPECT_EQ(parsed->prod_line, "OS-1-32");
  EXPECT_EQ(*config.status(), "RUNNING");
  EXPECT_TRUE(sensor.log.empty()) << "reading changes nothing";
}

TEST_P(Firmwares, SayWhatWouldChangeAndChangeNothing) {
  const OusterConfig config = connected();
  const auto changes = config.plan({{"udp_dest", "@auto"},
                                    {"lidar_mode", "512x20"},
                                    {"udp_port_lidar", "7502"},
                                    {"azimuth_window", "[0,360000]"},
                                    {"operating_mode", "NORMAL"}});
  ASSERT_TRUE(changes) << changes.error().text();
  ASSERT_EQ(changes->size(), 2u);
  EXPECT_EQ((*changes)[0].key, std::string(GetParam()) == "TCP" ? "udp_ip" : "udp_dest");
  EXPECT_EQ((*changes)[0].from, "192.0.2.50");
  EXPECT_EQ((*changes)[0].to, "127.0.0.1") << "this host as the sensor sees it";
  EXPECT_EQ((*changes)[1].from, "1024x10");
  EXPECT_EQ((*changes)[1].to, "512x20");
  EXPECT_TRUE(sensor.log.empty());
  const auto unknown = config.plan({{"lidar_mod", "512x20"}, {"colour", "red"}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::config);
  EXPECT_EQ(unknown.error().problems.size(), 2u);
}

TEST_P(Firmwares, AreChangedOnceAndThenLeftAlone) {
  const OusterConfig config = connected();
  const std::vector<Setting> wanted{{"lidar_mode", "512x20"}, {"udp_port_lidar", "7602"}};
  const auto changes = config.plan(wanted);
  ASSERT_TRUE(changes);
  const auto applied = config.apply(*changes, true);
  ASSERT_TRUE(applied) << applied.error().text();
  const auto running = config.wait_until_running(5000ms);
  ASSERT_TRUE(running) << running.error().text();
  EXPECT_EQ(sensor.config["lidar_mode"], "512x20");
  EXPECT_EQ(sensor.config["udp_port_lidar"], 7602) << "a number stays a number";
  EXPECT_EQ(sensor.config["udp_port_imu"], 7503);
  EXPECT_FALSE(sensor.log.empty());
  const std::size_t commands = sensor.log.size();
  EXPECT_TRUE(config.plan(wanted)->empty());
  EXPECT_TRUE(config.apply({}, true));
  EXPECT_EQ(sensor.log.size(), commands) << "equal settings cost no restart";
}

TEST_P(Firmwares, PassTheSensorsRefusalOn) {
  const OusterConfig config = connected();
  const auto applied = config.apply({{"lidar_mode", "1024x10", "3x3"}}, false);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().code, ErrorCode::config);
  EXPECT_NE(applied.error().text().find("invalid"), std::string::npos) << applied.error().text();
  EXPECT_EQ(sensor.config["lidar_mode"], "1024x10");
}

INSTANTIATE_TEST_SUITE_P(All, Firmwares, testing::Values("HTTP config", "HTTP commands", "TCP"),
                         [](const auto& chosen) {
                           std::string name = chosen.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

TEST(OusterConfig, PersistsOnlyWhenAsked) {
  FakeOuster sensor;
  const FakeOusterHttp http(sensor, false);
  const auto config = OusterConfig::connect("127.0.0.1", options_for(http.port, unused_port()));
  ASSERT_TRUE(config);
  ASSERT_TRUE(config->apply({{"lidar_mode", "1024x10", "512x10"}}, false));
  EXPECT_EQ(sensor.log.at(0), "POST {\"lidar_mode\":\"512x10\"} reinit=false persist=false");
  EXPECT_EQ(sensor.log.at(1), "POST {} reinit=true persist=false");
  ASSERT_TRUE(config->apply({{"lidar_mode", "512x10", "1024x10"}}, true));
  EXPECT_EQ(sensor.log.at(3), "POST {} reinit=true persist=true");
}

TEST(OusterConfig, RefusesHostsThatAreNoOuster) {
  const auto code_of = [](const std::string& body, int status) {
    FakeHttp http;
    http.server.Get(".*", [&](const httplib::Request&, httplib::Response& out) {
      out.status = status;
      out.set_content(body, "text/plain");
    });
    http.start();
    const auto config = OusterConfig::connect("127.0.0.1", options_for(http.port, unused_port()));
    return config ? 0 : static_cast<int>(config.error().code);
  };
  EXPECT_EQ(code_of("<html>router</html>", 200), static_cast<int>(ErrorCode::data));
  EXPECT_EQ(code_of("{", 200), static_cast<int>(ErrorCode::data));
  EXPECT_EQ(code_of("[]", 200), static_cast<int>(ErrorCode::data));
  EXPECT_EQ(code_of("{}", 404), static_cast<int>(ErrorCode::data));
  const std::string brackets = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_EQ(code_of("{\"udp_dest\": " + brackets + "}", 200), static_cast<int>(ErrorCode::data));
  const auto nobody = OusterConfig::connect("127.0.0.1", options_for(unused_port(), unused_port()));
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().code, ErrorCode::unavailable);
  EXPECT_EQ(nobody.error().problems.size(), 2u) << "both ways are named";
}

TEST(OusterConfig, GivesUpOnASensorThatDoesNotComeBack) {
  FakeOuster sensor;
  sensor.warming_up = 1'000'000;
  const FakeOusterHttp http(sensor, false);
  const auto config = OusterConfig::connect("127.0.0.1", options_for(http.port, unused_port()));
  ASSERT_TRUE(config);
  const auto running = config->wait_until_running(100ms);
  ASSERT_FALSE(running);
  EXPECT_NE(running.error().text().find("WARMUP"), std::string::npos) << running.error().text();
}

}  // namespace
}  // namespace ca2
