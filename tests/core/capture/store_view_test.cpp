#include "core/capture/store_view.h"

#include <gtest/gtest.h>

#include "core/capture/view_builder.h"
#include "core/io/files.h"
#include "core/session/session.h"
#include "tests/support/temporary_directory.h"

namespace ca2 {
namespace {

std::shared_ptr<const Scan> scan_of(int returns, bool complete) {
  Scan scan;
  for (int i = 0; i < returns; ++i) {
    scan.points.emplace_back(1.0f, static_cast<float>(i), 2.0f);
    scan.intensity.push_back(static_cast<float>(i));
    scan.range.push_back(3.0f);
    scan.ring.push_back(static_cast<std::uint16_t>(i));
    if (complete) scan.column.push_back(7);
    scan.time.push_back(i);
  }
  scan.rings = 16;
  scan.columns = 1024;
  return std::make_shared<const Scan>(std::move(scan));
}

/// Of `bits`, every sample another mixture of small and large values from picture to picture.
std::vector<CameraObservation> pictures_of(std::size_t count, int bits) {
  std::vector<CameraObservation> pictures(count);
  for (std::size_t p = 0; p < count; ++p) {
    Image image{101, 43, 3, bits, {}};  // samples that fill no whole number of blocks
    const std::size_t samples = 101 * 43 * 3;
    for (std::size_t i = 0; i < samples; ++i) {
      const auto value = static_cast<std::uint32_t>((i * 2654435761u + p * 40503u) >> (i % 5 == 0 ? 3 : 7));
      if (bits == 8) {
        image.bytes.push_back(i % 7 == 0 ? 255 : static_cast<std::uint8_t>(value));
      } else {
        const auto wide = i % 7 == 0 ? std::uint16_t{65535} : static_cast<std::uint16_t>(value);
        image.bytes.insert(image.bytes.end(),
                           {static_cast<std::uint8_t>(wide & 255), static_cast<std::uint8_t>(wide >> 8)});
      }
    }
    pictures[p].image = std::make_shared<const Image>(std::move(image));
  }
  return pictures;
}

TEST(MeanImage, IsTheRoundedMeanOfEverySample) {
  for (const auto& [count, bits] :
       {std::pair<std::size_t, int>(2, 8), {10, 8}, {257, 8}, {258, 8}, {10, 16}}) {
    const std::vector<CameraObservation> pictures = pictures_of(count, bits);
    std::vector<const CameraObservation*> pointers;
    for (const CameraObservation& picture : pictures) pointers.push_back(&picture);
    const Image mean = mean_image(pointers);
    ASSERT_EQ(mean.bits, 16);
    ASSERT_EQ(mean.bytes.size(), 2u * 101 * 43 * 3);
    for (std::size_t i = 0; i < 101 * 43 * 3; ++i) {
      std::uint64_t sum = 0;
      for (const CameraObservation& picture : pictures) {
        const auto& bytes = picture.image->bytes;
        sum += bits == 8 ? 257u * bytes[i] : bytes[2 * i] + 256u * bytes[2 * i + 1];
      }
      const auto wanted = (sum + count / 2) / count;
      ASSERT_EQ(mean.bytes[2 * i] + 256u * mean.bytes[2 * i + 1], wanted)
          << count << " of " << bits << " bits, " << i;
    }
  }
}

TEST(GatheredScan, HasAllReturnsOfAllArraysThatAllScansHave) {
  std::vector<std::shared_ptr<const Scan>> scans{scan_of(3, true), scan_of(0, true), scan_of(5, true)};
  const Scan all = gathered_scan(scans);
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all.points[7].y(), 4.0f);
  EXPECT_EQ(all.intensity.size(), 8u);
  EXPECT_EQ(all.column.size(), 8u);
  EXPECT_EQ(all.ring[3], 0);
  EXPECT_TRUE(all.range.empty() && all.time.empty()) << "no search asks for them";
  EXPECT_EQ(all.columns, 1024);
  scans[1] = scan_of(2, false);
  const Scan without = gathered_scan(scans);
  EXPECT_EQ(without.size(), 10u);
  EXPECT_TRUE(without.column.empty());
  EXPECT_EQ(without.ring.size(), 10u);
}

TEST(StoreView, LetsGoOfScansAndCanBeRepeated) {
  const test::TemporaryDirectory directory;
  Rig rig;
  rig.board.type = find_board_type("checkerboard");
  rig.board.columns = 8;
  rig.board.rows = 6;
  rig.board.square = 0.04;
  rig.board.outline = Outline{0.42, 0.297, {0, 0}};
  rig.cameras["left"] = {};
  rig.lidars["top"] = {};
  ASSERT_TRUE(create_session(directory / "session", rig, "2026-11-22T00:00:00Z"));
  Result<Session> session = open_session(directory / "session");
  ASSERT_TRUE(session) << session.error().text();

  StoreView view;
  view.id = 1;
  view.details = "version: 1\n";
  const Image image{64, 48, 1, 16, std::vector<std::uint8_t>(64 * 48 * 2, 77)};
  view.images["left"] = image;
  view.scans["top"] = {scan_of(30, true), scan_of(20, true)};
  const std::weak_ptr<const Scan> first = view.scans["top"].front();
  // A disk that is full, or here a view that is there already, does not take the returns away.
  std::filesystem::create_directories(directory / "session/views/000001/in_the_way");
  ASSERT_FALSE(store_view(*session, view));
  ASSERT_EQ(view.scans["top"].size(), 2u);
  EXPECT_FALSE(first.expired());
  EXPECT_EQ(view.images["left"].bytes, image.bytes);

  std::filesystem::remove_all(directory / "session/views/000001");
  std::vector<StoreStep> steps;
  static_cast<void>(store_view(*session, view, [&](StoreStep step) { steps.push_back(step); }));
  ASSERT_EQ(session->views.size(), 1u);
  using enum StoreStep;
  EXPECT_EQ(steps, (std::vector{saving, searching}));
  EXPECT_TRUE(view.images.empty()) << "it is on the disk";
  EXPECT_TRUE(view.scans.empty());
  EXPECT_TRUE(first.expired());
  const auto picture = read_png(directory / "session/views/000001/left.png");
  ASSERT_TRUE(picture) << picture.error().text();
  EXPECT_EQ(picture->bytes, image.bytes);
  const auto cloud = read_pcd(directory / "session/views/000001/top.pcd");
  ASSERT_TRUE(cloud) << cloud.error().text();
  EXPECT_EQ(cloud->size(), 50u);
  EXPECT_EQ(cloud->range.size(), 50u);
  EXPECT_EQ(cloud->time.size(), 50u);
}

}  // namespace
}  // namespace ca2
