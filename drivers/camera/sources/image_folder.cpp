/// @file A recording's pictures as a camera: cameras/<name>/<utc_ns>.png or .jpg.
#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>

#include "core/io/read_picture.h"
#include "core/types/counted.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/host_time.h"
#include "drivers/net/pacer.h"
#include "drivers/net/stop_event.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

struct File {
  std::int64_t time = 0;  ///< ns UTC: its name
  std::filesystem::path path;
};

constexpr CameraOption options_known[] = {
    {"path", "folder of <utc_ns>.png or .jpg files", true},
    {"speed", "1 as recorded (default), 2 twice as fast, 0 as fast as they are taken"},
    {"stamps", "recorded (default): the files' times; live: the host's clock when a picture is due"}};

Result<std::vector<File>> list_pictures(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::directory_iterator entries(folder, code);
  if (code) return fail(ErrorCode::unavailable, folder.string(), code.message());
  std::vector<File> files;
  for (; entries != std::filesystem::directory_iterator(); entries.increment(code)) {
    const std::filesystem::path& path = entries->path();
    const std::string extension = path.extension().string(), stem = path.stem().string();
    // Hidden files are pictures that are being written.
    if ((extension != ".png" && extension != ".jpg") || stem.front() == '.') continue;
    File file{0, path};
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), file.time);
    if (end != stem.data() + stem.size() || error != std::errc() || file.time < 0) {
      return fail(ErrorCode::data, path.string(), "the name is not a time in ns UTC",
                  "name pictures by the middle of their exposure: 1700000000123456789.png");
    }
    files.push_back(std::move(file));
  }
  if (code) return fail(ErrorCode::io, folder.string(), code.message());
  if (files.empty()) {
    return fail(ErrorCode::unavailable, folder.string(), "has no .png or .jpg pictures",
                "a recording keeps them in cameras/<name>/");
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.time < b.time; });
  return files;
}

class ImageFolder : public CameraSource {
 public:
  ImageFolder(std::vector<File> files, CameraStream stream, double speed, bool live)
      : files_(std::move(files)), streams_{std::move(stream)}, speed_(speed), live_(live), pacer_(speed) {}

  const std::vector<CameraStream>& streams() const override { return streams_; }
  std::string description() const override {
    return counted(files_.size(), "picture") + " in " + files_[0].path.parent_path().string();
  }
  double frame_rate() const override {
    if (speed_ <= 0 || files_.size() < 2) return 0;
    const double seconds = 1e-9 * static_cast<double>(files_.back().time - files_.front().time);
    return seconds > 0 ? speed_ * static_cast<double>(files_.size() - 1) / seconds : 0;
  }

  Result<void> start() override {
    next_ = 0;
    pacer_ = Pacer(speed_);
    return {};
  }
  void stop() override {}
  void interrupt() noexcept override { stopped_.set(); }

  CameraPoll next(std::chrono::milliseconds timeout) override {
    const auto deadline = Clock::now() + timeout;
    while (next_ < files_.size()) {
      if (stopped_.is_set()) return {CameraEvent::stopped, {}, {}};
      const auto now = Clock::now();
      const auto due =
          now + std::chrono::nanoseconds(pacer_.wait(files_[next_].time, now.time_since_epoch().count()));
      if (due > now) {
        if (stopped_.wait_until(std::min(due, deadline))) return {CameraEvent::stopped, {}, {}};
        if (due > deadline) return {};
      }
      const std::size_t index = next_++;
      Result<Image> image = read_picture(files_[index].path);
      if (!image || image->width != streams_[0].width || image->height != streams_[0].height) {
        ++incomplete_;
        continue;
      }
      ++frames_;
      CameraFrame frame;
      frame.image = std::make_shared<const Image>(std::move(*image));
      frame.time = live_ ? utc_of(due) : files_[index].time;
      frame.sequence = index;
      return {CameraEvent::frame, std::move(frame), {}};
    }
    return {stopped_.is_set() ? CameraEvent::stopped : CameraEvent::end, {}, {}};
  }

  Result<void> set_control(const std::string& name, const std::string&) override {
    return fail(ErrorCode::usage, description(), "has no control '" + name + "'", "pictures are as they are");
  }
  std::map<std::string, CameraControl> controls() const override { return {}; }
  CameraCounters counters() const override {
    CameraCounters counters;
    counters.frames = frames_;
    counters.incomplete = incomplete_;
    return counters;
  }

 private:
  const std::vector<File> files_;  ///< by time
  const std::vector<CameraStream> streams_;
  const double speed_;
  const bool live_;
  Pacer pacer_;
  StopEvent stopped_;
  std::size_t next_ = 0;
  std::atomic<std::uint64_t> frames_{0}, incomplete_{0};
};

Result<std::unique_ptr<CameraSource>> open(OptionReader& options) {
  const std::string path = options.require("path");
  const double speed = options.number("speed", 0, 1000).value_or(1);
  constexpr std::string_view stamps[] = {"recorded", "live"};
  const bool live = options.choice("stamps", stamps) == "live";
  if (const auto good = options.done(); !good) return fail(good.error());
  auto files = list_pictures(path);
  if (!files) return fail(files.error());
  const auto first = read_picture((*files)[0].path);
  if (!first) return fail(first.error());
  CameraStream stream;
  stream.width = first->width;
  stream.height = first->height;
  stream.format = (first->channels == 1 ? "grey " : "RGB ") + std::to_string(first->bits) + " bits";
  return std::make_unique<ImageFolder>(std::move(*files), std::move(stream), speed, live);
}

Result<std::vector<FoundCamera>> list() {
  return std::vector<FoundCamera>{};
}

}  // namespace

const CameraDriver& image_folder_camera_driver() {
  static const CameraDriver driver{"image_folder", "the pictures of a recording", options_known, open, list};
  return driver;
}

}  // namespace ca2
