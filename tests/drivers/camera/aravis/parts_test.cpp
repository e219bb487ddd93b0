/// The pure parts of cameras' timing and counting.
#include <arv.h>
#include <gtest/gtest.h>

#include "drivers/camera/aravis/camera_clock.h"
#include "drivers/camera/frame_count.h"
#include "drivers/camera/frame_watch.h"
#include "drivers/camera/pixel_formats/pixel_format.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds;

TEST(FrameCount, GapsAndWrapAround) {
  FrameCount count;
  EXPECT_EQ(count.missing_before(65530), 0u);
  EXPECT_EQ(count.missing_before(65531), 0u);
  EXPECT_EQ(count.missing_before(65534), 2u);
  EXPECT_EQ(count.missing_before(65535), 0u);
  EXPECT_EQ(count.missing_before(1), 0u);
  EXPECT_EQ(count.missing_before(3), 1u);
  // From 65535 to 1 with one lost on either side.
  FrameCount lossy;
  lossy.missing_before(65534);
  EXPECT_EQ(lossy.missing_before(2), 2u);
  // 64 bits; and a camera that begins anew.
  FrameCount wide;
  wide.missing_before(70'000);
  EXPECT_EQ(wide.missing_before(70'002), 1u);
  EXPECT_EQ(wide.missing_before(1), 0u);
  FrameCount anew;
  anew.missing_before(30'000);
  EXPECT_EQ(anew.missing_before(1), 0u);
  EXPECT_EQ(anew.missing_before(65'434), 0u) << "nobody loses hours of pictures between two";
}

TEST(FrameWatch, ThreePeriodsAfterTheLastSign) {
  FrameWatch watch;
  const FrameWatch::Time start{std::chrono::hours(1)};
  watch.begin(start, milliseconds(100), milliseconds(2000));
  EXPECT_EQ(*watch.deadline(), start + milliseconds(2300));
  auto now = start + milliseconds(500);
  watch.sign_of_life(now);
  EXPECT_EQ(*watch.deadline(), now + milliseconds(300));
  // What is promised is not kept: the interval that was seen counts.
  now += milliseconds(250);
  watch.sign_of_life(now);
  EXPECT_EQ(*watch.deadline(), now + milliseconds(750));
  for (int i = 0; i < 4; ++i) watch.sign_of_life(now += milliseconds(100));
  EXPECT_EQ(*watch.deadline(), now + milliseconds(300));
  watch.heard(now + milliseconds(50));
  EXPECT_EQ(*watch.deadline(), now + milliseconds(350));
  // Who was away looks for a period before it judges; what the host overslept is added.
  watch.leave(now + milliseconds(20));
  watch.look(now + milliseconds(30));
  EXPECT_EQ(*watch.deadline(), now + milliseconds(350));
  watch.look(now + milliseconds(5000));
  EXPECT_EQ(*watch.deadline(), now + milliseconds(5100));
  watch.overslept(milliseconds(40));
  EXPECT_EQ(*watch.deadline(), now + milliseconds(5140));
  watch.begin(now, milliseconds(0), milliseconds(2000));
  EXPECT_FALSE(watch.deadline());
}

/// A camera whose clock began at 0 and runs 50 ppm fast, 10 ms of exposure, packets delayed by 0.2 ms or
/// more.
TEST(CameraClock, MiddleOfTheExposureFromArrivals) {
  CameraClock clock;
  constexpr std::int64_t start = 1'700'000'000'000'000'000, exposure = 10'000'000, delay = 200'000;
  CameraClock::MidExposure middle;
  std::int64_t truth = 0;
  for (std::int64_t i = 0; i < 400; ++i) {
    const std::int64_t taken = i * 50'000'000;  // ns, start of the exposure
    truth = start + taken + exposure / 2;
    const std::int64_t jitter = (i * i * 7919) % 3'000'000;
    middle =
        clock.middle({taken + taken / 20'000, start + taken + exposure + delay + jitter, exposure, false});
  }
  EXPECT_NEAR(static_cast<double>(middle.time - truth), delay, 100'000);
  EXPECT_LT(std::abs(middle.time - truth), 3 * middle.sigma);
}

TEST(CameraClock, PtpIsBelievedWhereItTellsUtcOrTai) {
  constexpr std::int64_t utc = 1'700'000'000'000'000'000, exposure = 4'000'000;
  for (const std::int64_t ahead : {std::int64_t{0}, CameraClock::tai_minus_utc}) {
    CameraClock clock;
    const auto middle = clock.middle({utc + ahead, utc + exposure + 700'000, exposure, true});
    EXPECT_EQ(middle.time, utc + exposure / 2);
    EXPECT_EQ(middle.sigma, CameraClock::ptp_sigma);
  }
  // A master with a time of its own: the arrivals count.
  CameraClock clock;
  const auto middle = clock.middle({utc - 86'400'000'000'000, utc + exposure + 700'000, exposure, true});
  EXPECT_EQ(middle.time, utc + exposure / 2 + 700'000);
}

TEST(PixelFormats, CodesAreAraviss) {
  EXPECT_EQ(find_pixel_format("Mono10Packed")->pfnc, ARV_PIXEL_FORMAT_MONO_10_PACKED);
  EXPECT_EQ(find_pixel_format("Mono12Packed")->pfnc, ARV_PIXEL_FORMAT_MONO_12_PACKED);
  EXPECT_EQ(find_pixel_format("BayerGR16")->pfnc, ARV_PIXEL_FORMAT_BAYER_GR_16);
  EXPECT_EQ(find_pixel_format("BayerBG12p")->pfnc, ARV_PIXEL_FORMAT_BAYER_BG_12P);
  EXPECT_EQ(find_pixel_format("BayerGB10p")->pfnc, ARV_PIXEL_FORMAT_BAYER_GB_10P);
  EXPECT_EQ(find_pixel_format("BayerRG10Packed")->pfnc, ARV_PIXEL_FORMAT_BAYER_RG_10_PACKED);
  EXPECT_EQ(find_pixel_format("RGB8")->pfnc, ARV_PIXEL_FORMAT_RGB_8_PACKED);
  EXPECT_EQ(find_pixel_format("YUV422_8_UYVY")->pfnc, ARV_PIXEL_FORMAT_YUV_422_PACKED);
  EXPECT_EQ(find_pixel_format("YUV422_8")->pfnc, ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED);
}

}  // namespace
}  // namespace ca2
