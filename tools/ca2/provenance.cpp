#include "tools/ca2/provenance.h"

#include <sodium.h>

#include <array>
#include <fstream>

#include "core/types/text.h"
#include "drivers/lidar/ouster/metadata.h"
#include "tools/ca2/input_files.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

/// SHA-256 in hexadecimal; empty where the file cannot be read.
std::string sha256(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return {};
  crypto_hash_sha256_state state;
  crypto_hash_sha256_init(&state);
  std::vector<char> block(1 << 16);
  while (stream.read(block.data(), static_cast<std::streamsize>(block.size())) || stream.gcount() > 0) {
    crypto_hash_sha256_update(&state, reinterpret_cast<const unsigned char*>(block.data()),
                              static_cast<unsigned long long>(stream.gcount()));
  }
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash;
  crypto_hash_sha256_final(&state, hash.data());
  std::string text;
  for (const unsigned char byte : hash) text += formatted("%02x", byte);
  return text;
}

void add_hash(std::vector<ProvenanceEntry>& list, const std::string& subject, const fs::path& file) {
  const std::string hash = sha256(file);
  list.push_back({subject, hash.empty() ? "cannot be read" : "sha256 " + hash});
}

/// Of a file that lies elsewhere: where.
std::string name_within(const fs::path& directory, const fs::path& file) {
  const fs::path name = file.lexically_normal().lexically_relative(directory.lexically_normal());
  return name.empty() || *name.begin() == ".." ? file.string() : name.generic_string();
}

void add_source(std::vector<ProvenanceEntry>& list, const std::string& sensor, const SourceOptions& source) {
  for (const auto& [key, value] : source) list.push_back({sensor + "." + key, value});
}

}  // namespace

std::vector<ProvenanceEntry> provenance(const Session& session) {
  std::vector<ProvenanceEntry> list;
  for (const auto& [name, camera] : session.rig.cameras) add_source(list, "cameras." + name, camera.source);
  for (const auto& [name, lidar] : session.rig.lidars) {
    const std::string subject = "lidars." + name;
    if (!lidar.model.empty()) list.push_back({subject + ".model", lidar.model});
    add_source(list, subject, lidar.source);
    if (lidar.metadata.empty()) continue;
    const Result<OusterMetadata> metadata = read_ouster_metadata(session.directory / lidar.metadata);
    if (!metadata) continue;
    list.push_back({subject + ".product", metadata->prod_line});
    list.push_back({subject + ".serial", std::to_string(metadata->serial)});
    list.push_back({subject + ".firmware", metadata->firmware});
  }
  for (const fs::path& file : input_files(session))
    add_hash(list, name_within(session.directory, file), file);
  return list;
}

std::string session_name(const fs::path& directory) {
  std::error_code error;
  fs::path path = fs::weakly_canonical(directory, error);
  if (path.filename().empty()) path = path.parent_path();
  return path.filename().string();
}

}  // namespace ca2
