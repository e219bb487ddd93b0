#include "drivers/camera/t265/firmware.h"

#include <openssl/evp.h>
#include <strings.h>

#include "core/io/files.h"
#include "core/types/text.h"

namespace ca2::t265 {
namespace {

std::string sha1_of(const std::string& bytes) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (!EVP_Digest(bytes.data(), bytes.size(), digest, &size, EVP_sha1(), nullptr)) return "";
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += formatted("%02x", digest[i]);
  return text;
}

}  // namespace

std::string firmware_hint() {
  return "the T265 has no firmware of its own, and Intel's licence forbids passing it on: get "
         "target-0.2.0.951.mvcmd (SHA-1 " +
         std::string(firmware_sha1) +
         "), which librealsense 2.50 fetches when it is built, and give its path as 'firmware' "
         "(docs/t265.md)";
}

Result<std::string> read_firmware(const std::filesystem::path& file, std::string_view sha1) {
  auto bytes = read_text(file);
  if (!bytes) {
    Error error = bytes.error();
    error.code = ErrorCode::config;
    error.problems.back().hint = firmware_hint();
    return fail(std::move(error));
  }
  const std::string got = sha1_of(*bytes);
  if (::strcasecmp(got.c_str(), std::string(sha1).c_str()) != 0) {
    return fail(ErrorCode::config, file.string(),
                "is not the firmware: its SHA-1 is " + got + ", not " + std::string(sha1), firmware_hint());
  }
  return bytes;
}

}  // namespace ca2::t265
