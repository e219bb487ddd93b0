/// @file Sessions made of folders of pictures and clouds, in every format, and calibrated.

#include "core/io/files.h"
#include "core/io/jpeg.h"
#include "core/session/calibration.h"
#include "core/session/session.h"
#include "core/types/text.h"
#include "tests/tools/ca2/small_session.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

using namespace ca2::test;
namespace fs = std::filesystem;

void append(std::string& out, float value) {
  out.append(reinterpret_cast<const char*>(&value), 4);
}

std::string ply(const Scan& scan, bool binary) {
  std::string out =
      std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") +
      " 1.0\ncomment made by a test\nelement vertex " + std::to_string(scan.size()) +
      "\nproperty uchar tag\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    if (binary) {
      out += '\7';
      for (const float v : {p.x(), p.y(), p.z(), scan.intensity[i]}) append(out, v);
    } else {
      out += formatted("7 %.9g %.9g %.9g %.9g\n", double(p.x()), double(p.y()), double(p.z()),
                       double(scan.intensity[i]));
    }
  }
  return out;
}

std::string csv(const Scan& scan, bool header) {
  std::string out = header ? "ring;intensity;x;y;z\n" : "";
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f& p = scan.points[i];
    const auto values = {double(p.x()), double(p.y()), double(p.z()), double(scan.intensity[i])};
    const double* v = values.begin();
    out += header ? formatted("%d;%.9g;%.9g;%.9g;%.9g\n", int(scan.ring[i]), v[3], v[0], v[1], v[2])
                  : formatted("%.9g, %.9g,%.9g,%.9g\r\n", v[0], v[1], v[2], v[3]);
  }
  return out;
}

std::string npy(const Scan& scan) {
  std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(scan.size()) + ", 4), }";
  header.resize(117, ' ');
  header += '\n';
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(header.size());
  out += '\0';
  out += header;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    for (int k = 0; k < 3; ++k) append(out, scan.points[i](k));
    append(out, scan.intensity[i]);
  }
  return out;
}

class ImportCommand : public SmallSession {
 protected:
  Outcome run(const std::vector<std::string>& options = {}) const {
    std::vector<std::string> words{"import",   folder / "data", "--rig", session / "session.yaml",
                                   "--output", folder / "made"};
    words.insert(words.end(), options.begin(), options.end());
    return run_ca2(words);
  }
};

TEST_F(ImportCommand, EveryFormatGivesTheSamePointsAndTheTrueAnswer) {
  fs::create_directories(folder / "data/images");
  fs::create_directories(folder / "data/scans");
  for (int view = 1; view <= view_count; ++view) {
    const auto image = read_png(picture(view));
    const auto scan = read_pcd(cloud(view));
    ASSERT_TRUE(image && scan);
    const std::string n = std::to_string(view);
    if (view % 2) {
      fs::copy_file(picture(view), folder / ("data/images/pose" + n + ".png"));
    } else {
      write_bytes(folder / ("data/images/pose" + n + ".jpg"), *encode_jpeg(*image, 98));
    }
    const fs::path base = folder / ("data/scans/scan_000" + n);
    const auto put = [&](const char* ending, const std::string& content) {
      write_bytes(base.string() + ending, content);
    };
    switch (view % 6) {
      case 0:
        put(".ply", ply(*scan, false));
        break;
      case 1:
        put(".ply", ply(*scan, true));
        break;
      case 2:
        put(".csv", csv(*scan, true));
        break;
      case 3:
        put(".csv", csv(*scan, false));
        break;
      case 4:
        put(".npy", npy(*scan));
        break;
      default:
        fs::copy_file(cloud(view), base.string() + ".pcd");
    }
  }
  write_bytes(folder / "data/imu.csv", "time,x,y,z\n");
  const Outcome imported = run();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_EQ(imported.errors, "");
  EXPECT_NE(imported.output.find("8 views paired by number"), std::string::npos) << imported.output;
  for (int view = 1; view <= view_count; ++view) {
    const auto was = read_pcd(cloud(view)),
               is = read_pcd(folder / "made/views" / ("00000" + std::to_string(view)) / "puck.pcd");
    ASSERT_TRUE(was && is);
    ASSERT_EQ(was->size(), is->size());
    for (std::size_t i = 0; i < was->size(); ++i) ASSERT_EQ(was->points[i], is->points[i]) << view;
    EXPECT_EQ(was->intensity, is->intensity);
  }
  const Outcome solved = run_ca2({"solve", folder / "made"});
  ASSERT_EQ(solved.status, 0) << solved.errors;
  const auto answer = read_calibration(folder / "made/result.yaml");
  const auto truth = read_true_transforms(session / "truth.yaml");
  ASSERT_TRUE(answer && truth);
  const Vector6d error = answer->transforms[0].T_parent_child.difference((*truth)[0].T_parent_child);
  EXPECT_LT(error.tail<3>().norm(), 0.010);
  EXPECT_LT(error.head<3>().norm(), 0.004);
}

/// As Kalibr and EuRoC have it: a folder per sensor, names are nanoseconds; the sensors run on their own.
TEST_F(ImportCommand, TimesArePairedToTheNearest) {
  fs::create_directories(folder / "data/front/data");
  fs::create_directories(folder / "data/puck");
  const std::int64_t start = 1403636579763555584;
  for (int view = 1; view <= 4; ++view) {
    const std::int64_t t = start + view * 100'000'000;
    fs::copy_file(cloud(view), folder / ("data/puck/" + std::to_string(t) + ".pcd"));
    for (const std::int64_t off : {-40'000'000, 3'000'000, 50'000'000}) {
      fs::copy_file(picture(off == 3'000'000 ? view : 8),
                    folder / ("data/front/data/" + std::to_string(t + off) + ".png"));
    }
  }
  fs::copy_file(cloud(5), folder / ("data/puck/" + std::to_string(start + 10'000'000'000) + ".pcd"));
  const Outcome imported = run();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_NE(imported.output.find("4 views paired by time, 1 file without a partner"), std::string::npos)
      << imported.output;
  for (int view = 1; view <= 4; ++view) {
    const auto was = read_png(picture(view)),
               is = read_png(folder / "made/views" / ("00000" + std::to_string(view)) / "front.png");
    ASSERT_TRUE(was && is);
    EXPECT_EQ(was->bytes, is->bytes) << "the picture 3 ms away";
  }
  fs::remove_all(folder / "made");
  EXPECT_NE(run({"--every", "2"}).output.find("2 views"), std::string::npos);
}

/// Of fourteen digits, as milliseconds are; a second later is not a millisecond later.
TEST_F(ImportCommand, DatesArePairedWhereTheyAreEqual) {
  fs::create_directories(folder / "data");
  const std::string minute = "data/202401151234";
  for (const char* second : {"56", "57", "59"})
    fs::copy_file(picture(1), folder / (minute + second + ".png"));
  for (const char* second : {"56", "58"}) fs::copy_file(cloud(1), folder / (minute + second + ".pcd"));
  const Outcome imported = run();
  ASSERT_EQ(imported.status, 0) << imported.errors;
  EXPECT_NE(imported.output.find("1 view paired by number"), std::string::npos) << imported.output;
}

TEST_F(ImportCommand, MistakesAndDamageSayWhere) {
  EXPECT_EQ(run().status, 74) << "no folder";
  fs::create_directories(folder / "data");
  EXPECT_EQ(run().status, 65);
  fs::copy_file(picture(1), folder / "data/a1.png");
  fs::copy_file(cloud(1), folder / "data/b2.pcd");
  EXPECT_NE(run().errors.find("same number"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "made"));
  const std::string bad[] = {"ply\n",
                             "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty "
                             "float y\nproperty float z\nend_header\n1 2 3\n",
                             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n", "",
                             "no ply"};
  fs::copy_file(cloud(3), folder / "data/b1.pcd");
  for (const std::string& text : bad) {
    write_bytes(folder / "data/c2.ply", text);
    fs::copy_file(picture(2), folder / "data/a2.png", fs::copy_options::overwrite_existing);
    fs::remove(folder / "data/b2.pcd");
    fs::remove_all(folder / "made");
    const Outcome outcome = run();
    EXPECT_EQ(outcome.status, 0) << outcome.errors;
    EXPECT_NE(outcome.errors.find("c2.ply"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.output.find("1 view"), std::string::npos) << outcome.output;
  }
  EXPECT_EQ(run().status, 73) << "there is a session already";
  for (const auto& [name, text] : {std::pair<std::string, std::string>("c2.csv", "1,2,3\n1,2\n"),
                                   {"c2.csv", "a,b,c\n"},
                                   {"c2.csv", "1,2,x\n"},
                                   {"c2.npy", "\x93NUMPY"},
                                   {"c2.npy", std::string("\x93NUMPY\x01\0\xff\xff{'descr'", 18)}}) {
    fs::remove(folder / "data/c2.ply");
    fs::remove(folder / "data/c2.csv");
    write_bytes(folder / ("data/" + name), text);
    fs::remove_all(folder / "made");
    EXPECT_NE(run().errors.find(name), std::string::npos);
  }
}

}  // namespace
}  // namespace ca2
