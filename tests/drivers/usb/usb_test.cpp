/// Our use of libusb against devices that umockdev plays.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <map>
#include <mutex>
#include <thread>

#include "drivers/usb/usb_device.h"
#include "drivers/usb/usb_reader.h"
#include "tests/drivers/usb/mock_usb.h"

namespace ca2 {
namespace {

using std::chrono::milliseconds, std::chrono::seconds;
using test::Bytes, test::MockUsb, test::MockUsbDevice;

constexpr UsbId camera{0x8087, 0x0b37}, loader{0x03e7, 0x2150};

class Usb : public testing::Test {
 protected:
  void SetUp() override {
    if (!MockUsb::possible()) GTEST_SKIP() << "needs umockdev-wrapper: run it through ctest";
    mock_ = std::make_unique<MockUsb>();
  }

  static MockUsbDevice device(UsbId id, const char* place, int address) {
    MockUsbDevice out;
    out.vendor = id.vendor;
    out.product = id.product;
    out.place = place;
    out.address = address;
    out.endpoints = {0x81, 0x01, 0x02, 0x82};
    return out;
  }

  static std::vector<UsbDeviceInfo> list(std::vector<UsbId> ids) {
    const auto found = list_usb_devices(ids);
    EXPECT_TRUE(found) << found.error().text();
    return found ? *found : std::vector<UsbDeviceInfo>{};
  }

  std::unique_ptr<UsbDevice> open() {
    auto opened = UsbDevice::open(list({camera}).at(0), 0, milliseconds(0));
    EXPECT_TRUE(opened) << opened.error().text();
    return opened ? std::move(*opened) : nullptr;
  }

  std::unique_ptr<MockUsb> mock_;
};

TEST_F(Usb, DevicesAreListedByPlaceWithTheirSerialNumbers) {
  EXPECT_TRUE(list({camera, loader}).empty());
  MockUsbDevice first = device(camera, "1-4", 7);
  first.serial = "908412110993";
  first.speed = "5000";
  mock_->plug_in(first);
  mock_->plug_in(device(loader, "1-2", 9));
  mock_->plug_in(device({0x1234, 0x5678}, "1-3", 5));
  const auto found = list({camera, loader});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0], (UsbDeviceInfo{loader, "1-2", 9, 480, ""}));
  EXPECT_EQ(found[1], (UsbDeviceInfo{camera, "1-4", 7, 5000, "908412110993"}));
  EXPECT_EQ(list({loader}).size(), 1u);
}

TEST_F(Usb, WhatIsInUseOrGoneIsSaid) {
  MockUsbDevice busy = device(camera, "1-1", 3);
  busy.claim = [] { return EBUSY; };
  mock_->plug_in(busy);
  const auto refused = UsbDevice::open(list({camera}).at(0), 0, milliseconds(0));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::unavailable);
  EXPECT_NE(refused.error().text().find("another program"), std::string::npos) << refused.error().text();

  UsbDeviceInfo gone = list({camera}).at(0);
  ++gone.address;
  const auto absent = UsbDevice::open(gone, 0, milliseconds(0));
  ASSERT_FALSE(absent);
  EXPECT_NE(absent.error().text().find("not there any more"), std::string::npos) << absent.error().text();
}

TEST_F(Usb, EndpointsAreFound) {
  mock_->plug_in(device(camera, "1-1", 3));
  const auto opened = open();
  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->first_bulk_out(), 0x01);
  EXPECT_TRUE(opened->has_endpoint(0x82));
  EXPECT_FALSE(opened->has_endpoint(0x83));
}

/// Whole transfers there and back, longer than one packet of the kernel's interface.
TEST_F(Usb, TransfersArriveWhole) {
  std::mutex mutex;
  Bytes echo;
  MockUsbDevice mock = device(camera, "1-1", 3);
  mock.written = [&](std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
    EXPECT_EQ(endpoint, 0x02);
    const std::lock_guard lock(mutex);
    echo.assign(bytes.begin(), bytes.end());
    return 0;
  };
  mock.read = [&](std::uint8_t endpoint) -> std::optional<Bytes> {
    const std::lock_guard lock(mutex);
    if (endpoint != 0x82 || echo.empty()) return std::nullopt;
    return std::exchange(echo, {});
  };
  mock_->plug_in(mock);
  const auto opened = open();
  ASSERT_TRUE(opened);
  for (const std::size_t size : {1u, 511u, 512u, 3001u, 16384u}) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::uint8_t>(i * 7 + size);
    const UsbTransfer sent = opened->write(0x02, bytes, seconds(5));
    EXPECT_EQ(sent.outcome, UsbOutcome::done);
    EXPECT_EQ(sent.size, size);
    Bytes back(16384);
    const UsbTransfer got = opened->read(0x82, back, seconds(5));
    EXPECT_EQ(got.outcome, UsbOutcome::done);
    back.resize(got.size);
    EXPECT_EQ(back, bytes);
  }
}

TEST_F(Usb, SilenceUnpluggingAndTooMuchAreToldApart) {
  std::atomic<bool> too_much{false};
  MockUsbDevice mock = device(camera, "1-1", 3);
  mock.written = [](std::uint8_t, std::span<const std::uint8_t>) { return ENODEV; };
  mock.read = [&](std::uint8_t) { return too_much ? std::optional(Bytes(200)) : std::nullopt; };
  mock_->plug_in(mock);
  const auto opened = open();
  ASSERT_TRUE(opened);
  Bytes buffer(100);
  EXPECT_EQ(opened->read(0x82, buffer, milliseconds(50)).outcome, UsbOutcome::timeout);
  EXPECT_EQ(opened->write(0x02, buffer, milliseconds(500)).outcome, UsbOutcome::gone);
  too_much = true;
  EXPECT_EQ(opened->read(0x82, buffer, seconds(5)).outcome, UsbOutcome::overflow);
}

/// A reader gets everything in order, ends once, and can be destroyed with transfers in flight.
TEST_F(Usb, AReaderReadsWithoutPause) {
  std::atomic<int> sent{0};
  MockUsbDevice mock = device(camera, "1-1", 3);
  mock.read = [&](std::uint8_t endpoint) -> std::optional<Bytes> {
    if (endpoint != 0x81 || sent >= 50) return std::nullopt;
    return Bytes(100, static_cast<std::uint8_t>(sent++));
  };
  mock_->plug_in(mock);
  const auto opened = open();
  ASSERT_TRUE(opened);
  std::vector<int> got;
  std::atomic<int> count{0}, ends{0};
  {
    const UsbReader reader(
        *opened, {0x81, false, 4, 1024},
        [&](std::span<const std::uint8_t> bytes) {
          EXPECT_EQ(bytes.size(), 100u);
          got.push_back(bytes[0]);
          ++count;
        },
        [&](UsbOutcome) { ++ends; });
    for (int i = 0; i < 500 && count < 50; ++i) std::this_thread::sleep_for(milliseconds(10));
  }
  ASSERT_EQ(got.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(got[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(ends, 0);
}

TEST_F(Usb, AReaderSaysOnceWhyItEnded) {
  MockUsbDevice mock = device(camera, "1-1", 3);
  mock.read = [](std::uint8_t) { return std::optional(Bytes(2000)); };
  mock_->plug_in(mock);
  const auto opened = open();
  ASSERT_TRUE(opened);
  std::mutex mutex;
  std::vector<UsbOutcome> ends;
  {
    const UsbReader reader(
        *opened, {0x81, false, 4, 1024}, [](std::span<const std::uint8_t>) { ADD_FAILURE() << "too long"; },
        [&](UsbOutcome outcome) {
          const std::lock_guard lock(mutex);
          ends.push_back(outcome);
        });
    for (int i = 0; i < 500; ++i) {
      std::this_thread::sleep_for(milliseconds(10));
      const std::lock_guard lock(mutex);
      if (!ends.empty()) break;
    }
  }
  EXPECT_EQ(ends, std::vector{UsbOutcome::overflow});
}

}  // namespace
}  // namespace ca2
