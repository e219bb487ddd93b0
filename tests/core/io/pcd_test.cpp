#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

#include "core/io/files.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

Scan random_scan(std::size_t size, bool everything) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> metres(-50, 50);
  Scan scan;
  for (std::size_t i = 0; i < size; ++i) {
    scan.points.emplace_back(metres(random), metres(random), metres(random));
    if (!everything) continue;
    scan.intensity.push_back(metres(random));
    scan.range.push_back(metres(random));
    scan.ring.push_back(static_cast<std::uint16_t>(random() % 16));
    scan.column.push_back(static_cast<std::uint32_t>(random() % 1024));
    scan.time.push_back(static_cast<std::int64_t>(1'700'000'000'123'456'789 + i));
  }
  if (everything) {
    scan.rings = 32;
    scan.columns = 2048;
  }
  return scan;
}

std::string ascii(const std::string& fields, const std::string& sizes, const std::string& types,
                  const std::string& points, const std::string& rows, const std::string& width = {},
                  const std::string& height = "1") {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types + "\nWIDTH " +
         (width.empty() ? points : width) + "\nHEIGHT " + height + "\nPOINTS " + points + "\nDATA ascii\n" +
         rows;
}

TEST(Pcd, RoundTripsBitForBit) {
  const test::TemporaryDirectory directory;
  for (const bool everything : {false, true}) {
    Scan scan = random_scan(1000, everything);
    scan.points[3].setConstant(std::numeric_limits<float>::quiet_NaN());
    ASSERT_TRUE(write_pcd(directory / "a.pcd", scan));
    const auto read = read_pcd(directory / "a.pcd");
    ASSERT_TRUE(read) << read.error().text();
    ASSERT_EQ(read->size(), scan.size());
    EXPECT_EQ(std::memcmp(read->points.data(), scan.points.data(), 12 * scan.size()), 0);
    EXPECT_EQ(read->intensity, scan.intensity);
    EXPECT_EQ(read->range, scan.range);
    EXPECT_EQ(read->ring, scan.ring);
    EXPECT_EQ(read->column, scan.column);
    EXPECT_EQ(read->time, scan.time);
    EXPECT_EQ(read->rings, scan.rings);
    EXPECT_EQ(read->columns, scan.columns);
  }
}

TEST(Pcd, SeveralScansAreOneCloudOfTheArraysThatAllHave) {
  const Scan first = random_scan(40000, true), second = random_scan(3, true), empty;
  Scan bare = second;
  bare.time.clear();
  const auto written = [](std::vector<const Scan*> scans) {
    std::string content;
    EXPECT_TRUE(encode_pcd(scans, [&](std::string_view piece) { return content += piece, true; }));
    return parse_pcd(content, "a.pcd").value();
  };
  const Scan both = written({&first, &empty, &second});
  ASSERT_EQ(both.size(), 40003u);
  EXPECT_EQ(both.points[39999], first.points[39999]);
  EXPECT_EQ(both.points[40002], second.points[2]);
  EXPECT_EQ(both.time[40001], second.time[1]);
  EXPECT_EQ(both.range[40000], second.range[0]);
  EXPECT_EQ(both.columns, first.columns);
  for (const Scan& without : {written({&bare, &first}), written({&first, &bare})}) {
    ASSERT_EQ(without.size(), 40003u);
    EXPECT_TRUE(without.time.empty());
    EXPECT_EQ(without.range.size(), 40003u);
  }
  bare.range.pop_back();
  EXPECT_FALSE(encode_pcd(std::vector<const Scan*>{&first, &bare}, [](std::string_view) { return true; }));
}

TEST(Pcd, AnEmptyCloudIsACloud) {
  const auto read = parse_pcd(encode_pcd(Scan{}).value(), "a.pcd");
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_TRUE(read->empty());
}

TEST(Pcd, ReadsAnyOrderTypesNanAndSpacing) {
  const auto scan = parse_pcd(ascii("ring t z normal y x intensity", "1 4 4 4 8 4 2", "U U F F F F I", "3",
                                    "3 100 0.5 9 -1e1 +2 -7\r\n"
                                    "\n 15\t4000000000 nan 9  nan NaN 1 \n"
                                    "0 0 -nan(ind) 9 1 2 3"),
                              "a.pcd");
  ASSERT_TRUE(scan) << scan.error().text();
  ASSERT_EQ(scan->size(), 3u);
  EXPECT_EQ(scan->points[0], Eigen::Vector3f(2, -10, 0.5f));
  EXPECT_TRUE(scan->points[1].array().isNaN().all());
  EXPECT_TRUE(scan->points[2].array().isNaN().all());
  EXPECT_EQ(scan->ring, (std::vector<std::uint16_t>{3, 15, 0}));
  EXPECT_EQ(scan->rings, 16);
  EXPECT_EQ(scan->time, (std::vector<std::int64_t>{100, 4000000000, 0}));
  EXPECT_EQ(scan->intensity[0], -7);
  EXPECT_TRUE(scan->column.empty());
}

TEST(Pcd, SkipsFieldsOfManyValues) {
  const std::string text =
      "VERSION .6\nFIELDS x histogram y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 3 1 1\nWIDTH 1\nHEIGHT 1\n"
      "DATA ascii\n1 90 91 nonsense 2 3\n";
  const auto scan = parse_pcd(text, "a.pcd");
  ASSERT_TRUE(scan) << scan.error().text();
  EXPECT_EQ(scan->points[0], Eigen::Vector3f(1, 2, 3));
}

TEST(Pcd, SecondsBecomeNanoseconds) {
  const auto scan = parse_pcd(
      ascii("x y z timestamp", "4 4 4 8", "F F F F", "2", "1 2 3 1700000000.25\n1 2 3 -0.5\n"), "a");
  ASSERT_TRUE(scan) << scan.error().text();
  EXPECT_EQ(scan->time, (std::vector<std::int64_t>{1'700'000'000'250'000'000, -500'000'000}));
  const auto offset = parse_pcd(ascii("x y z time", "4 4 4 4", "F F F F", "1", "1 2 3 0.0123\n"), "a");
  EXPECT_EQ(offset->time[0], 12'300'000);
}

TEST(Pcd, AnOrganisedCloudIsARangeImage) {
  const std::string rows = "1 0 0\n2 0 0\n3 0 0\n4 0 0\nnan nan nan\n6 0 0\n";
  const auto scan = parse_pcd(ascii("x y z", "4 4 4", "F F F", "6", rows, "3", "2"), "a");
  ASSERT_TRUE(scan) << scan.error().text();
  EXPECT_EQ(scan->rings, 2);
  EXPECT_EQ(scan->columns, 3);
  EXPECT_EQ(scan->ring, (std::vector<std::uint16_t>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(scan->column, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2}));
  // A tall one is some other grid: its rows are not rings.
  EXPECT_TRUE(parse_pcd(ascii("x y z", "4 4 4", "F F F", "6", rows, "2", "3"), "a")->ring.empty());
}

TEST(Pcd, BinaryTruncatedAnywhereIsAnError) {
  const std::string whole = encode_pcd(random_scan(20, true)).value();
  ASSERT_TRUE(parse_pcd(whole, "a.pcd"));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto cut = parse_pcd(whole.substr(0, size), "a.pcd");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(cut.error().code, ErrorCode::data);
    EXPECT_EQ(cut.error().problems[0].where.substr(0, 5), "a.pcd");
  }
  EXPECT_TRUE(parse_pcd(whole + "\n", "a.pcd"));
  EXPECT_FALSE(parse_pcd(whole + std::string(100, '\0'), "a.pcd"));
}

TEST(Pcd, AsciiTruncatedSaysWhatIsMissing) {
  const std::string whole = ascii("x y z", "4 4 4", "F F F", "3", "1 2 3\n4 5 6\n7 8 9\n");
  const std::size_t last = whole.size() - 2;  // the last digit: before it, something is missing
  for (std::size_t size = 0; size < last; ++size) {
    const auto cut = parse_pcd(whole.substr(0, size), "a.pcd");
    ASSERT_FALSE(cut) << size;
    EXPECT_FALSE(cut.error().problems[0].where.empty());
  }
  const auto two = parse_pcd(whole.substr(0, whole.size() - 6), "a.pcd");
  EXPECT_NE(two.error().text().find("promises 3 points, 2 are there"), std::string::npos)
      << two.error().text();
}

struct Bad {
  const char* name;
  std::string text;
  const char* expected;
};

TEST(Pcd, BadFilesAreNamedWithTheLine) {
  const std::string f3 = "4 4 4", t3 = "F F F", row = "1 2 3\n";
  const Bad bad[] = {
      {"points", ascii("x y z", f3, t3, "2", row, "1"), "a.pcd:8: POINTS is 2, WIDTH x HEIGHT is 1"},
      {"huge", ascii("x y z", f3, t3, "99999999999", row), "promises 99999999999 points, 1 are there"},
      {"overflow", ascii("x y z", f3, t3, "1", row, "4611686018427387905", "4"), "a.pcd:6: WIDTH and HEIGHT"},
      {"negative", ascii("x y z", f3, t3, "-1", row), "a.pcd:6: WIDTH must be one whole number"},
      {"word", ascii("x y z", f3, t3, "1", "1 two 3\n"), "a.pcd:10: value 2 is not a number"},
      {"few", ascii("x y z", f3, t3, "1", "1 2\n"), "a.pcd:10: the point has 2 values"},
      {"many", ascii("x y z", f3, t3, "1", row + row), "a.pcd:11: there are more points"},
      {"axis", ascii("x y w", f3, t3, "1", row), "no field z"},
      {"size", ascii("x y z", "4 4 3", t3, "1", row), "field 'z' has type 'F' and size '3'"},
      {"entries", ascii("x y z", "4 4", t3, "1", row), "a.pcd:4: SIZE has 2 entries, FIELDS has 3"},
      {"ring", ascii("x y z ring", "4 4 4 4", "F F F I", "1", "1 2 3 -1\n"), "a.pcd:10: the ring is not"},
      {"compressed", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA binary_compressed\n",
       "a.pcd:6: compressed PCD files are not read; convert"},
      {"other", "\x89PNG\r\n", "is not a PCD header entry; is this a PCD file?"},
      {"grid", ascii("x y z ring column", "4 4 4 2 4", "F F F U U", "1", "1 2 3 4095 1048575\n"),
       "span a grid"},
  };
  for (const Bad& one : bad) {
    const auto read = parse_pcd(one.text, "a.pcd");
    ASSERT_FALSE(read) << one.name;
    EXPECT_EQ(read.error().code, ErrorCode::data);
    EXPECT_NE(read.error().text().find(one.expected), std::string::npos)
        << one.name << ": " << read.error().text();
  }
}

TEST(Pcd, AllHeaderProblemsAreReported) {
  const auto read = parse_pcd("VERSION 9\nFIELDS x\nTYPE F\nWIDTH a\nDATA text\n", "a.pcd");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().problems.size(), 5u) << read.error().text();
}

TEST(Pcd, ReadsTheCloudsOfOthers) {
  const char* data = std::getenv("CA2_TEST_DATA");
  if (!data) GTEST_SKIP() << "CA2_TEST_DATA is not set: no recordings of others here";
  const auto scan = read_pcd(std::filesystem::path(data) / "acfr_vlp16/pcd/pose1.pcd");
  ASSERT_TRUE(scan) << scan.error().text();
  EXPECT_EQ(scan->size(), 23969u);
  EXPECT_EQ(scan->rings, 16);
  EXPECT_FLOAT_EQ(scan->points[0].x(), 1.373171f);
  EXPECT_FLOAT_EQ(scan->points[1].z(), 0.057592869f);
}

}  // namespace
}  // namespace ca2
