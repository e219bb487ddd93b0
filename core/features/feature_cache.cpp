#include "core/features/feature_cache.h"

#include <cstddef>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <type_traits>

#include "core/io/content_digest.h"
#include "core/io/files.h"

namespace ca2 {
namespace {

constexpr std::uint64_t magic =
    0x3630534541324143;  // "CA2AES06" on little-endian machines: others start anew

class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    text_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void put(const double* values, std::size_t count) {
    text_.append(reinterpret_cast<const char*>(values), count * sizeof(double));
  }
  template <class T>
  void put(const std::vector<T>& list) {
    put(static_cast<std::uint64_t>(list.size()));
    text_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Reads what Writer wrote; after the first failure everything reads as zero and `good` is false.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {}
  template <class T>
  T get() {
    T value{};
    take(&value, sizeof(T));
    return value;
  }
  void get(double* values, std::size_t count) { take(values, count * sizeof(double)); }
  template <class T>
  std::vector<T> list() {
    const auto count = get<std::uint64_t>();
    if (count > text_.size() / sizeof(T)) good_ = false;
    std::vector<T> values(good_ ? count : 0);
    take(values.data(), values.size() * sizeof(T));
    return values;
  }
  bool good() const { return good_; }

 private:
  void take(void* to, std::size_t size) {
    if (!good_ || size > text_.size()) {
      good_ = false;
      return;
    }
    if (size > 0) std::memcpy(to, text_.data(), size);
    text_.remove_prefix(size);
  }
  std::string_view text_;
  bool good_ = true;
};

struct Header {
  std::uint64_t magic = 0, settings = 0, size = 0, content = 0, payload = 0;
  std::int64_t changed = 0;
  std::uint64_t own = 0;  ///< digest of all before it
};

std::uint64_t digest_of(const Header& header) {
  return ContentDigest::of({reinterpret_cast<const char*>(&header), offsetof(Header, own)});
}

/// Size and time of change; a missing file has neither.
bool describe(const std::filesystem::path& data, Header& header) {
  std::error_code error;
  header.size = std::filesystem::file_size(data, error);
  if (error) return false;
  header.changed = std::filesystem::last_write_time(data, error).time_since_epoch().count();
  return !error;
}

}  // namespace

std::optional<std::uint64_t> content_of(const std::filesystem::path& data) {
  const Result<std::string> text = read_text(data, std::size_t{1} << 30);
  if (!text) return std::nullopt;
  return ContentDigest::of(*text);
}

FeatureCache::FeatureCache(std::filesystem::path directory, const std::string& settings)
    : directory_(std::move(directory)), settings_(ContentDigest::of(settings)) {}

std::optional<std::string> FeatureCache::load(const std::string& name,
                                              const std::filesystem::path& data) const {
  if (directory_.empty()) return std::nullopt;
  std::ifstream file(directory_ / name, std::ios::binary);
  if (!file) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.size() < sizeof(Header)) return std::nullopt;
  Header kept;
  std::memcpy(&kept, text.data(), sizeof(Header));
  std::string payload = text.substr(sizeof(Header));
  Header now;
  if (kept.magic != magic || kept.own != digest_of(kept) || kept.settings != settings_ ||
      kept.payload != ContentDigest::of(payload) || !describe(data, now) || kept.size != now.size) {
    return std::nullopt;
  }
  if (kept.changed != now.changed && content_of(data) != kept.content) return std::nullopt;
  return payload;
}

void FeatureCache::store(const std::string& name, const std::filesystem::path& data,
                         std::optional<std::uint64_t> content, const std::string& payload) const {
  Header header;
  if (directory_.empty() || !describe(data, header)) return;
  if (!content) content = content_of(data);
  if (!content) return;
  header.magic = magic;
  header.settings = settings_;
  header.content = *content;
  header.payload = ContentDigest::of(payload);
  header.own = digest_of(header);
  std::error_code error;
  const std::filesystem::path file = directory_ / name;
  std::filesystem::create_directories(file.parent_path(), error);
  // Written aside and renamed, but not fsynced: the checksum tells a torn file.
  const std::filesystem::path aside = file.string() + ".new";
  {
    std::ofstream out(aside, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(&header), sizeof(header));
    out.write(payload.data(), static_cast<std::streamsize>(payload.size()));
    if (!out.good()) return;
  }
  std::filesystem::rename(aside, file, error);
}

std::optional<std::uint64_t> FeatureCache::content(const std::string& name,
                                                   const std::filesystem::path& data) const {
  if (directory_.empty()) return std::nullopt;
  std::ifstream file(directory_ / name, std::ios::binary);
  Header kept, now;
  if (!file.read(reinterpret_cast<char*>(&kept), sizeof(Header)) || kept.magic != magic ||
      kept.own != digest_of(kept)) {
    return std::nullopt;
  }
  if (!describe(data, now) || kept.size != now.size || kept.changed != now.changed) return std::nullopt;
  return kept.content;
}

std::optional<ImageFeatures> FeatureCache::load_image(const std::string& name,
                                                      const std::filesystem::path& data) const {
  const std::optional<std::string> payload = load(name, data);
  if (!payload) return std::nullopt;
  Reader reader(*payload);
  ImageFeatures features;
  features.width = reader.get<std::int32_t>();
  features.height = reader.get<std::int32_t>();
  const auto count = reader.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.good(); ++i) {
    Corner corner;
    corner.id = reader.get<std::int32_t>();
    reader.get(corner.pixel.data(), 2);
    reader.get(corner.covariance.data(), 4);
    features.corners.push_back(corner);
  }
  if (!reader.good()) return std::nullopt;
  return features;
}

void FeatureCache::store_image(const std::string& name, const std::filesystem::path& data,
                               std::optional<std::uint64_t> content, const ImageFeatures& features) const {
  Writer writer;
  writer.put(static_cast<std::int32_t>(features.width));
  writer.put(static_cast<std::int32_t>(features.height));
  writer.put(static_cast<std::uint32_t>(features.corners.size()));
  for (const Corner& corner : features.corners) {
    writer.put(static_cast<std::int32_t>(corner.id));
    writer.put(corner.pixel.data(), 2);
    writer.put(corner.covariance.data(), 4);
  }
  store(name, data, content, writer.text());
}

std::optional<std::vector<LidarSight>> FeatureCache::load_cloud(const std::string& name,
                                                                const std::filesystem::path& data) const {
  const std::optional<std::string> payload = load(name, data);
  if (!payload) return std::nullopt;
  Reader reader(*payload);
  std::vector<LidarSight> sights;
  const auto count = reader.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.good(); ++i) {
    LidarSight sight;
    reader.get(sight.plane.normal.data(), 3);
    sight.plane.offset = reader.get<double>();
    reader.get(sight.center.data(), 3);
    sight.rms = reader.get<double>();
    sight.score = reader.get<double>();
    sight.on_board = reader.list<BoardReturn>();
    sight.around = reader.list<BoardReturn>();
    sight.crossings = reader.list<EdgeCrossing>();
    sights.push_back(std::move(sight));
  }
  if (!reader.good()) return std::nullopt;
  return sights;
}

void FeatureCache::store_cloud(const std::string& name, const std::filesystem::path& data,
                               std::optional<std::uint64_t> content,
                               const std::vector<LidarSight>& sights) const {
  Writer writer;
  writer.put(static_cast<std::uint32_t>(sights.size()));
  for (const LidarSight& sight : sights) {
    writer.put(sight.plane.normal.data(), 3);
    writer.put(sight.plane.offset);
    writer.put(sight.center.data(), 3);
    writer.put(sight.rms);
    writer.put(sight.score);
    writer.put(sight.on_board);
    writer.put(sight.around);
    writer.put(sight.crossings);
  }
  store(name, data, content, writer.text());
}

}  // namespace ca2
