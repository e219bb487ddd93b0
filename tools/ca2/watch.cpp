/// @file `ca2 watch`: the daemon on a full screen, for the hand that holds the board.
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/io/base64.h"
#include "core/io/jpeg.h"
#include "core/types/text.h"
#include "messages/control/client.h"
#include "messages/error_json.h"
#include "tools/ca2/command.h"
#include "tools/ca2/daemon_link.h"
#include "tools/ca2/follow_status.h"
#include "tools/ca2/interrupt.h"
#include "tools/ca2/picture_text.h"
#include "tools/ca2/terminal.h"
#include "tools/ca2/watch_screen.h"

namespace ca2 {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// A picture is asked for when the one before is here, and not more than a quarter of the time is spent on
// them.
constexpr milliseconds picture_pause{1000};
constexpr int picture_share = 4;
constexpr milliseconds patience{100};

bool true_colour() {
  const char* terminal = std::getenv("COLORTERM");
  const std::string word = terminal ? terminal : "";
  return word == "truecolor" || word == "24bit";
}

class Watch {
 public:
  explicit Watch(control::Client client) : client_(std::move(client)) {}

  Result<int> run() {
    if (const auto id = client_.send("subscribe", json::object()); !id) return fail(id.error());
    const Interrupt interrupt;
    Terminal terminal;
    while (!Interrupt::raised() && !quit_) {
      const Result<json> message = client_.next(milliseconds(0));
      if (!message) return fail(message.error());
      if (!message->is_null()) {
        take(*message, terminal);
        continue;  // everything that came, before it is shown
      }
      for (char key = Terminal::key(); key != 0; key = Terminal::key()) press(key);
      ask_for_picture();
      const Terminal::Size size = Terminal::size();
      terminal.show(watch_lines(view_, size.columns, size.rows));
      pollfd wait[2] = {{STDIN_FILENO, POLLIN, 0}, {client_.descriptor(), POLLIN, 0}};
      ::poll(wait, 2, static_cast<int>(patience.count()));
    }
    return 0;
  }

 private:
  void take(const json& message, Terminal& terminal) {
    const std::string type = message.value("type", "");
    if (type == "status") {
      Result<DaemonStatus> status = status_from_json(message.at("status"));
      if (status) view_.status = std::move(*status);
    } else if (type == "event") {
      if (message.value("kind", "") == "captured") terminal.bell();
    } else if (type == "reply") {
      const Result<json> reply = reply_from_json(message);
      const auto id = message.value("id", std::int64_t{0});
      if (id == picture_id_) {
        take_picture(reply);
      } else if (id == command_id_) {
        view_.note = reply ? done_ : reply.error().text();
      }
    }
  }

  void take_picture(const Result<json>& reply) {
    picture_id_ = 0;
    next_picture_ = Clock::now() + picture_pause + picture_share * (Clock::now() - asked_);
    view_.picture_of = sensor();
    view_.picture.clear();
    if (!reply) {
      view_.picture = {reply.error().text()};
      return;
    }
    const auto bytes = from_base64(reply->value("jpeg", ""));
    const Result<Image> image = decode_jpeg(bytes.value_or(""), "preview");
    const Terminal::Size size = Terminal::size();
    const int rows = picture_rows(view_, size.columns, size.rows);
    if (image && rows > 0) view_.picture = picture_text(*image, size.columns, rows, true_colour());
  }

  std::string sensor() const {
    const auto& sensors = view_.status.capture.sensors;
    return sensors.empty() ? "" : sensors[turn_ % sensors.size()].name;
  }

  void ask_for_picture() {
    const Terminal::Size size = Terminal::size();
    const bool room = picture_rows(view_, size.columns, size.rows) >= 4;
    if (picture_id_ != 0 || sensor().empty() || !room || Clock::now() < next_picture_) return;
    asked_ = Clock::now();
    // A half block is two pixels high and one wide: more than the columns would be lost on the way.
    const int width = std::clamp(size.columns, 16, 320);
    picture_id_ = client_.send("preview", {{"sensor", sensor()}, {"width", width}}).value_or(0);
  }

  void send(const std::string& command, const json& arguments, const std::string& done) {
    done_ = done;
    view_.note = command + " ...";
    command_id_ = client_.send(command, arguments).value_or(0);
  }

  void press(char key) {
    const bool confirmed = std::exchange(drop_asked_, false) && (key == 'y' || key == 'd');
    const CaptureStatus& capture = view_.status.capture;
    if (confirmed) return send("drop_last", json::object(), "dropped");
    switch (key) {
      case 'q':
        quit_ = true;
        return;
      case 'c':
        return send("capture", {{"now", true}}, "captured");
      case 'd':
        drop_asked_ = capture.views > 0;
        view_.note = drop_asked_ ? "drop the newest view? press d again" : "there are no views";
        return;
      case 's':
        return send("solve", json::object(), "solved");
      case 'a':
        return send("auto", {{"on", !capture.automatic}}, capture.automatic ? "on request" : "automatic");
      case 'p':
        ++turn_;
        next_picture_ = {};
        return;
      default:
        view_.note.clear();
    }
  }

  control::Client client_;
  WatchView view_;
  bool quit_ = false, drop_asked_ = false;
  std::size_t turn_ = 0;  ///< of the sensor that is shown
  std::int64_t picture_id_ = 0, command_id_ = 0;
  std::string done_;  ///< what to say when the command succeeds
  Clock::time_point asked_, next_picture_;
};

Result<int> run(const DaemonAddress& address) {
  if (!Terminal::available()) return follow_status(address, false);
  Result<control::Client> client = control::Client::connect(address.socket);
  if (!client) return fail(client.error());
  return Watch(std::move(*client)).run();
}

}  // namespace

CommandBody setup_watch(CLI::App& app) {
  auto address = std::make_shared<DaemonAddress>();
  add_daemon_options(app, *address);
  app.footer(
      "For a terminal of 40 columns and more, a phone's over ssh: state, sensors, stillness, sigma against "
      "target,\n"
      "the next pose, a picture. Keys: c capture now, d d drop the newest view, s solve, a automatic on or "
      "off,\n"
      "p next sensor's picture, q quit. It rings when a view is captured. In a pipe: a line per change.");
  return [address] { return run(*address); };
}

}  // namespace ca2
