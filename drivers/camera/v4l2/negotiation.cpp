#include "drivers/camera/v4l2/negotiation.h"

#include <cmath>

#include "core/types/text.h"

namespace ca2 {
namespace {

constexpr __u32 most_entries = 256;  // of an enumeration; a broken driver's may have no end

std::vector<std::uint32_t> offered_formats(const V4l2Device& device) {
  std::vector<std::uint32_t> codes;
  for (__u32 i = 0; i < most_entries; ++i) {
    v4l2_fmtdesc description{};
    description.index = i;
    description.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (device.call(VIDIOC_ENUM_FMT, &description) != 0) break;
    codes.push_back(description.pixelformat);
  }
  return codes;
}

std::string sizes_of(const V4l2Device& device, std::uint32_t code) {
  std::string text;
  for (__u32 i = 0; i < most_entries; ++i) {
    v4l2_frmsizeenum size{};
    size.index = i;
    size.pixel_format = code;
    if (device.call(VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      text += formatted(" %ux%u", size.discrete.width, size.discrete.height);
      continue;
    }
    const v4l2_frmsize_stepwise& range = size.stepwise;
    text +=
        formatted(" %ux%u to %ux%u", range.min_width, range.min_height, range.max_width, range.max_height);
    break;
  }
  return text;
}

/// The lower the better: grey, as it was sensed, in 8 bits, before luma with colours beside it, before
/// mosaics and colours, before what was compressed.
int rank(const PixelFormat& format) {
  if (format.packing == PixelPacking::jpeg) return 100;
  const int depth = format.bits == 8 ? 0 : 1;
  if (format.colour == PixelColour::mono) return depth;
  if (format.colour == PixelColour::nv12 || format.colour == PixelColour::yuyv ||
      format.colour == PixelColour::uyvy) {
    return 10;
  }
  return 20 + depth;
}

Result<const PixelFormat*> choose(const V4l2Device& device, const std::string& wanted) {
  const PixelFormat* best = nullptr;
  std::string offered;
  for (const std::uint32_t code : offered_formats(device)) {
    offered += (offered.empty() ? "" : ", ") + fourcc_text(code);
    const PixelFormat* format = pixel_format_of_fourcc(code);
    if (!format) continue;
    if (wanted == format->name || wanted == fourcc_text(code)) return format;
    if (wanted.empty() && (!best || rank(*format) < rank(*best))) best = format;
  }
  if (best) return best;
  return fail(ErrorCode::config, device.node(),
              wanted.empty() ? "the camera has no pixel format that is known here"
                             : "the camera has no format '" + wanted + "'",
              "it has " + offered);
}

bool full_range(const v4l2_pix_format& pixels) {
  if (pixels.quantization != V4L2_QUANTIZATION_DEFAULT)
    return pixels.quantization == V4L2_QUANTIZATION_FULL_RANGE;
  return pixels.colorspace == V4L2_COLORSPACE_JPEG;  // the header's V4L2_MAP_QUANTIZATION_DEFAULT for YUV
}

/// Asks for the rate, or for what it is.
void settle_rate(const V4l2Device& device, const std::optional<double>& wanted, V4l2Agreement& agreement) {
  v4l2_streamparm parameters{};
  parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (device.call(VIDIOC_G_PARM, &parameters) != 0) {
    if (wanted) agreement.warning = "the camera's frame rate cannot be set";
    return;
  }
  v4l2_captureparm& capture = parameters.parm.capture;
  if (wanted && (capture.capability & V4L2_CAP_TIMEPERFRAME)) {
    // In units of 10 us: exact for every rate that cameras have.
    capture.timeperframe = {static_cast<__u32>(std::lround(1e5 / *wanted)), 100'000};
    device.call(VIDIOC_S_PARM, &parameters);
  }
  const v4l2_fract& period = capture.timeperframe;
  if (period.numerator > 0 && period.denominator > 0) {
    agreement.frame_rate = static_cast<double>(period.denominator) / period.numerator;
  }
  if (wanted && std::abs(agreement.frame_rate - *wanted) > 0.01 * *wanted) {
    agreement.warning =
        formatted("gives %g pictures per second instead of %g", agreement.frame_rate, *wanted);
  }
}

}  // namespace

std::string v4l2_abilities(const V4l2Device& device) {
  std::string text;
  for (const std::uint32_t code : offered_formats(device)) {
    text += (text.empty() ? "" : "; ") + fourcc_text(code) + sizes_of(device, code);
  }
  return text;
}

Result<V4l2Agreement> negotiate(const V4l2Device& device, const V4l2Wishes& wishes) {
  const auto format = choose(device, wishes.format);
  if (!format) return fail(format.error());
  v4l2_format request{};
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (const int code = device.call(VIDIOC_G_FMT, &request)) {
    return fail(v4l2_error(device.node(), "read its format", code));
  }
  v4l2_pix_format& pixels = request.fmt.pix;
  const __u32 width = wishes.width ? static_cast<__u32>(*wishes.width) : pixels.width;
  const __u32 height = wishes.height ? static_cast<__u32>(*wishes.height) : pixels.height;
  pixels = {};
  pixels.width = width;
  pixels.height = height;
  pixels.pixelformat = (*format)->fourcc;
  pixels.field = V4L2_FIELD_NONE;
  if (const int code = device.call(VIDIOC_S_FMT, &request)) {
    return fail(v4l2_error(device.node(), "set its format", code));
  }
  if (pixels.pixelformat != (*format)->fourcc || (wishes.width && pixels.width != width) ||
      (wishes.height && pixels.height != height)) {
    return fail(ErrorCode::config, device.node(),
                formatted("the camera makes %s %ux%u of %s %ux%u", fourcc_text(pixels.pixelformat).c_str(),
                          pixels.width, pixels.height, fourcc_text((*format)->fourcc).c_str(), width, height),
                "it has" + sizes_of(device, (*format)->fourcc) + " in that format");
  }
  if (pixels.field != V4L2_FIELD_NONE && pixels.field != V4L2_FIELD_ANY) {
    return fail(ErrorCode::config, device.node(), "the camera gives half pictures (interlaced)",
                "choose another size");
  }
  V4l2Agreement agreement;
  agreement.format = *format;
  agreement.width = static_cast<int>(pixels.width);
  agreement.height = static_cast<int>(pixels.height);
  agreement.stride = (*format)->packing == PixelPacking::jpeg ? 0 : pixels.bytesperline;
  agreement.full_range = full_range(pixels);
  settle_rate(device, wishes.frame_rate, agreement);
  return agreement;
}

}  // namespace ca2
