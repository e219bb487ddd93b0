/// A GigE Vision camera in a process of its own: Aravis's simulated one behind true GVCP and GVSP, with our
/// pictures. Arguments: ADDRESS SERIAL [LOST] [FILE | FOLDER SHIFT [at_once [LENGTH]]]. LOST is the share of
/// packets that get lost. FILE has the bytes of every picture (repeated where the picture is larger). FOLDER
/// holds the <utc_ns>.png of a recording, each of which is shown SHIFT ns after the time that its name says;
/// they are read when they are due, or all at once; after LENGTH ns the film begins anew. Without either
/// there is a ramp. Says "ready" when it can be opened.
#include <arv.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/io/read_picture.h"
#include "drivers/camera/host_time.h"

namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t stopped = 0;

/// The pictures of a recording, in time.
class Film {
 public:
  /// `length`: ns after which it begins anew; 0: it ends with the last picture.
  bool open(const fs::path& folder, std::int64_t shift, bool at_once, std::int64_t length) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() == ".png") times_.push_back(std::stoll(entry.path().stem().string()));
    }
    std::sort(times_.begin(), times_.end());
    folder_ = folder;
    shift_ = shift;
    length_ = length;
    for (std::size_t i = 0; at_once && i < times_.size(); ++i) pictures_.push_back(read(i));
    return times_.size() > 1;
  }

  /// The next one, unless it is more than half a period early; those that are a period late are left out.
  const std::vector<std::uint8_t>& now() {
    const std::size_t before = at_;
    const std::int64_t count = static_cast<std::int64_t>(times_.size());
    const std::int64_t period = (times_.back() - times_.front()) / (count - 1);
    std::int64_t time = ca2::utc_now() - shift_;
    if (length_ > 0 && time >= times_.front() + length_) {
      shift_ += length_;
      time -= length_;
      at_ = 0;
    }
    if (at_ + 1 < times_.size() && times_[at_ + 1] < time + period / 2) ++at_;
    while (at_ + 1 < times_.size() && times_[at_] < time - period) ++at_;
    if (!pictures_.empty()) return pictures_[at_];
    if (before != at_ || due_.empty()) due_ = read(at_);
    return due_;
  }

 private:
  std::vector<std::uint8_t> read(std::size_t index) const {
    auto image = ca2::read_picture(folder_ / (std::to_string(times_[index]) + ".png"));
    return image ? std::move(image->bytes) : std::vector<std::uint8_t>();
  }

  fs::path folder_;
  std::int64_t shift_ = 0, length_ = 0;
  std::vector<std::int64_t> times_;
  std::size_t at_ = 0;
  std::vector<std::uint8_t> due_;
  std::vector<std::vector<std::uint8_t>> pictures_;  ///< all, where they were read at once
};

std::vector<std::uint8_t> still;  ///< every picture, where there is no film
Film film;
bool have_film = false;

void fill(ArvBuffer* buffer, void*, guint32, guint32, ArvPixelFormat format) {
  // Aravis says how much the buffer holds only once it is filled.
  int x = 0, y = 0, width = 0, height = 0;
  arv_buffer_get_image_region(buffer, &x, &y, &width, &height);
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                           ARV_PIXEL_FORMAT_BIT_PER_PIXEL(format) / 8;
  const std::vector<std::uint8_t>& picture = have_film ? film.now() : still;
  auto* data = static_cast<std::uint8_t*>(const_cast<void*>(arv_buffer_get_data(buffer, nullptr)));
  for (std::size_t done = 0; done < size && !picture.empty(); done += picture.size()) {
    std::memcpy(data + done, picture.data(), std::min(picture.size(), size - done));
  }
}

bool open_source(int argc, char** argv) {
  if (argc <= 4) {
    for (int i = 0; i < 251; ++i) still.push_back(static_cast<std::uint8_t>(i));
    return true;
  }
  have_film = fs::is_directory(argv[4]);
  if (have_film) {
    return film.open(argv[4], argc > 5 ? std::atoll(argv[5]) : 0, argc > 6,
                     argc > 7 ? std::atoll(argv[7]) : 0);
  }
  std::ifstream file(argv[4], std::ios::binary);
  still.assign(std::istreambuf_iterator<char>(file), {});
  return !still.empty();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: fake_gige_camera ADDRESS SERIAL [LOST] [FILE | FOLDER SHIFT [at_once [LENGTH]]]\n");
    return 64;
  }
  if (!open_source(argc, argv)) {
    std::fprintf(stderr, "fake_gige_camera: no pictures in %s\n", argv[4]);
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
