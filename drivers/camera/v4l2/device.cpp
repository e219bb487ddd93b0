#include "drivers/camera/v4l2/device.h"

#include <fcntl.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <cstring>
#include <map>

namespace ca2 {
namespace {

namespace fs = std::filesystem;

const fs::path links[] = {"/dev/v4l/by-id", "/dev/v4l/by-path"};

/// A driver fills fixed arrays, and not always up to a zero.
template <std::size_t Size>
std::string text_of(const __u8 (&field)[Size]) {
  const char* begin = reinterpret_cast<const char*>(field);
  return {begin, ::strnlen(begin, Size)};
}

}  // namespace

Error v4l2_error(const std::string& node, const std::string& doing, int code) {
  const std::string what = "cannot " + doing + ": " + std::strerror(code);
  switch (code) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {ErrorCode::unavailable, node, what,
              "is the camera plugged in? `ca2 sensors` lists those that are"};
    case EACCES:
    case EPERM:
      return {ErrorCode::no_permission, node, what, "add the user to the group 'video'"};
    case EBUSY:
      return {ErrorCode::unavailable, node, what, "another program uses the camera: stop it first"};
    case ENOSPC:
      return {ErrorCode::unavailable, node, what,
              "the USB bus has no bandwidth left: choose a lower frame_rate, a smaller size or MJPG, or "
              "another bus"};
    default:
      return {ErrorCode::unavailable, node, what};
  }
}

Result<V4l2Device> V4l2Device::open(const fs::path& node) {
  V4l2Device device;
  device.node_ = node.string();
  device.fd_ = UniqueFd(::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (!device.fd_.valid()) return fail(v4l2_error(device.node_, "open it", errno));
  if (const int code = device.call(VIDIOC_QUERYCAP, &device.capability_); code == ENOTTY || code == EINVAL) {
    return fail(ErrorCode::config, device.node_, "is no V4L2 device");
  } else if (code != 0) {
    return fail(v4l2_error(device.node_, "ask what it is", code));
  }
  // One driver may have several nodes: this one's abilities count, where they are told.
  const v4l2_capability& all = device.capability_;
  const __u32 able = all.capabilities & V4L2_CAP_DEVICE_CAPS ? all.device_caps : all.capabilities;
  if (!(able & V4L2_CAP_VIDEO_CAPTURE) || !(able & V4L2_CAP_STREAMING)) {
    return fail(ErrorCode::config, device.node_, "is no camera: it does not capture and stream pictures",
                "cameras have further nodes for metadata; `ca2 sensors` lists the right ones");
  }
  return device;
}

int V4l2Device::call(unsigned long request, void* argument) const {
  for (;;) {
    if (::ioctl(fd_.get(), request, argument) == 0) return 0;
    if (errno != EINTR) return errno;
  }
}

std::string V4l2Device::description() const {
  const std::string bus = text_of(capability_.bus_info);
  return text_of(capability_.card) + (bus.empty() ? "" : " (" + bus + ")");
}

std::vector<V4l2Node> list_v4l2_nodes() {
  std::map<fs::path, std::string> names;  // stable ones, by node
  std::error_code code;
  for (const fs::path& directory : links) {
    std::vector<fs::path> entries;
    for (fs::directory_iterator i(directory, code); !code && i != fs::directory_iterator();
         i.increment(code)) {
      entries.push_back(i->path());
    }
    std::sort(entries.begin(), entries.end());
    for (const fs::path& link : entries) {
      const fs::path node = fs::canonical(link, code);
      if (!code) names.emplace(node, link.filename().string());
    }
  }
  std::vector<V4l2Node> nodes;
  for (fs::directory_iterator i("/sys/class/video4linux", code); !code && i != fs::directory_iterator();
       i.increment(code)) {
    const std::string name = i->path().filename().string();
    if (!name.starts_with("video")) continue;
    const fs::path node = "/dev/" + name;
    const auto stable = names.find(node);
    nodes.push_back({node, stable == names.end() ? node.string() : stable->second});
  }
  const auto number = [](const V4l2Node& node) {
    const std::string name = node.node.filename().string();
    return std::pair(name.size(), name);  // video9 before video10
  };
  std::sort(nodes.begin(), nodes.end(),
            [&](const V4l2Node& a, const V4l2Node& b) { return number(a) < number(b); });
  return nodes;
}

fs::path v4l2_node_of(const std::string& id) {
  if (id.starts_with('/')) return id;
  std::error_code code;
  for (const fs::path& directory : links) {
    if (fs::exists(directory / id, code)) return directory / id;
  }
  return links[0] / id;
}

}  // namespace ca2
