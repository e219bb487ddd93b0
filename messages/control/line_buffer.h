/// @file Lines out of a byte stream, with a limit.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace ca2::control {

class LineBuffer {
 public:
  explicit LineBuffer(std::size_t longest) : longest_(longest) {}

  void append(std::string_view bytes) {
    buffer_.erase(0, begin_);
    searched_ -= begin_;
    begin_ = 0;
    buffer_.append(bytes);
  }

  /// The next whole line without its end; valid until the next append().
  std::optional<std::string_view> next() {
    const std::size_t end = buffer_.find('\n', searched_);
    if (end == std::string::npos) {
      searched_ = buffer_.size();
      return std::nullopt;
    }
    const std::string_view line = std::string_view(buffer_).substr(begin_, end - begin_);
    begin_ = searched_ = end + 1;
    return line;
  }

  /// Is what has come of the line under way longer than any line may be?
  bool overlong() const { return buffer_.size() - begin_ > longest_; }

 private:
  std::string buffer_;
  std::size_t longest_;
  std::size_t begin_ = 0;     ///< of the next line
  std::size_t searched_ = 0;  ///< no line's end between begin_ and here
};

}  // namespace ca2::control
