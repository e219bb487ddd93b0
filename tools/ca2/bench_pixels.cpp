/// `ca2 bench pixels`: a camera's buffer to the picture that detectors get, against copying the buffer.
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "core/io/jpeg.h"
#include "drivers/camera/pixel_formats/pixel_format.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

constexpr int width = 2048, height = 2048;
constexpr std::size_t buffers = 4;  // in turn, as a camera fills them: more than a processor's cache holds

using Bytes = std::vector<std::uint8_t>;

/// Noise on a slope: JPEG's cost depends on what is in the picture.
Bytes jpeg_frame(std::mt19937& random) {
  Image image{width, height, 3, 8, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) {
        image.bytes.push_back(
            static_cast<std::uint8_t>((x + y) / 20 + c * 8 + static_cast<int>(random() >> 30)));
      }
    }
  }
  const std::string jpeg = encode_jpeg(image, 90).value();
  return {jpeg.begin(), jpeg.end()};
}

std::vector<Bytes> frames_of(const PixelFormat& format) {
  std::mt19937 random(1);
  std::vector<Bytes> frames;
  for (std::size_t i = 0; i < buffers; ++i) {
    if (format.packing == PixelPacking::jpeg) {
      frames.push_back(jpeg_frame(random));
      continue;
    }
    Bytes& bytes = frames.emplace_back(format.tight_size(width, height));
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  }
  return frames;
}

}  // namespace

Result<int> bench_pixels(const BenchOptions& options) {
  nlohmann::ordered_json rows = nlohmann::json::array();
  if (!options.json) {
    std::printf("%-16s %10s %10s %10s   (2048 x 2048, CPU ms per frame, medians)\n", "format", "to grey",
                "memcpy", "ratio");
  }
  for (const PixelFormat& format : pixel_formats()) {
    // The four phases of a mosaic cost the same, and so do two names of one thing.
    if ((format.bayer() && format.colour != PixelColour::bayer_rg) || format.name == "JPEG") continue;
    const std::vector<Bytes> frames = frames_of(format);
    Bytes copy(frames[0].size() + (frames[0].size() >> 3));
    std::vector<double> convert_ms, copy_ms;
    for (int i = 0; i < options.repeats; ++i) {
      double start = cpu_ns();
      for (const Bytes& bytes : frames) {
        const auto image = to_image({&format, width, height, 0, bytes}, PictureKind::grey);
        if (!image) return fail(image.error());
        keep(image->bytes.data());
      }
      convert_ms.push_back(1e-6 * (cpu_ns() - start) / buffers);
      start = cpu_ns();
      for (const Bytes& bytes : frames) {
        std::memcpy(copy.data(), bytes.data(), bytes.size());
        keep(copy.data());
      }
      copy_ms.push_back(1e-6 * (cpu_ns() - start) / buffers);
    }
    const double convert = median(convert_ms), floor = median(copy_ms);
    if (options.json) {
      rows.push_back({{"format", format.name},
                      {"bytes", frames[0].size()},
                      {"to_grey_ms", convert},
                      {"memcpy_ms", floor},
                      {"ratio", convert / floor}});
    } else {
      std::printf("%-16s %10.2f %10.2f %10.1f\n", std::string(format.name).c_str(), convert, floor,
                  convert / floor);
      std::fflush(stdout);
    }
  }
  if (options.json) std::puts(rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
