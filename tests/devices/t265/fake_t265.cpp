/// A T265 on raw_gadget, written from the description of its protocol, not from the driver:
///   fake_t265 loader|camera SPEED FIRMWARE [FAULT[=NUMBER]]
/// SPEED is `high` or `super`: the camera's, USB 2 or 3. The loader takes as many bytes as the file FIRMWARE
/// has and comes back as the camera when they are the same, as the loader again when not. The camera comes
/// back as the loader when it is reset, without its fault. Faults:
///   silent       answers nothing                   hangs=N      answers and sends nothing after N pairs of
///   pictures stammers     damaged answers                   noise        damaged messages between the
///   pictures uncalibrated has lost its calibration          nonsense     calibration numbers that are none
///   busy         was left streaming                stops=N      stops by itself after N pairs
///   skips        loses every third pair            empty=N      an empty message after N pairs
///   limps        the right imager loses every third picture
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "tests/devices/t265/fake_t265.h"
#include "tests/devices/t265/raw_gadget.h"

namespace ca2::test {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds(auto duration) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

std::int64_t utc() {
  return nanoseconds(std::chrono::system_clock::now().time_since_epoch());
}

/// ns: 50 ppm slow, and it began some time ago.
std::uint64_t device_time() {
  const double host = static_cast<double>(nanoseconds(Clock::now().time_since_epoch()));
  return static_cast<std::uint64_t>(5e9 + host * (1 - 50e-6));
}

/// The same moment on both clocks: read again when this thread was put to sleep in between.
struct Moment {
  Moment() {
    Clock::time_point begin;
    do {
      begin = Clock::now();
      device = device_time();
      host = utc();
    } while (Clock::now() - begin > std::chrono::microseconds(200));
  }
  std::uint64_t device;
  std::int64_t host;
};

class Message {
 public:
  explicit Message(std::uint16_t id) { put<std::uint32_t>(0).put(id); }

  template <class T>
  Message& put(T value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof value);
    return *this;
  }
  Message& put(const Bytes& bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return *this;
  }
  Bytes& bytes() {
    const auto size = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &size, 4);
    return bytes_;
  }

 private:
  Bytes bytes_;
};

/// This program again as another device: the old one is unplugged, and so are its threads.
[[noreturn]] void become(const char* kind, char** arguments, bool keep_fault) {
  std::this_thread::sleep_for(milliseconds(50));
  char* next[] = {
      arguments[0], const_cast<char*>(kind), arguments[2], arguments[3], keep_fault ? arguments[4] : nullptr,
      nullptr};
  ::execv("/proc/self/exe", next);
  std::perror("execv");
  std::_Exit(1);
}

class Camera {
 public:
  Camera(RawGadget& gadget, std::string fault) : gadget_(gadget) {
    const std::size_t equals = fault.find('=');
    if (equals != std::string::npos)
      after_ = static_cast<std::uint32_t>(std::stoul(fault.substr(equals + 1)));
    fault_ = fault.substr(0, equals);
    streaming_ = fault_ == "busy";
  }

  void start_threads() {
    for (const auto work : {&Camera::answer, &Camera::send_pictures, &Camera::send_events}) {
      std::thread([this, work] {
        try {
          (this->*work)();
        } catch (const std::exception& error) {
          std::fprintf(stderr, "fake_t265: %s\n", error.what());
          std::_Exit(1);
        }
      }).detach();
    }
  }

 private:
  bool faulty(const char* name) const { return fault_ == name; }

  void answer() {
    for (;;) {
      const Bytes request = gadget_.read(0x02, 4096);
      if (request.size() < 6 || faulty("silent")) continue;
      while (hanging_) std::this_thread::sleep_for(milliseconds(100));
      Bytes response = response_to(request);
      if (faulty("stammers")) {
        for (std::uint8_t& byte : response) byte = static_cast<std::uint8_t>(byte ^ random_() << 1);
        response.resize(response.size() - random_() % 5);
      }
      gadget_.write(0x82, response);
    }
  }

  Bytes response_to(const Bytes& request) {
    const auto id = static_cast<std::uint16_t>(request[4] | request[5] << 8);
    Message ok(id), refused(id);
    ok.put<std::uint16_t>(0);
    const auto refuse = [&](std::uint16_t status) { return refused.put(status).bytes(); };
    // Each request has one length.
    const auto is = [&](std::size_t body) { return request.size() == 6 + body; };
    switch (id) {
      case 0x0001:
        return is(0) ? device_info(ok) : refuse(2);
      case 0x0002:
        return is(0) ? ok.put(device_time()).bytes() : refuse(2);
      case 0x0004:
        return is(0) ? streams(ok) : refuse(2);
      case 0x0005: {
        const std::lock_guard lock(mutex_);
        if (streaming_) return refuse(8);
        // Both fisheyes to the host, or refused.
        if (!is(2 + 2 * 12) || request[6] != 2 || request[8] != 0x03 || request[20] != 0x23) return refuse(3);
        if (request[15] != 1 || request[27] != 1) return refuse(3);
        chosen_ = true;
        return ok.bytes();
      }
      case 0x0006:
        return is(1) ? intrinsics(ok, request[6] >> 5) : refuse(2);
      case 0x0008:
        return is(1) ? extrinsics(ok, request[6] >> 5) : refuse(2);
      case 0x0012: {
        const std::lock_guard lock(mutex_);
        if (!chosen_ || streaming_) return refuse(streaming_ ? 8 : 3);
        streaming_ = true;
        pairs_ = 0;
        changed_.notify_all();
        return ok.bytes();
      }
      case 0x0013: {
        const std::lock_guard lock(mutex_);
        if (streaming_) stop();
        return ok.bytes();
      }
      case 0x0016: {
        const std::lock_guard lock(mutex_);
        if (streaming_) return refuse(8);
        automatic_ = request[6] == 3;
        return ok.bytes();
      }
      case 0x0017: {
        const std::lock_guard lock(mutex_);
        if (automatic_) return refuse(5);
        if (!is(2 + 2 * 12) || request[6] != 2) return refuse(2);
        std::memcpy(&exposure_, &request[12], 4);
        std::memcpy(&gain_, &request[16], 4);
        return ok.bytes();
      }
      case 0x000c:
      case 0x0025:
      case 0x1006:
        return is(2) ? ok.bytes() : refuse(2);
      default:
        return refuse(1);
    }
  }

  Bytes device_info(Message& out) {
    const Bytes versions{0x11, 1, 0, 2, 0, 0, 2, 0};
    out.put(versions).put<std::uint32_t>(951).put<std::uint32_t>(0);
    out.put<std::uint32_t>(faulty("uncalibrated") ? 1000 : 0).put<std::uint32_t>(0);
    for (std::size_t i = 0; i < 12; i += 2) {
      out.put(static_cast<std::uint8_t>(std::stoi(std::string(t265_serial + i, 2), nullptr, 16)));
    }
    return out.put(Bytes(2 + 8 + 4 + 2)).bytes();
  }

  Bytes streams(Message& out) {
    out.put<std::uint16_t>(4).put<std::uint16_t>(0);
    const auto entry = [&](std::uint8_t sensor, int width, int height, int format, int rate) {
      out.put(sensor).put<std::uint8_t>(0);
      out.put(static_cast<std::uint16_t>(width)).put(static_cast<std::uint16_t>(height));
      out.put(static_cast<std::uint8_t>(format)).put<std::uint8_t>(0);
      out.put(static_cast<std::uint16_t>(width)).put(static_cast<std::uint16_t>(rate));
    };
    entry(0x04, 0, 0, 0, 200);
    entry(0x23, t265_width, t265_height, 9, 30);
    entry(0x03, t265_width, t265_height, 9, 30);
    entry(0x05, 0, 0, 0, 62);
    return out.bytes();
  }

  Bytes intrinsics(Message& out, int imager) {
    const FakeFisheye& fisheye = t265_fisheyes[imager & 1];
    out.put<std::uint32_t>(t265_width).put<std::uint32_t>(t265_height);
    out.put(fisheye.cx).put(fisheye.cy).put(faulty("nonsense") ? -1.0f : fisheye.fx).put(fisheye.fy);
    out.put<std::uint32_t>(4);
    for (const float k : fisheye.k) out.put(k);
    return out.put(0.0f).bytes();
  }

  Bytes extrinsics(Message& out, int imager) {
    const FakeFisheye& fisheye = t265_fisheyes[imager & 1];
    for (const float r : fisheye.R) out.put(r);
    for (const float t : fisheye.t) out.put(t);
    return out.put<std::uint8_t>(0x0a).bytes();
  }

  /// Under the mutex. Everything is forgotten, and the host is told.
  void stop() {
    streaming_ = chosen_ = false;
    automatic_ = true;
    say_stopped_ = true;
    changed_.notify_all();
  }

  void send_pictures() {
    Bytes table(t265_width * t265_height);
    for (int y = 0, i = 0; y < t265_height; ++y) {
      for (int x = 0; x < t265_width; ++x, ++i) table[static_cast<std::size_t>(i)] = t265_pixel(0, 0, x, y);
    }
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return streaming_; });
      const std::uint32_t number = pairs_++;
      if (after_ > 0 && number == after_) {
        hanging_ = faulty("hangs");
        if (faulty("stops")) stop();
        if (faulty("empty")) {
          lock.unlock();
          gadget_.write(0x81, {});
          lock.lock();
        }
      }
      if (hanging_ || !streaming_) {
        lock.unlock();
        while (hanging_) std::this_thread::sleep_for(milliseconds(100));
        continue;
      }
      const std::uint32_t exposure = exposure_;
      const float gain = gain_;
      lock.unlock();
      if (faulty("skips") && number % 3 == 2) continue;
      const Moment middle;
      // What a real one needs for exposure, readout and coding.
      std::this_thread::sleep_for(milliseconds(15));
      for (const int imager : {0, 1}) {
        if (faulty("limps") && imager == 1 && number % 3 == 2) continue;
        Message out(0x0011);
        out.put<std::uint8_t>(imager == 0 ? 0x03 : 0x23)
            .put<std::uint8_t>(0)
            .put(middle.device)
            .put(device_time());
        out.put(number).put<std::uint32_t>(8).put(exposure).put(gain);
        out.put(static_cast<std::uint32_t>(table.size()));
        const std::uint8_t shift = t265_pixel(imager, number, 0, 0);
        Bytes pixels(table);
        for (std::uint8_t& pixel : pixels) pixel = static_cast<std::uint8_t>(pixel + shift);
        std::memcpy(pixels.data(), &middle.host, sizeof middle.host);
        if (faulty("noise")) gadget_.write(0x81, noise(Message(out).put(pixels).bytes()));
        gadget_.write(0x81, out.put(pixels).bytes());
      }
    }
  }

  /// A picture's message with some of it wrong; a short transfer, so that the next message begins afresh.
  Bytes noise(Bytes message) {
    switch (random_() % 5) {
      case 0:
        message.resize(1 + random_() % 3000);
        break;
      case 1:
        message[random_() % 6] ^= 0x55;
        break;
      case 2:
        message[40] ^= 1;
        break;
      case 3:
        message.resize(44);
        break;
      default:
        message.resize(7 + random_() % 500);
        for (std::uint8_t& byte : message) byte = static_cast<std::uint8_t>(random_());
    }
    if (message.size() % 512 == 0) message.pop_back();
    return message;
  }

  /// Acceleration while streaming, as a real one sends, and what happened.
  void send_events() {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return (streaming_ && !hanging_) || say_stopped_; });
      const bool stopped = std::exchange(say_stopped_, false);
      lock.unlock();
      if (stopped) {
        gadget_.write(0x83, Message(0x0014).put<std::uint16_t>(0x0c).bytes());
        continue;
      }
      Message out(0x0011);
      out.put<std::uint8_t>(0x05).put<std::uint8_t>(0).put(device_time()).put(device_time());
      out.put<std::uint32_t>(0).put<std::uint32_t>(4).put(30.0f).put<std::uint32_t>(12);
      gadget_.write(0x83, out.put(0.1f).put(9.8f).put(0.2f).bytes());
      std::this_thread::sleep_for(milliseconds(50));
    }
  }

  RawGadget& gadget_;
  std::string fault_;
  std::uint32_t after_ = 0;  ///< pairs of pictures
  std::minstd_rand random_{5};
  std::atomic<bool> hanging_{false};

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  bool chosen_ = false, streaming_ = false, automatic_ = true, say_stopped_ = false;
  std::uint32_t pairs_ = 0;
  std::uint32_t exposure_ = 3000;  ///< us
  float gain_ = 1;
};

[[noreturn]] void be_loader(char** arguments) {
  std::ifstream file(arguments[3], std::ios::binary);
  const Bytes firmware{std::istreambuf_iterator<char>(file), {}};
  // A USB 2 device whatever it becomes, and with the same number for all.
  RawGadget gadget({0x03e7, 0x2150, false, "03e72150", {{0x01}, {0x81}}});
  gadget.serve(
      [&] {
        std::thread([&gadget, &firmware, arguments] {
          Bytes got;
          while (got.size() < firmware.size()) {
            const Bytes part =
                gadget.read(0x01, std::min<std::size_t>(1 << 18, firmware.size() - got.size()));
            got.insert(got.end(), part.begin(), part.end());
          }
          std::fprintf(stderr, "fake_t265: %zu bytes of firmware, %s\n", got.size(),
                       got == firmware ? "the right ones" : "WRONG");
          become(got == firmware ? "camera" : "loader", arguments, true);
        }).detach();
      },
      [](std::uint8_t) {});
  std::abort();
}

[[noreturn]] void be_camera(char** arguments) {
  RawGadget gadget({0x8087,
                    0x0b37,
                    std::string(arguments[2]) == "super",
                    t265_serial + std::string("0000"),
                    {{0x81}, {0x01}, {0x02}, {0x82}, {0x83, true}}});
  Camera camera(gadget, arguments[4] ? arguments[4] : "");
  gadget.serve([&] { camera.start_threads(); },
               [&](std::uint8_t request) {
                 if (request == 0x10) become("loader", arguments, false);
               });
  std::abort();
}

}  // namespace
}  // namespace ca2::test

int main(int count, char** arguments) try {
  if (count < 4) return 64;
  const std::string kind = arguments[1];
  if (kind == "loader") ca2::test::be_loader(arguments);
  if (kind == "camera") ca2::test::be_camera(arguments);
  return 64;
} catch (const std::exception& error) {
  std::fprintf(stderr, "fake_t265: %s\n", error.what());
  return 1;
}
