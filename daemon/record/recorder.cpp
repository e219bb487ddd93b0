#include "daemon/record/recorder.h"

#include <ctime>

#include "core/io/files.h"
#include "core/types/text.h"
#include "daemon/log.h"
#include "drivers/camera/picture_folder.h"
#include "drivers/net/datagram_batch.h"
#include "drivers/net/pcap_writer.h"
#include "drivers/recording/recording.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_jobs = 4096, most_bytes = 128u << 20, batch_bytes = 1u << 20;
constexpr std::int64_t batch_time = 200'000'000;  // ns
constexpr std::chrono::seconds longest_job{60};

/// The rig with the files that its LiDARs are decoded with, copied into the recording.
Result<Rig> with_copies(Rig rig, const fs::path& directory) {
  for (auto& [name, lidar] : rig.lidars) {
    for (std::string* path : {&lidar.metadata, &lidar.calibration}) {
      if (path->empty()) continue;
      const Result<std::string> content = read_text(*path);
      if (!content) return fail(content.error());
      const fs::path copy = fs::path("lidars") / (name + fs::path(*path).extension().string());
      if (const auto written = write_new(directory / copy, *content); !written) return fail(written.error());
      *path = copy.string();
    }
  }
  return rig;
}

}  // namespace

struct Recorder::Packets {
  DatagramBatch batch;
  std::int64_t first = 0;  ///< ns UTC, of the oldest
};

/// Only the recorder's thread writes to it.
class Recorder::Files {
 public:
  explicit Files(fs::path directory) : directory_(std::move(directory)) {}
  const fs::path& directory() const { return directory_; }

  bool write(const std::string& camera, std::int64_t time, const Image& image) {
    // Not synced to the disk: a power cut may cost the last seconds of a recording, not its speed.
    return save_picture(directory_ / "cameras" / camera, time, image).has_value();
  }

  bool write(const std::string& lidar, const Datagram& datagram) {
    auto found = writers_.find(lidar);
    if (found == writers_.end()) {
      auto writer = PcapWriter::create(directory_ / "lidars" / (lidar + ".pcap"));
      if (!writer) return note(fail(writer.error()));
      found = writers_.emplace(lidar, std::move(*writer)).first;
    }
    return note(found->second.write(datagram));
  }

  Result<void> close() {
    Result<void> result;
    for (auto& [lidar, writer] : writers_) {
      if (auto closed = writer.close(); !closed) result = closed;
    }
    writers_.clear();
    return result;
  }

 private:
  bool note(const Result<void>& written) {
    if (!written && !failed_) log::error("record", written.error().text());
    failed_ = !written;
    return !failed_;
  }

  const fs::path directory_;
  std::map<std::string, PcapWriter> writers_;
  bool failed_ = false;
};

Recorder::Recorder(EventLoop& loop, Heartbeats& heartbeats, fs::path state, std::function<std::int64_t()> now)
    : loop_(loop),
      state_(std::move(state)),
      now_(std::move(now)),
      thread_("recorder", heartbeats, most_jobs, longest_job, Urgency::cannot_wait) {}

Recorder::~Recorder() = default;

std::string Recorder::directory() const {
  return on_ ? files_->directory().string() : "";
}

Result<std::string> Recorder::start(const std::string& given) {
  if (on_) {
    return fail(ErrorCode::usage, "", "already recording to " + files_->directory().string(),
                "`ca2 record stop` ends it");
  }
  const std::int64_t now = now_();
  std::string name = given;
  if (name.empty()) {
    const std::time_t seconds = now / 1'000'000'000;
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    char text[32];
    name.assign(text, std::strftime(text, sizeof(text), "%Y%m%dT%H%M%SZ", &parts));
  }
  if (!valid_sensor_name(name)) {
    return fail(ErrorCode::usage, "", "a recording's name is 1 to 64 letters, digits, '_' and '-'");
  }
  const fs::path directory = state_ / "recordings" / name;
  std::error_code error;
  if (fs::exists(directory, error)) {
    return fail(ErrorCode::cannot_create, directory.string(), "there is a recording already",
                "choose another name");
  }
  fs::create_directories(directory / "lidars", error);
  for (const auto& [camera, unused] : rig_.cameras) {
    if (!error) fs::create_directories(directory / "cameras" / camera, error);
  }
  if (error) {
    return fail(ErrorCode::cannot_create, directory.string(), "cannot be created: " + error.message());
  }
  const Result<Rig> rig = with_copies(rig_, directory);
  if (!rig) return fail(rig.error());
  const auto written = write_atomically(directory / "recording.yaml", recording_text(*rig, now));
  if (!written) return fail(written.error());
  const std::lock_guard lock(mutex_);
  files_ = std::make_shared<Files>(directory);
  gathered_.clear();
  for (const auto& [lidar, unused] : rig_.lidars) gathered_[lidar] = std::make_shared<Packets>();
  dropped_ = 0;
  on_ = true;
  return directory.string();
}

void Recorder::stop(Answer answer) {
  if (!on_.exchange(false)) {
    return answer(fail(ErrorCode::usage, "", "nothing is being recorded"));
  }
  std::shared_ptr<Files> files;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [lidar, packets] : gathered_) {
      flush(lidar, *packets);
    }
    files = files_;
  }
  const bool taken = thread_.submit([this, files, answer] {
    const Result<void> closed = files->close();
    loop_.post([this, files, answer, closed] {
      if (!closed) return answer(fail(closed.error()));
      answer(RecordingSummary{files->directory().string(), dropped_});
    });
  });
  if (!taken) answer(fail(ErrorCode::unavailable, "", "the disk cannot keep up", "try again"));
}

void Recorder::submit(std::size_t bytes, std::function<void(Files&)> job) {
  // gathered_'s and files_'s owner holds the mutex.
  if (waiting_bytes_ + bytes > most_bytes) {
    ++dropped_;
    return;
  }
  waiting_bytes_ += bytes;
  const bool taken = thread_.submit([this, bytes, files = files_, job = std::move(job)] {
    job(*files);
    waiting_bytes_ -= bytes;
  });
  if (!taken) {
    waiting_bytes_ -= bytes;
    ++dropped_;
  }
}

void Recorder::picture(const std::string& camera, std::int64_t time, std::shared_ptr<const Image> image) {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  if (!on_) return;  // stopped meanwhile: the files are closed
  submit(image->bytes.size(), [this, camera, time, image](Files& files) {
    if (!files.write(camera, time, *image)) ++dropped_;
  });
}

void Recorder::datagram(const std::string& lidar, const Datagram& datagram) {
  if (!on_) return;
  const std::lock_guard lock(mutex_);
  if (!on_) return;
  const auto found = gathered_.find(lidar);
  const auto source = parse_ip_address(datagram.source_address);
  if (found == gathered_.end() || !source) return;
  Packets& packets = *found->second;
  if (packets.batch.size() == 0) packets.first = datagram.time;
  packets.batch.add(datagram, *source);
  if (packets.batch.bytes() >= batch_bytes || datagram.time - packets.first >= batch_time) {
    flush(lidar, packets);
  }
}

/// In batches: thousands of datagrams per second are not worth a job each.
void Recorder::flush(const std::string& lidar, Packets& packets) {
  if (packets.batch.size() == 0) return;
  auto batch = std::make_shared<DatagramBatch>(std::exchange(packets.batch, {}));
  submit(batch->bytes(), [this, lidar, batch](Files& files) {
    for (const Datagram& datagram : batch->view()) {
      if (!files.write(lidar, datagram)) ++dropped_;
    }
  });
}

}  // namespace ca2
