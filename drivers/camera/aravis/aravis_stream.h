/// @file A camera's stream of buffers.
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/camera/aravis/glib.h"

namespace ca2 {

struct StreamOptions {
  int packet_size = 0;  ///< bytes; 0: the largest that arrives
  int buffers = 16;     ///< at most
  bool resend = true;
};

/// Receives from its construction on; the camera's acquisition is started and stopped by others.
class AravisStream {
 public:
  /// Negotiates the packets' size and queues the buffers.
  static Result<std::unique_ptr<AravisStream>> open(ArvDevice* device, const StreamOptions& options);
  AravisStream(const AravisStream&) = delete;
  AravisStream& operator=(const AravisStream&) = delete;
  ~AravisStream();

  /// Gives a buffer back to the stream; without one, to the system.
  struct Requeue {
    ArvStream* stream = nullptr;
    void operator()(ArvBuffer* buffer) const {
      stream ? arv_stream_push_buffer(stream, buffer) : g_object_unref(buffer);
    }
  };
  using Buffer = std::unique_ptr<ArvBuffer, Requeue>;

  /// The oldest buffer that is done, whole or not; none when there is none.
  Buffer pop();
  /// When a picture's first packet came last (steady clock); never: the clock's epoch.
  std::chrono::steady_clock::time_point last_leader() const;
  /// Readable when pop() should be tried, or control_lost() looked at.
  int ready_fd() const;
  bool control_lost() const;

  struct Statistics {
    std::uint64_t underruns = 0;  ///< that found no buffer: packets over Ethernet, pictures over USB
    std::uint64_t resent = 0;     ///< packets
  };
  Statistics statistics() const;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  /// What Aravis's own threads touch.
  struct Signal;
  AravisStream();
  void add_buffer();
  bool is_surplus(int empty);

  std::shared_ptr<Signal> signal_;
  ArvDevice* device_ = nullptr;
  gulong control_lost_handler_ = 0;
  GObjectPtr<ArvStream> stream_;
  std::size_t picture_bytes_ = 0;
  int buffers_ = 0, most_buffers_ = 0;
  int fewest_empty_ = std::numeric_limits<int>::max(), pictures_ = 0;  ///< since it was judged last
  std::vector<std::string> warnings_;
};

}  // namespace ca2
