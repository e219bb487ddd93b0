/// @file A checksum of a file's content, for caches that are keyed by it.
#pragma once

#include <cstdint>
#include <cstring>
#include <string_view>

namespace ca2 {

/// FNV-1a over 8 bytes at a time: it guards against accidents, not against enemies. How the content is cut
/// into pieces makes no difference.
class ContentDigest {
 public:
  void add(std::string_view bytes) {
    while (held_ > 0 && held_ < sizeof word_ && !bytes.empty()) {
      word_[held_++] = bytes.front();
      bytes.remove_prefix(1);
    }
    if (held_ == sizeof word_) mix(word_), held_ = 0;
    for (; bytes.size() >= sizeof word_; bytes.remove_prefix(sizeof word_)) mix(bytes.data());
    for (const char byte : bytes) word_[held_++] = byte;
  }

  std::uint64_t value() const {
    std::uint64_t hash = hash_;
    for (std::size_t i = 0; i < held_; ++i) hash = (hash ^ static_cast<unsigned char>(word_[i])) * prime;
    return hash;
  }

  static std::uint64_t of(std::string_view bytes) {
    ContentDigest digest;
    digest.add(bytes);
    return digest.value();
  }

 private:
  static constexpr std::uint64_t prime = 0x100000001b3;

  void mix(const char* bytes) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, sizeof word);
    hash_ = (hash_ ^ word) * prime;
    hash_ ^= hash_ >> 29;
  }

  std::uint64_t hash_ = 0xcbf29ce484222325;
  char word_[8] = {};  ///< of which `held_` bytes wait for the others
  std::size_t held_ = 0;
};

}  // namespace ca2
