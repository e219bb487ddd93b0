/// @file A V4L2 capture device: its node, its answers, its errors in words.
#pragma once

#include <linux/videodev2.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <vector>

#include "core/types/result.h"
#include "drivers/net/unique_fd.h"

namespace ca2 {

class V4l2Device {
 public:
  /// A node that captures and streams; ErrorCode::unavailable, no_permission, or config for other nodes.
  static Result<V4l2Device> open(const std::filesystem::path& node);

  /// ioctl, again after signals. 0 or the errno.
  int call(unsigned long request, void* argument) const;
  int fd() const { return fd_.get(); }
  const std::string& node() const { return node_; }
  /// "Logitech BRIO (usb-0000:00:14.0-3)".
  std::string description() const;

 private:
  UniqueFd fd_;
  std::string node_;
  v4l2_capability capability_{};
};

/// What an errno of a device means, and what to do. `doing` completes "cannot ...".
Error v4l2_error(const std::string& node, const std::string& doing, int code);

/// A camera's node and the name that stays when it is plugged in again.
struct V4l2Node {
  std::filesystem::path node;  ///< /dev/video0
  std::string id;              ///< name of a link in /dev/v4l/by-id or by-path; else the node's path
};

/// The nodes that the system lists, capturing or not, by number. Two equal cameras without serial numbers
/// share a by-id link: they are told apart by the port (by-path).
std::vector<V4l2Node> list_v4l2_nodes();

/// The node of an id: a path, or the name of a link in /dev/v4l.
std::filesystem::path v4l2_node_of(const std::string& id);

}  // namespace ca2
