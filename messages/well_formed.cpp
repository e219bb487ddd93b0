#include "messages/well_formed.h"

#include <utility>

namespace ca2 {
namespace {

class Walk {
 public:
  explicit Walk(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool fields(std::string_view layout) {
    for (std::size_t i = 0; i < layout.size(); ++i) {
      if (layout[i] != '(') {
        if (!field(layout[i])) return false;
        continue;
      }
      const std::size_t end = layout.find(')', i);
      if (last_integer_ < 0) return false;
      for (std::int32_t n = last_integer_; n > 0; --n) {
        if (!fields(layout.substr(i + 1, end - i - 1))) return false;
      }
      i = end;
    }
    return true;
  }

  bool at_end() const { return bytes_.empty(); }
  bool skip(std::size_t size) {
    if (size > bytes_.size()) return false;
    bytes_ = bytes_.subspan(size);
    return true;
  }

 private:
  bool integer() {
    if (bytes_.size() < 4) return false;
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8 | bytes_[static_cast<std::size_t>(i)];
    last_integer_ = static_cast<std::int32_t>(value);
    return skip(4);
  }

  bool field(char kind) {
    if (kind == 'i') return integer();
    if (kind != 's') return skip(kind == 'b' ? 1 : 8);
    const std::int32_t count = last_integer_;  // a string's length counts no array
    if (!integer()) return false;
    const std::int32_t length = std::exchange(last_integer_, count);
    // With its terminating zero, so never empty.
    if (length < 1 || static_cast<std::size_t>(length) > bytes_.size()) return false;
    return bytes_[static_cast<std::size_t>(length) - 1] == 0 && skip(static_cast<std::size_t>(length));
  }

  std::span<const std::uint8_t> bytes_;
  std::int32_t last_integer_ = 0;
};

constexpr std::size_t fingerprint_bytes = 8;

}  // namespace

bool well_formed(std::string_view layout, std::span<const std::uint8_t> message) {
  Walk walk(message);
  return walk.skip(fingerprint_bytes) && walk.fields(layout) && walk.at_end();
}

}  // namespace ca2
