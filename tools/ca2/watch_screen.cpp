#include "tools/ca2/watch_screen.h"

#include <algorithm>
#include <cmath>

#include "core/types/text.h"
#include "tools/ca2/status_text.h"

namespace ca2 {
namespace {

constexpr const char* plain = "\033[0m";
constexpr const char* dim = "\033[2m";
constexpr const char* red = "\033[31m";
constexpr const char* green = "\033[32m";
constexpr const char* yellow = "\033[33m";

/// Background and text of the big word.
const char* banner_colour(CaptureState state) {
  switch (state) {
    case CaptureState::waiting:
      return "\033[1;37;44m";
    case CaptureState::moving:
      return "\033[1;30;43m";
    case CaptureState::holding:
      return "\033[1;30;46m";
    case CaptureState::capturing:
      return "\033[1;37;45m";
    case CaptureState::captured:
    case CaptureState::done:
      return "\033[1;30;42m";
  }
  return plain;
}

std::string cut(const std::string& text, int width) {
  const auto columns = static_cast<std::size_t>(std::max(0, width));
  return text.size() <= columns ? text : text.substr(0, columns);
}

std::string upper(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

class Screen {
 public:
  Screen(int width, int height) : width_(width), height_(height) {}

  int left() const { return height_ - static_cast<int>(lines_.size()); }
  int width() const { return width_; }

  /// `text` without colours; they go round it.
  void add(const char* colour, const std::string& text) {
    if (left() > 0) lines_.push_back(colour + cut(text, width_) + plain);
  }
  void add_raw(std::string line) {
    if (left() > 0) lines_.push_back(std::move(line));
  }
  void paragraph(const char* colour, const std::string& label, const std::string& text, int most) {
    const auto lines = wrapped(text, width_ - static_cast<int>(label.size()));
    for (std::size_t i = 0; i < lines.size() && static_cast<int>(i) < most; ++i) {
      add(colour, (i == 0 ? label : std::string(label.size(), ' ')) + lines[i]);
    }
  }
  std::vector<std::string> take() { return std::move(lines_); }

 private:
  int width_, height_;
  std::vector<std::string> lines_;
};

void banner(Screen& screen, const CaptureStatus& capture) {
  const char* colour = banner_colour(capture.state);
  const std::string word = upper(state_name(capture.state));
  const int before = std::max(0, (screen.width() - static_cast<int>(word.size())) / 2);
  std::string line = std::string(static_cast<std::size_t>(before), ' ') + word;
  line.resize(static_cast<std::size_t>(screen.width()), ' ');
  const std::string empty(static_cast<std::size_t>(screen.width()), ' ');
  const bool tall = screen.left() >= 18;
  if (tall) screen.add(colour, empty);
  screen.add(colour, line);
  if (tall) screen.add(colour, empty);
}

/// "[######----]", full at 1.
std::string bar(double share, int width) {
  const int inner = std::max(1, width - 2);
  const int full =
      std::clamp(static_cast<int>(std::lround(inner * (std::isfinite(share) ? share : 0))), 0, inner);
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(inner - full), '-') + "]";
}

void sensors(Screen& screen, const DaemonStatus& status) {
  std::size_t longest = 4;
  for (const SensorStatus& sensor : status.capture.sensors) longest = std::max(longest, sensor.name.size());
  longest = std::min<std::size_t>(longest, 12);
  for (const SensorStatus& sensor : status.capture.sensors) {
    const auto found = status.sensors.find(sensor.name);
    const SensorHealth health = found == status.sensors.end() ? SensorHealth() : found->second;
    const bool well = health.supervision == "running" && !sensor.silent;
    const char* colour = !well ? red : sensor.sees_board ? green : yellow;
    std::string name = sensor.name.substr(0, longest);
    name.resize(longest, ' ');
    std::string text = name + formatted(" %4.1f Hz ", std::isfinite(sensor.rate) ? sensor.rate : 0.0) +
                       sensor_word(sensor, health);
    if (!health.problem.empty()) text += ": " + health.problem;
    // The light, one column that is three bytes.
    screen.add_raw(std::string(colour) + "\u25cf " + plain + cut(text, screen.width() - 2));
  }
}

void answer(Screen& screen, const CaptureStatus& capture) {
  const auto one = [&](const char* label, const std::optional<double>& sigma, double target,
                       const char* unit) {
    const bool reached = sigma && *sigma <= target;
    const std::string number = sigma ? formatted("%6.2f", 1e3 * *sigma) : "     -";
    const std::string text = formatted("%s %s of %.3g %-4s ", label, number.c_str(), 1e3 * target, unit);
    screen.add(reached ? green : "", text + bar(sigma && *sigma > 0 ? target / *sigma : 0,
                                                screen.width() - static_cast<int>(text.size())));
  };
  one("sigma", capture.sigma_translation, capture.target_translation, "mm");
  one("     ", capture.sigma_rotation, capture.target_rotation, "mrad");
}

void all_but_picture(Screen& screen, const WatchView& view) {
  const CaptureStatus& capture = view.status.capture;
  banner(screen, capture);
  screen.paragraph("", "", capture.reason, 2);
  screen.add("", "still " + bar(capture.progress, screen.width() - 6));
  sensors(screen, view.status);
  answer(screen, capture);
  screen.add(
      "", formatted("views %d, used %d, %s%s", capture.views, capture.used,
                    capture.automatic ? "automatic" : "on request", view.status.solving ? ", solving" : ""));
  if (capture.next) screen.paragraph(green, "next ", capture.next->words, 3);
  if (!capture.last_event.empty()) screen.paragraph(dim, "last ", capture.last_event, 2);
  if (!view.status.storage_problem.empty()) screen.paragraph(red, "disk ", view.status.storage_problem, 3);
  if (!view.status.recording.empty()) screen.paragraph(yellow, "rec  ", view.status.recording, 1);
  if (!view.note.empty()) screen.paragraph(yellow, "> ", view.note, 2);
  screen.add(dim, "c capture d drop s solve a auto p pic q");
}

}  // namespace

std::vector<std::string> wrapped(const std::string& text, int width) {
  const auto most = static_cast<std::size_t>(std::max(1, width));
  std::vector<std::string> lines;
  std::string line;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t end = text.find_first_of(" \n", begin);
    if (end == std::string::npos) end = text.size();
    std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (!line.empty() && line.size() + 1 + word.size() > most) lines.push_back(std::exchange(line, {}));
    for (; word.size() > most; word.erase(0, most)) lines.push_back(word.substr(0, most));
    if (!word.empty()) line += (line.empty() ? "" : " ") + word;
  }
  if (!line.empty()) lines.push_back(line);
  return lines;
}

int picture_rows(const WatchView& view, int width, int height) {
  Screen screen(width, height);
  all_but_picture(screen, view);
  return screen.left() - 1;  // its title
}

std::vector<std::string> watch_lines(const WatchView& view, int width, int height) {
  Screen screen(width, height);
  all_but_picture(screen, view);
  if (!view.picture.empty() && screen.left() > 2) {
    screen.add(dim, view.picture_of);
    for (const std::string& line : view.picture) screen.add_raw(line);
  }
  return screen.take();
}

}  // namespace ca2
