/// @file Pictures and point clouds as robots log them over LCM: the bot_core types of libbot and Pronto,
/// which Drake's and others' robots use too. Their fields and fingerprints are facts of the wire;
/// docs/import.md lists them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/types/image.h"
#include "core/types/result.h"
#include "core/types/scan.h"

namespace ca2 {

enum class RobotMessage { other, picture, cloud };

/// What an encoded message is, by its fingerprint.
RobotMessage kind_of_message(std::span<const std::uint8_t> message);

/// When the measurement took place, us; all of these types begin with it. 0 where the message is too short.
std::int64_t message_utime(std::span<const std::uint8_t> message);

/// bot_core.image_t: grey of 8 and 16 bits, RGB, BGR, Bayer, YUV 4:2:2, NV12, JPEG. ErrorCode::data where the
/// bytes are not what they say, or the pixel format is none of these. `name` is what errors call the message.
Result<Image> decode_picture_message(std::span<const std::uint8_t> message, const std::string& name);

/// bot_core.pointcloud_t, with Pronto's order of the channels too, and bot_core.pointcloud2_t. Fields x y z
/// are required; intensity and ring are read where they are. ErrorCode::data.
Result<Scan> decode_cloud_message(std::span<const std::uint8_t> message, const std::string& name);

}  // namespace ca2
