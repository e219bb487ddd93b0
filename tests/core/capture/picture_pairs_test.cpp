#include "core/capture/picture_pairs.h"

#include <gtest/gtest.h>

namespace ca2 {
namespace {

std::vector<CameraObservation> at(std::initializer_list<int> milliseconds) {
  std::vector<CameraObservation> list;
  for (const int time : milliseconds) list.emplace_back().time = 1'000'000LL * time;
  return list;
}

std::vector<const CameraObservation*> pointers(const std::vector<CameraObservation>& list) {
  std::vector<const CameraObservation*> all;
  for (const CameraObservation& one : list) all.push_back(&one);
  return all;
}

TEST(PicturePairs, OfATriggerLoseWhatTheOtherLost) {
  const auto left = at({0, 66, 133, 200}), right = at({1, 67, 201});
  std::vector<std::vector<const CameraObservation*>> cameras{
      pointers(left), pointers(right), pointers({})};  // the third does not see the board
  keep_pairs(cameras);
  ASSERT_EQ(cameras[0].size(), 3u);
  EXPECT_EQ(cameras[0][2]->time, 200'000'000);
  EXPECT_EQ(cameras[1].size(), 3u);
  EXPECT_TRUE(cameras[2].empty());
}

TEST(PicturePairs, OfFreeCamerasStay) {
  const auto left = at({0, 66, 133, 200}), right = at({20, 86, 153, 199});
  std::vector<std::vector<const CameraObservation*>> cameras{pointers(left), pointers(right)};
  keep_pairs(cameras);
  EXPECT_EQ(cameras[0].size(), 4u);
  EXPECT_EQ(cameras[1].size(), 4u);
}

TEST(PicturePairs, OfOneCameraStay) {
  const auto left = at({0, 66});
  std::vector<std::vector<const CameraObservation*>> cameras{pointers(left)};
  keep_pairs(cameras);
  EXPECT_EQ(cameras[0].size(), 2u);
}

}  // namespace
}  // namespace ca2
