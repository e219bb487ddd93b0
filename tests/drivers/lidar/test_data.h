/// @file Where the recordings of others lie, and reading them.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace ca2::test {

/// $CA2_TEST_DATA/packets/<name>, or an empty path without the data.
inline std::filesystem::path packet_file(const std::string& name) {
  const char* root = std::getenv("CA2_TEST_DATA");
  return root ? std::filesystem::path(root) / "packets" / name : std::filesystem::path();
}

inline std::string slurp(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace ca2::test

/// Skips a test that needs recordings where they are absent.
#define CA2_NEEDS_PACKETS(file) \
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "set CA2_TEST_DATA to run this on real recordings"
