/// @file A virtual camera: a board that is held and moved before it, or a moving ramp.
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <random>

#include "core/types/text.h"
#include "drivers/camera/camera_driver.h"
#include "drivers/camera/host_time.h"
#include "drivers/camera/pattern/board_motion.h"
#include "drivers/camera/pattern/board_picture.h"
#include "drivers/net/stop_event.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::string_view patterns[] = {"board", "ramp"};
constexpr std::string_view formats[] = {"Mono8", "Mono16", "RGB8"};
constexpr double least_rate = 0.1, most_rate = 1000;  // Hz

constexpr CameraOption options_known[] = {
    {"id", "any name: tells several virtual cameras apart", true},
    {"pattern", "board (default), or ramp: grey = x + y + picture number"},
    {"board", "type of the board, checkerboard by default"},
    {"columns", "as in the rig's board, 8 by default"},
    {"rows", "as in the rig's board, 6 by default"},
    {"square", "m, 0.04 by default"},
    {"marker", "m, charuco only, 3/4 of a square by default"},
    {"spacing", "aprilgrid only: gap over tag size, 0.3 by default"},
    {"width", "px, 640 by default"},
    {"height", "px, 480 by default"},
    {"format", "Mono8 (default), Mono16 or RGB8"},
    {"frame_rate", "Hz, 10 by default"},
    {"hold", "s that the board is held at every pose, 2 by default"},
    {"move", "s that it takes from pose to pose, 1 by default"},
    {"seed", "of the poses, a whole number, 1 by default"},
    {"noise", "standard deviation in grey levels of 255, 1 by default"}};

struct PatternOptions {
  std::string id;
  bool ramp = false;
  Board board;
  int width = 640, height = 480;
  std::string format = "Mono8";
  double frame_rate = 10;
  BoardMotionOptions motion;
  double noise = 1;
};

/// Focal lengths of 0.9 widths (58 degrees), no distortion.
Camera virtual_camera(int width, int height) {
  Camera camera{find_camera_model("pinhole_radtan"), CameraParameters(8), width, height};
  camera.parameters << 0.9 * width, 0.9 * width, 0.5 * (width - 1), 0.5 * (height - 1), 0, 0, 0, 0;
  return camera;
}

class PatternCamera : public CameraSource {
 public:
  explicit PatternCamera(PatternOptions options)
      : options_(std::move(options)),
        camera_(virtual_camera(options_.width, options_.height)),
        motion_(options_.board, camera_, options_.motion),
        period_(period_of(options_.frame_rate)) {
    CameraStream stream;
    stream.width = options_.width;
    stream.height = options_.height;
    stream.format = options_.format;
    stream.intrinsics = camera_;
    streams_.push_back(std::move(stream));
    std::mt19937_64 random(options_.motion.seed);
    std::normal_distribution<float> normal;
    for (float& value : noise_) value = normal(random);
  }

  const std::vector<CameraStream>& streams() const override { return streams_; }
  std::string description() const override {
    return "virtual camera" + (options_.id.empty() ? "" : " '" + options_.id + "'") + ", " +
           (options_.ramp ? "a ramp" : "a board that is held and moved");
  }
  double frame_rate() const override { return triggered_ ? 0 : 1e9 / static_cast<double>(period_); }

  Result<void> start() override {
    start_ = due_ = Clock::now();
    return {};
  }
  void stop() override {}
  void interrupt() noexcept override { stopped_.set(); }

  CameraPoll next(std::chrono::milliseconds timeout) override {
    const auto deadline = Clock::now() + timeout;
    for (;;) {
      if (stopped_.is_set()) return {CameraEvent::stopped, {}, {}};
      const auto now = Clock::now();
      if (triggered_) {
        // A trigger needs no better time than this: its picture is stamped when it is taken.
        if (triggers_ > 0) {
          --triggers_;
          due_ = now;
          break;
        }
        if (now >= deadline) return {};
        stopped_.wait_until(std::min(deadline, now + std::chrono::milliseconds(2)));
        continue;
      }
      if (due_ <= now) break;
      if (due_ > deadline) {
        return {stopped_.wait_until(deadline) ? CameraEvent::stopped : CameraEvent::timeout, {}, {}};
      }
      stopped_.wait_until(due_);
    }
    const std::chrono::nanoseconds period(period_);
    // Who comes late finds the newest picture, as with a real camera.
    if (const auto late = (Clock::now() - due_) / period; late > 0 && !triggered_) {
      due_ += late * period;
      sequence_ += static_cast<std::uint64_t>(late);
      overrun_ += static_cast<std::uint64_t>(late);
    }
    CameraFrame frame;
    frame.image = std::make_shared<const Image>(picture());
    frame.time = utc_of(due_);
    frame.sequence = sequence_++;
    due_ += period;
    ++frames_;
    return {CameraEvent::frame, std::move(frame), {}};
  }

  Result<void> set_control(const std::string& name, const std::string& value) override {
    OptionReader reader({{name, value}}, controls_known);
    constexpr std::string_view triggers[] = {"off", "software"};
    const auto rate = reader.number("frame_rate", least_rate, most_rate);
    const auto trigger = reader.choice("trigger", triggers);
    if (const auto good = reader.done(); !good) return good;
    if (rate) period_ = period_of(*rate);
    if (trigger) triggered_ = *trigger == "software";
    return {};
  }
  std::map<std::string, CameraControl> controls() const override {
    return {{"frame_rate",
             {formatted("%g", 1e9 / static_cast<double>(period_)),
              formatted("%g to %g", least_rate, most_rate), ""}},
            {"trigger", {triggered_ ? "software" : "off", "off, software", ""}}};
  }
  Result<void> trigger() override {
    if (!triggered_) {
      return fail(ErrorCode::usage, description(), "is not waiting for triggers",
                  "set 'trigger' to 'software'");
    }
    ++triggers_;
    return {};
  }
  CameraCounters counters() const override {
    CameraCounters counters;
    counters.frames = frames_;
    counters.overrun = overrun_;
    return counters;
  }

 private:
  static constexpr std::string_view controls_known[] = {"frame_rate", "trigger"};
  static std::int64_t period_of(double rate) { return std::llround(1e9 / rate); }

  Image picture() {
    Image image{options_.width,
                options_.height,
                options_.format == "RGB8" ? 3 : 1,
                options_.format == "Mono16" ? 16 : 8,
                {}};
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    image.bytes.resize(width * height * image.bytes_per_pixel());
    if (!options_.ramp) {
      const auto place = motion_.at(std::chrono::duration<double>(due_ - start_).count());
      if (place.moving || place.pose != painted_) {
        painting_ = board_picture(options_.board, camera_, place.T_camera_board);
        painted_ = place.moving ? -1 : place.pose;
      }
    }
    std::size_t i = 0;
    for (std::size_t y = 0; y < height; ++y) {
      // A row of noise begins anywhere in the table, so that rows and pictures differ.
      std::size_t k = random_() % noise_.size();
      for (std::size_t x = 0; x < width; ++x, ++i) {
        if (options_.ramp) {
          put(image, i, static_cast<float>((x + y + sequence_) & 0xff));
        } else {
          put(image, i, painting_.pixels[i] + static_cast<float>(options_.noise) * noise_[k]);
          k = k + 1 == noise_.size() ? 0 : k + 1;
        }
      }
    }
    return image;
  }

  static void put(Image& image, std::size_t i, float grey) {
    const float value = std::min(255.0f, std::max(0.0f, grey));
    if (image.bits == 16) {
      const auto level = static_cast<std::uint16_t>(value * 257 + 0.5f);
      std::memcpy(&image.bytes[2 * i], &level, 2);
      return;
    }
    for (int c = 0; c < image.channels; ++c) {
      image.bytes[i * static_cast<std::size_t>(image.channels) + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(value + 0.5f);
    }
  }

  const PatternOptions options_;
  const Camera camera_;
  const BoardMotion motion_;
  std::vector<CameraStream> streams_;
  std::array<float, 65521> noise_;  ///< normal, sigma 1; a prime count, so that widths do not repeat it
  std::minstd_rand random_{1};
  StopEvent stopped_;
  Clock::time_point start_, due_;     ///< due_: of the next picture
  std::uint64_t sequence_ = 0;        ///< of the next picture
  GreyImage painting_;                ///< the board without noise, kept while it is held
  std::int64_t painted_ = -1;         ///< its pose; -1: moving
  std::atomic<std::int64_t> period_;  ///< ns
  std::atomic<bool> triggered_{false};
  std::atomic<int> triggers_{0};  ///< not yet answered
  std::atomic<std::uint64_t> frames_{0}, overrun_{0};
};

Result<std::unique_ptr<CameraSource>> open(OptionReader& reader) {
  PatternOptions options;
  options.id = reader.text("id").value_or("");
  options.ramp = reader.choice("pattern", patterns) == "ramp";
  options.format = reader.choice("format", formats).value_or(options.format);
  options.width = reader.integer("width", 16, 8192).value_or(options.width);
  options.height = reader.integer("height", 16, 8192).value_or(options.height);
  options.frame_rate = reader.number("frame_rate", least_rate, most_rate).value_or(options.frame_rate);
  options.motion.hold = reader.number("hold", 0, 1e6).value_or(options.motion.hold);
  options.motion.move = reader.number("move", 0.01, 1e6).value_or(options.motion.move);
  options.motion.seed = static_cast<std::uint64_t>(reader.integer("seed", 0, 1'000'000'000).value_or(1));
  options.noise = reader.number("noise", 0, 100).value_or(options.noise);
  Board& board = options.board;
  std::vector<std::string_view> types;
  for (const BoardType* type : board_types()) types.push_back(type->name());
  board.type = find_board_type(reader.choice("board", types).value_or("checkerboard"));
  board.columns = reader.integer("columns", 2, 100).value_or(8);
  board.rows = reader.integer("rows", 2, 100).value_or(6);
  board.square = reader.number("square", 1e-3, 10).value_or(0.04);
  const bool charuco = board.type->name() == "charuco";
  board.marker = reader.number("marker", 1e-3, 10).value_or(charuco ? 0.75 * board.square : 0);
  const bool aprilgrid = board.type->name() == "aprilgrid";
  board.spacing = reader.number("spacing", 0.01, 10).value_or(aprilgrid ? 0.3 : 0);
  for (std::string& wrong : board.type->invalid(board)) reader.problem(std::move(wrong));
  if (const auto good = reader.done(); !good) return fail(good.error());
  return std::make_unique<PatternCamera>(std::move(options));
}

Result<std::vector<FoundCamera>> list() {
  return std::vector<FoundCamera>{};
}

}  // namespace

const CameraDriver& pattern_camera_driver() {
  static const CameraDriver driver{"pattern", "a virtual camera: a board that is held and moved, or a ramp",
                                   options_known, open, list};
  return driver;
}

}  // namespace ca2
