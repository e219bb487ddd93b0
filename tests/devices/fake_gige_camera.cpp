/// A GigE Vision camera in a process of its own: Aravis's simulated one behind true GVCP and GVSP, with our
/// pictures. Arguments: ADDRESS SERIAL [LOST] [FILE]. LOST is the share of packets that get lost; FILE holds
/// the bytes of every picture (repeated where the picture is larger), without it there is a ramp. Says
/// "ready" when it can be opened.
#include <arv.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace {

std::string picture;
volatile std::sig_atomic_t stopped = 0;

void fill(ArvBuffer* buffer, void*, guint32, guint32, ArvPixelFormat format) {
  // Aravis says how much the buffer holds only once it is filled.
  int x = 0, y = 0, width = 0, height = 0;
  arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                           ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  auto* data = static_cast<char*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
  for (std::size_t done = 0; done < size; done += picture.size()) {
    std::memcpy(data + done, picture.data(), std::min(picture.size(), size - done));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: fake_gige_camera ADDRESS SERIAL [LOST] [FILE]\n");
    return 64;
  }
  if (argc > 4) {
    std::ifstream file(argv[4], std::ios::binary);
    picture.assign(std::istreambuf_iterator<char>(file), {});
  } else {
    for (int i = 0; i < 251; ++i) picture += static_cast<char>(i);
  }
  if (picture.empty()) {
    std::fprintf(stderr, "fake_gige_camera: nothing in %s\n", argv[4]);
    return 65;
  }
  std::signal(SIGTERM, [](int) { stopped = 1; });
  std::signal(SIGINT, [](int) { stopped = 1; });
  ArvGvFakeCamera* camera = arv_gv_fake_camera_new(argv[1], argv[2]);
  if (!arv_gv_fake_camera_is_running(camera)) {
    std::fprintf(stderr, "fake_gige_camera: cannot serve at %s\n", argv[1]);
    return 69;
  }
  arv_fake_camera_set_fill_pattern(arv_gv_fake_camera_get_fake_camera(camera), fill, nullptr);
  g_object_set(camera, "gvsp-lost-ratio", argc > 3 ? std::atof(argv[3]) : 0.0, nullptr);
  std::puts("ready");
  std::fflush(stdout);
  while (!stopped) ::usleep(20'000);
  g_object_unref(camera);
  return 0;
}
