#include "daemon/publish/lcm_publisher.h"

#include <ca2/extrinsics_v1_t.hpp>
#include <ca2/preview_v1_t.hpp>
#include <ca2/status_v1_t.hpp>
#include <ca2/view_v1_t.hpp>

#include "daemon/log.h"
#include "messages/channels.h"
#include "messages/extrinsics.h"

namespace ca2 {

template <class Message>
void LcmPublisher::publish(const char* channel, const Message& message) {
  const bool failed = lcm_.publish(channel, &message) != 0;
  if (failed && !failed_) {
    log::warning("lcm", std::string(channel) + " could not be sent; is there a route for multicast?");
  }
  failed_ = failed;
}

void LcmPublisher::status(const DaemonStatus& status) {
  publish(channel::status, to_lcm(status));
}

void LcmPublisher::view(const std::string& session, int id, bool stored, int views, std::int64_t time) {
  view_v1_t message;
  message.utime = time / 1000;
  message.session = session;
  message.id = id;
  message.change = stored ? "stored" : "dropped";
  message.views = views;
  publish(channel::view, message);
}

void LcmPublisher::extrinsics(const Calibration& calibration, const std::string& session, std::int64_t time) {
  publish(channel::extrinsics, to_lcm(calibration, session, time));
}

void LcmPublisher::preview(const std::string& sensor, const Preview& preview) {
  preview_v1_t message;
  message.utime = preview.time / 1000;
  message.sensor = sensor;
  message.format = "jpeg";
  message.width = preview.width;
  message.height = preview.height;
  message.sees_board = preview.sees_board;
  message.data.assign(preview.jpeg.begin(), preview.jpeg.end());
  message.size = static_cast<std::int32_t>(message.data.size());
  publish(channel::preview, message);
}

}  // namespace ca2
