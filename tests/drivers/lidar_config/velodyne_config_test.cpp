#include "drivers/lidar_config/velodyne_config.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/drivers/lidar_config/fake_servers.h"

namespace ca2 {
namespace {

using namespace ca2::test;
using nlohmann::json;

class VelodyneConfigTest : public testing::Test {
 protected:
  VelodyneConfigTest() {
    fake.server.Get("/cgi/snapshot.hdl", [this](const httplib::Request&, httplib::Response& out) {
      out.set_content(json{{"config", config}, {"status", json::object()}}.dump(), "application/json");
    });
    fake.server.Get("/cgi/info.json", [](const httplib::Request&, httplib::Response& out) {
      out.set_content(R"({"model": "VLP-16", "serial": "11001202411637"})", "application/json");
    });
    fake.server.Post("/cgi/.*", [this](const httplib::Request& in, httplib::Response& out) {
      posts.push_back(in.path + " " + in.body);
      if (in.body == "rpm=7") out.status = 400;
      if (in.body == "rpm=1200") config["rpm"] = 1200;
    });
    fake.start();
  }

  VelodyneConfig client() const {
    HttpOptions options;
    options.port = fake.port;
    return VelodyneConfig("127.0.0.1", options);
  }

  json config = {{"rpm", 600},
                 {"returns", "Strongest"},
                 {"laser", "On"},
                 {"fov", {{"start", 0}, {"end", 359}}},
                 {"host", {{"addr", "255.255.255.255"}, {"dport", 2368}, {"tport", 8308}}}};
  std::vector<std::string> posts;
  FakeHttp fake;
};

TEST_F(VelodyneConfigTest, ReadsItsPages) {
  EXPECT_EQ(json::parse(*client().read_snapshot())["config"]["rpm"], 600);
  EXPECT_EQ(json::parse(*client().read_info())["model"], "VLP-16");
  EXPECT_TRUE(posts.empty());
}

TEST_F(VelodyneConfigTest, PlansOnlyWhatDiffers) {
  const auto changes = client().plan({{"rpm", "1200"},
                                      {"returns", "strongest"},
                                      {"laser", "on"},
                                      {"host.addr", "192.0.2.1"},
                                      {"host.dport", "2368"},
                                      {"phaselock.offset", "90"}});
  ASSERT_TRUE(changes) << changes.error().text();
  ASSERT_EQ(changes->size(), 3u);
  EXPECT_EQ((*changes)[0].key, "rpm");
  EXPECT_EQ((*changes)[0].from, "600");
  EXPECT_EQ((*changes)[1].key, "host.addr");
  EXPECT_EQ((*changes)[2].from, "") << "not in this firmware's snapshot";
  EXPECT_TRUE(posts.empty());
  const auto unknown = client().plan({{"net.addr", "192.0.2.2"}});
  ASSERT_FALSE(unknown) << "the sensor's own address is left alone";
  EXPECT_EQ(unknown.error().code, ErrorCode::config);
}

TEST_F(VelodyneConfigTest, PostsOneFormPerChange) {
  ASSERT_TRUE(client().apply(
      {{"rpm", "600", "1200"}, {"host.addr", "", "192.0.2.1"}, {"fov.end", "359", "90"}}, true));
  EXPECT_EQ(posts, (std::vector<std::string>{"/cgi/setting rpm=1200", "/cgi/setting/host addr=192.0.2.1",
                                             "/cgi/setting/fov end=90", "/cgi/save submit"}));
  EXPECT_TRUE(client().plan({{"rpm", "1200"}})->empty());
  ASSERT_TRUE(client().apply({}, true));
  EXPECT_EQ(posts.size(), 4u) << "nothing to do, nothing saved";
}

TEST_F(VelodyneConfigTest, StopsAtARefusal) {
  const auto applied = client().apply({{"rpm", "600", "7"}, {"laser", "On", "off"}}, true);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().code, ErrorCode::config);
  EXPECT_EQ(posts.size(), 1u);
}

TEST(VelodyneConfig, RefusesGarbage) {
  const std::string brackets = std::string(100'000, '[') + std::string(100'000, ']');
  for (const std::string& body :
       {std::string(), std::string("<html>"), std::string("[1]"), std::string("{\"config\": "),
        "{\"config\": {\"rpm\": " + brackets + "}}"}) {
    FakeHttp fake;
    fake.server.Get(
        ".*", [&](const httplib::Request&, httplib::Response& out) { out.set_content(body, "text/html"); });
    fake.start();
    HttpOptions options;
    options.port = fake.port;
    const auto plan = VelodyneConfig("127.0.0.1", options).plan({{"rpm", "600"}});
    ASSERT_FALSE(plan) << body;
    EXPECT_EQ(plan.error().code, ErrorCode::data);
  }
  FakeHttp odd;  // an object, but not of the kind expected
  odd.server.Get(".*", [&](const httplib::Request&, httplib::Response& out) {
    out.set_content(R"({"config": ["rpm"]})", "application/json");
  });
  odd.start();
  HttpOptions options;
  options.port = odd.port;
  const auto plan = VelodyneConfig("127.0.0.1", options).plan({{"fov.start", "0"}});
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->size(), 1u);
}

}  // namespace
}  // namespace ca2
