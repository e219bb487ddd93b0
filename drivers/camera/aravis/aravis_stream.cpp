#include "drivers/camera/aravis/aravis_stream.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <limits>
#include <utility>

#include "core/io/files.h"
#include "core/types/text.h"
#include "drivers/camera/aravis/features.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int wanted_receive_buffer = 10 << 20;  // bytes: some pictures, for while nobody reads
constexpr guint ethernet_packet = 1500;
// Aravis goes round all buffers, so that each takes its room in memory: as many as bridge 100 ms at 30 Hz,
// and more only where the reader turns out to be later than that.
constexpr int first_buffers = 4;
// Of a reader in time: one is being filled, one has just been. What is free beyond two is given back, one
// after the other, when it was for so many pictures.
constexpr gint usually_free = 2;
constexpr int until_given_back = 300;

/// Negotiates or sets, and says what is to be mended.
Result<std::string> settle_packet_size(ArvGvDevice* device, int wanted) {
  GErrorHolder error;
  if (wanted > 0) {
    arv_gv_device_set_packet_size(device, wanted, error.out());
    if (error) return fail(ErrorCode::config, "packet_size", error.text());
    arv_gv_device_set_packet_size_adjustment(device, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    return std::string();
  }
  const guint size = arv_gv_device_auto_packet_size(device, error.out());
  if (error) return fail(ErrorCode::unavailable, "packet_size", "no test packet arrives: " + error.text());
  // Known now; the stream need not try again.
  arv_gv_device_set_packet_size_adjustment(device, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
  if (size > ethernet_packet) return std::string();
  return formatted(
      "packets of %u bytes: jumbo frames (MTU 9000 at the host, the switches and the camera) cost less",
      size);
}

/// The kernel grants no larger receive buffers than this; 0: not known.
int receive_buffer_limit() {
  const auto text = read_text("/proc/sys/net/core/rmem_max");
  int bytes = 0;
  if (text) std::from_chars(text->data(), text->data() + text->size(), bytes);
  return bytes;
}

}  // namespace

struct AravisStream::Signal {
  UniqueFd fd{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
  std::atomic<bool> control_lost{false};
  std::atomic<Clock::time_point> last_leader{Clock::time_point()};

  void raise() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written =
        ::write(fd.get(), &one, sizeof one);  // fails when full: readable then
  }
  void clear() const {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got =
        ::read(fd.get(), &count, sizeof count);  // fails when nothing was raised
  }
};

AravisStream::AravisStream() : signal_(std::make_shared<Signal>()) {}

AravisStream::~AravisStream() {
  if (control_lost_handler_) g_signal_handler_disconnect(device_, control_lost_handler_);
}

Result<std::unique_ptr<AravisStream>> AravisStream::open(ArvDevice* device, const StreamOptions& options) {
  std::unique_ptr<AravisStream> out(new AravisStream);
  if (!out->signal_->fd.valid()) return fail(ErrorCode::io, "eventfd", "no descriptor left");
  const bool network = ARV_IS_GV_DEVICE(device);
  if (network) {
    auto warning = settle_packet_size(ARV_GV_DEVICE(device), options.packet_size);
    if (!warning) return fail(warning.error());
    if (!warning->empty()) out->warnings_.push_back(std::move(*warning));
    if (const int limit = receive_buffer_limit(); limit > 0 && limit < wanted_receive_buffer) {
      out->warnings_.push_back(
          formatted("receive buffers are limited to %d bytes: net.core.rmem_max should be %d", limit,
                    wanted_receive_buffer));
    }
  }
  const auto payload = Features(device).number("PayloadSize");
  if (!payload || *payload < 1 || *payload > 1e9) {
    return fail(ErrorCode::unavailable, "PayloadSize", "the camera does not say how large its pictures are");
  }
  GErrorHolder error;
  const auto done = [](void* data, ArvStreamCallbackType type, ArvBuffer*) {
    auto& signal = *static_cast<Signal*>(data);
    if (type == ARV_STREAM_CALLBACK_TYPE_START_BUFFER) signal.last_leader = Clock::now();
    if (type == ARV_STREAM_CALLBACK_TYPE_BUFFER_DONE) signal.raise();
  };
  out->stream_.reset(arv_device_create_stream(device, done, out->signal_.get(), error.out()));
  if (!out->stream_) return fail(ErrorCode::unavailable, "stream", "cannot be opened: " + error.text());
  if (network) {
    g_object_set(out->stream_.get(), "packet-resend",
                 options.resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
                 "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size",
                 wanted_receive_buffer, nullptr);
  }
  out->picture_bytes_ = static_cast<std::size_t>(*payload);
  out->most_buffers_ = options.buffers;
  while (out->buffers_ < std::min(first_buffers, options.buffers)) out->add_buffer();
  // The device's heartbeat thread may be in the handler while the stream ends: nobody waits for it, so it
  // holds what it touches.
  using Shared = std::shared_ptr<Signal>;
  const auto lost = [](ArvDevice*, gpointer data) {
    Signal& signal = **static_cast<Shared*>(data);
    signal.control_lost = true;
    signal.raise();
  };
  const auto forget = [](gpointer data, GClosure*) { delete static_cast<Shared*>(data); };
  out->device_ = device;
  out->control_lost_handler_ = g_signal_connect_data(
      device, "control-lost", G_CALLBACK(+static_cast<void (*)(ArvDevice*, gpointer)>(lost)),
      new Shared(out->signal_), forget, static_cast<GConnectFlags>(0));
  return out;
}

void AravisStream::add_buffer() {
  arv_stream_push_buffer(stream_.get(), arv_buffer_new(picture_bytes_, nullptr));
  ++buffers_;
}

AravisStream::Buffer AravisStream::pop() {
  signal_->clear();
  gint empty = 0, filled = 0;
  arv_stream_get_n_buffers(stream_.get(), &empty, &filled);
  // We were late by a picture: the next ones shall find room even if we are later than that.
  if (empty < usually_free && buffers_ < most_buffers_) add_buffer();
  ArvBuffer* const buffer = arv_stream_try_pop_buffer(stream_.get());
  return {buffer, Requeue{buffer && is_surplus(empty) ? nullptr : stream_.get()}};
}

/// Is one buffer more than enough, as of the pictures lately?
bool AravisStream::is_surplus(int empty) {
  fewest_empty_ = std::min(fewest_empty_, empty);
  if (++pictures_ < until_given_back) return false;
  pictures_ = 0;
  const int fewest = std::exchange(fewest_empty_, std::numeric_limits<int>::max());
  if (fewest <= usually_free || buffers_ <= first_buffers) return false;
  --buffers_;
  return true;
}

int AravisStream::ready_fd() const {
  return signal_->fd.get();
}

std::chrono::steady_clock::time_point AravisStream::last_leader() const {
  return signal_->last_leader;
}

bool AravisStream::control_lost() const {
  return signal_->control_lost;
}

AravisStream::Statistics AravisStream::statistics() const {
  guint64 completed = 0, failures = 0, underruns = 0, resent = 0, missing = 0;
  arv_stream_get_statistics(stream_.get(), &completed, &failures, &underruns);
  if (ARV_IS_GV_STREAM(stream_.get())) {
    arv_gv_stream_get_statistics(ARV_GV_STREAM(stream_.get()), &resent, &missing);
  }
  return {underruns, resent};
}

}  // namespace ca2
