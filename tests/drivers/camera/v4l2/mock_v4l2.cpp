#include "tests/drivers/camera/v4l2/mock_v4l2.h"

#include <linux/videodev2.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace ca2::test {
namespace {

struct Camera {
  MockV4l2Device device;
  std::mutex mutex;
  std::vector<std::pair<std::uint32_t, int>> writes;

  MockControl* find(std::uint32_t id) {
    for (MockControl& control : device.controls) {
      if (control.id == id) return &control;
    }
    return nullptr;
  }
  const MockV4l2Device::Format* format(std::uint32_t fourcc) const {
    for (const auto& format : device.formats) {
      if (format.fourcc == fourcc) return &format;
    }
    return nullptr;
  }

  // Each answers 0 or an errno, as the kernel would.
  int answer(v4l2_capability& out) const {
    std::strncpy(reinterpret_cast<char*>(out.card), device.card.c_str(), sizeof out.card - 1);
    std::strcpy(reinterpret_cast<char*>(out.bus_info), "usb-mock-1");
    out.capabilities = device.abilities | V4L2_CAP_DEVICE_CAPS | V4L2_CAP_META_CAPTURE;
    out.device_caps = device.abilities;
    return 0;
  }
  int answer(v4l2_fmtdesc& out) const {
    if (out.index >= device.formats.size()) return EINVAL;
    out.pixelformat = device.formats[out.index].fourcc;
    return 0;
  }
  int answer(v4l2_frmsizeenum& out) const {
    const auto* found = format(out.pixel_format);
    if (!found || out.index >= found->sizes.size()) return EINVAL;
    out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    out.discrete.width = static_cast<__u32>(found->sizes[out.index].first);
    out.discrete.height = static_cast<__u32>(found->sizes[out.index].second);
    return 0;
  }
  /// As drivers do: what cannot be is changed to what can.
  int answer(v4l2_format& out) const {
    v4l2_pix_format& pixels = out.fmt.pix;
    const auto* found = format(pixels.pixelformat);
    if (!found) found = &device.formats.front();
    pixels.pixelformat = found->fourcc;
    const std::pair<int, int> wanted(static_cast<int>(pixels.width), static_cast<int>(pixels.height));
    const bool there = std::find(found->sizes.begin(), found->sizes.end(), wanted) != found->sizes.end();
    const auto [width, height] = there ? wanted : found->sizes.front();
    pixels.width = static_cast<__u32>(width);
    pixels.height = static_cast<__u32>(height);
    pixels.field = V4L2_FIELD_NONE;
    pixels.bytesperline = 2 * pixels.width;
    return 0;
  }
  int answer(v4l2_streamparm& out) const {
    out.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    out.parm.capture.timeperframe = {1000, static_cast<__u32>(std::lround(1000 * device.rate))};
    return 0;
  }
  int answer(v4l2_query_ext_ctrl& out) const {
    const std::uint32_t after = out.id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
    const MockControl* next = nullptr;
    for (const MockControl& control : device.controls) {
      if (control.id > after && (!next || control.id < next->id)) next = &control;
    }
    if (!next) return EINVAL;
    out = {};
    out.id = next->id;
    out.type = next->type;
    out.minimum = next->least;
    out.maximum = next->most;
    out.step = 1;
    out.elems = 1;
    std::strncpy(out.name, next->name.c_str(), sizeof out.name - 1);
    return 0;
  }
  int answer(v4l2_ext_control& control, bool write) {
    MockControl* found = find(control.id);
    if (!found) return EINVAL;
    if (!write) {
      control.value = found->value;
      return 0;
    }
    if (found->refuses) return found->refuses;
    found->value = control.value;
    writes.emplace_back(found->id, found->value);
    return 0;
  }
};

/// Reads the caller's struct, lets the camera change it and writes it back.
template <class T>
int exchange(Camera& camera, UMockdevIoctlData* argument) {
  UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof(T), nullptr);
  T value;
  std::memcpy(&value, data->data, sizeof value);
  const int code = camera.answer(value);
  if (code == 0) umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&value), sizeof value);
  umockdev_ioctl_data_unref(data);
  return code;
}

/// A list with one control, as the driver asks.
int exchange_control(Camera& camera, UMockdevIoctlData* argument, bool write) {
  UMockdevIoctlData* list = umockdev_ioctl_data_resolve(argument, 0, sizeof(v4l2_ext_controls), nullptr);
  UMockdevIoctlData* one = umockdev_ioctl_data_resolve(list, offsetof(v4l2_ext_controls, controls),
                                                       sizeof(v4l2_ext_control), nullptr);
  v4l2_ext_control control;
  std::memcpy(&control, one->data, sizeof control);
  const int code = camera.answer(control, write);
  if (code == 0) umockdev_ioctl_data_update(one, 0, reinterpret_cast<guint8*>(&control), sizeof control);
  umockdev_ioctl_data_unref(one);
  umockdev_ioctl_data_unref(list);
  return code;
}

int serve(Camera& camera, gulong request, UMockdevIoctlData* argument) {
  if (const auto error = camera.device.errors.find(request); error != camera.device.errors.end())
    return error->second;
  switch (request) {
    case VIDIOC_QUERYCAP:
      return exchange<v4l2_capability>(camera, argument);
    case VIDIOC_ENUM_FMT:
      return exchange<v4l2_fmtdesc>(camera, argument);
    case VIDIOC_ENUM_FRAMESIZES:
      return exchange<v4l2_frmsizeenum>(camera, argument);
    case VIDIOC_G_FMT:
    case VIDIOC_S_FMT:
      return exchange<v4l2_format>(camera, argument);
    case VIDIOC_G_PARM:
    case VIDIOC_S_PARM:
      return exchange<v4l2_streamparm>(camera, argument);
    case VIDIOC_QUERY_EXT_CTRL:
      return exchange<v4l2_query_ext_ctrl>(camera, argument);
    case VIDIOC_G_EXT_CTRLS:
      return exchange_control(camera, argument, false);
    case VIDIOC_S_EXT_CTRLS:
      return exchange_control(camera, argument, true);
    default:
      return ENOTTY;
  }
}

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& camera = *static_cast<Camera*>(user);
  const std::lock_guard lock(camera.mutex);
  const int code =
      serve(camera, umockdev_ioctl_client_get_request(client), umockdev_ioctl_client_get_arg(client));
  umockdev_ioctl_client_complete(client, code == 0 ? 0 : -1, code);
  return TRUE;
}

}  // namespace

struct MockV4l2::State {
  UMockdevTestbed* testbed = umockdev_testbed_new();
  std::vector<std::unique_ptr<Camera>> cameras;
  std::vector<UMockdevIoctlBase*> handlers;
  std::vector<std::string> nodes;
};

bool MockV4l2::possible() {
  const char* preloaded = std::getenv("LD_PRELOAD");
  return preloaded && std::strstr(preloaded, "umockdev");
}

MockV4l2::MockV4l2() : state_(std::make_unique<State>()) {}

MockV4l2::~MockV4l2() {
  for (const std::string& node : state_->nodes) {
    umockdev_testbed_detach_ioctl(state_->testbed, node.c_str(), nullptr);
  }
  for (UMockdevIoctlBase* handler : state_->handlers) g_object_unref(handler);
  g_object_unref(state_->testbed);
}

void MockV4l2::plug_in(const MockV4l2Device& device) {
  const std::string name = "video" + std::to_string(device.number);
  const std::string text =
      "P: /devices/mock/video4linux/" + name + "\nN: " + name + "\nE: DEVNAME=/dev/" + name +
      "\nE: SUBSYSTEM=video4linux\nE: MAJOR=81\nE: MINOR=" + std::to_string(device.number) +
      "\nA: name=mock\\n\n";
  GError* error = nullptr;
  if (!umockdev_testbed_add_from_string(state_->testbed, text.c_str(), &error))
    throw std::runtime_error(error->message);
  auto camera = std::make_unique<Camera>();
  camera->device = device;
  UMockdevIoctlBase* handler = umockdev_ioctl_base_new();
  g_signal_connect(handler, "handle-ioctl", reinterpret_cast<GCallback>(on_ioctl), camera.get());
  const std::string node = "/dev/" + name;
  if (!umockdev_testbed_attach_ioctl(state_->testbed, node.c_str(), handler, &error)) {
    throw std::runtime_error(error->message);
  }
  state_->cameras.push_back(std::move(camera));
  state_->handlers.push_back(handler);
  state_->nodes.push_back(node);
}

std::vector<std::pair<std::uint32_t, int>> MockV4l2::writes() const {
  std::vector<std::pair<std::uint32_t, int>> all;
  for (const auto& camera : state_->cameras) {
    const std::lock_guard lock(camera->mutex);
    all.insert(all.end(), camera->writes.begin(), camera->writes.end());
  }
  return all;
}

}  // namespace ca2::test
