/// The T265's messages against bytes that were written out by hand.
#include "drivers/camera/t265/messages.h"

#include <gtest/gtest.h>

#include "tests/drivers/camera/t265/golden.h"

namespace ca2::t265 {
namespace {

using golden::bytes;

/// As a response carries it.
Bytes response(Message message, Status status, const Bytes& body) {
  Bytes out = request(message);
  out.push_back(static_cast<std::uint8_t>(status));
  out.push_back(0);
  out.insert(out.end(), body.begin(), body.end());
  out[0] = static_cast<std::uint8_t>(out.size());
  return out;
}

TEST(T265Requests, AreTheseBytes) {
  EXPECT_EQ(request(Message::start), bytes("06 00 00 00 12 00"));
  EXPECT_EQ(request(Message::stop), bytes("06 00 00 00 13 00"));
  EXPECT_EQ(request(Message::get_time), bytes("06 00 00 00 02 00"));
  EXPECT_EQ(request_camera_intrinsics(Sensor::right), bytes("07 00 00 00 06 00 23"));
  EXPECT_EQ(request_extrinsics(Sensor::left), bytes("07 00 00 00 08 00 03"));
  EXPECT_EQ(request_log(1), bytes("08 00 00 00 0c 00 01 01"));
  EXPECT_EQ(request_low_power(false), bytes("08 00 00 00 25 00 00 00"));
  EXPECT_EQ(request_pose(false), bytes("08 00 00 00 06 10 00 00"));
  EXPECT_EQ(request_exposure_mode(true), bytes("08 00 00 00 16 00 03 00"));
  EXPECT_EQ(request_exposure_mode(false), bytes("08 00 00 00 16 00 00 00"));
  EXPECT_EQ(request_exposure(5000, 4), bytes(golden::set_exposure));
}

TEST(T265Requests, TheStreamsThatAreOfferedAreTheOnesThatAreChosen) {
  auto streams = parse_streams(bytes(golden::streams));
  ASSERT_TRUE(streams) << streams.error().text();
  ASSERT_EQ(streams->size(), 3u);
  EXPECT_EQ((*streams)[2].rate, 200);
  streams->pop_back();
  for (StreamEntry& stream : *streams) stream.output = 1;
  EXPECT_EQ(request_streams(*streams), bytes(golden::choose_fisheyes));
}

TEST(T265Responses, AreRead) {
  const Bytes whole = response(Message::device_info, Status::busy, bytes(golden::device_info));
  const auto got = parse_response(whole);
  ASSERT_TRUE(got) << got.error().text();
  EXPECT_EQ(got->message, Message::device_info);
  EXPECT_EQ(got->status, Status::busy);
  const auto info = parse_device_info(got->body);
  ASSERT_TRUE(info);
  EXPECT_EQ(info->serial, "908412110993");
  EXPECT_EQ(info->firmware, "0.2.0.951");
  EXPECT_TRUE(info->calibrated());

  const auto in = parse_camera_intrinsics(bytes(golden::intrinsics_left));
  ASSERT_TRUE(in);
  EXPECT_EQ(in->width, 848u);
  EXPECT_EQ(in->height, 800u);
  EXPECT_FLOAT_EQ(in->cx, 419.467f);
  EXPECT_FLOAT_EQ(in->cy, 386.975f);
  EXPECT_FLOAT_EQ(in->fx, 286.222f);
  EXPECT_FLOAT_EQ(in->fy, 287.480f);
  EXPECT_EQ(in->model, kannala_brandt4);
  EXPECT_FLOAT_EQ(in->coefficients[0], -0.004348f);
  EXPECT_FLOAT_EQ(in->coefficients[3], 0.005773f);

  const auto ex = parse_extrinsics(bytes(golden::extrinsics_left));
  ASSERT_TRUE(ex);
  EXPECT_EQ(ex->R, (std::array<float, 9>{1, 0, 0, 0, -1, 0, 0, 0, -1}));
  EXPECT_FLOAT_EQ(ex->t[0], -0.032f);
  EXPECT_EQ(ex->reference, Sensor::pose);

  EXPECT_EQ(parse_time(bytes("01 02 00 00 00 00 00 00")).value(), 0x201u);
}

TEST(T265Responses, AnUncalibratedDeviceIsKnown) {
  Bytes body = bytes(golden::device_info);
  body[16] = 0xe8;  // 1000
  body[17] = 0x03;
  EXPECT_FALSE(parse_device_info(body)->calibrated());
}

/// One byte less or more is no message, whichever it is.
TEST(T265Responses, OfAnotherLengthAreRefused) {
  const auto refused = [](const char* hex, auto parse) {
    Bytes body = bytes(hex);
    EXPECT_TRUE(parse(body));
    body.push_back(0);
    EXPECT_FALSE(parse(body));
    body.resize(body.size() - 2);
    EXPECT_FALSE(parse(body));
    EXPECT_FALSE(parse({}));
  };
  refused(golden::device_info.data(), [](const Bytes& b) { return parse_device_info(b).has_value(); });
  refused(golden::intrinsics_left.data(),
          [](const Bytes& b) { return parse_camera_intrinsics(b).has_value(); });
  refused(golden::extrinsics_left.data(), [](const Bytes& b) { return parse_extrinsics(b).has_value(); });
  refused(golden::streams.data(), [](const Bytes& b) { return parse_streams(b).has_value(); });
  refused("08 00 00 00 12 00 00 00", [](const Bytes& b) { return parse_response(b).has_value(); });
  refused("08 00 00 00 00 00 00 00", [](const Bytes& b) { return parse_time(b).has_value(); });
}

TEST(T265Streams, APictureIsRead) {
  const Bytes whole = bytes(golden::picture_right);
  const StreamMessage message = parse_stream(whole);
  const auto* picture = std::get_if<Picture>(&message);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->imager, Sensor::right);
  EXPECT_EQ(picture->time, 123456789012u);
  EXPECT_EQ(picture->arrival, 123456789999u);
  EXPECT_EQ(picture->number, 77u);
  EXPECT_EQ(picture->exposure, 4321u);
  EXPECT_EQ(picture->gain, 2.5f);
  EXPECT_EQ(Bytes(picture->pixels.begin(), picture->pixels.end()), (Bytes{1, 2, 3, 4, 5, 6}));
}

TEST(T265Streams, EventsAndMotionAreToldApart) {
  const StreamMessage stopped = parse_stream(bytes(golden::stopped));
  ASSERT_TRUE(std::holds_alternative<Event>(stopped));
  EXPECT_EQ(std::get<Event>(stopped).message, Message::status);
  EXPECT_EQ(std::get<Event>(stopped).status, Status::stopped);
  EXPECT_TRUE(std::holds_alternative<Other>(parse_stream(bytes(golden::acceleration))));
}

TEST(T265Streams, WhatIsCutShortOrDisagreesWithItselfIsDamaged) {
  const Bytes whole = bytes(golden::picture_right);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(std::holds_alternative<Damaged>(parse_stream(ByteSpan(whole).first(size)))) << size;
  }
  for (const std::size_t at : {0u, 28u, 40u}) {  // message length, metadata length, picture length
    Bytes wrong = whole;
    ++wrong[at];
    EXPECT_TRUE(std::holds_alternative<Damaged>(parse_stream(wrong))) << at;
  }
  Bytes empty(whole.begin(), whole.begin() + picture_header);
  empty[0] = picture_header;
  empty[40] = 0;
  EXPECT_TRUE(std::holds_alternative<Damaged>(parse_stream(empty)));
}

}  // namespace
}  // namespace ca2::t265
