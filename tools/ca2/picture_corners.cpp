#include "tools/ca2/picture_corners.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/features/search.h"
#include "core/io/files.h"
#include "core/io/read_picture.h"
#include "core/io/yaml.h"
#include "core/session/rig.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

struct Picture {
  int width = 0, height = 0;
  std::vector<Corner> corners;
  std::optional<Error> error;
};

Picture look_at(const fs::path& file, const Board& board) {
  const Result<Image> image = read_picture(file);
  if (!image) return {0, 0, {}, image.error()};
  return {image->width, image->height, detect_board(board, *image), std::nullopt};
}

/// All files on all cores.
std::vector<Picture> look_at_all(const std::vector<fs::path>& files, const Board& board,
                                 const std::function<void(int, int)>& progress) {
  std::vector<Picture> pictures(files.size());
  std::atomic<std::size_t> next = 0, done = 0;
  std::vector<std::jthread> threads;
  for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k) {
    threads.emplace_back([&] {
      for (std::size_t i; (i = next++) < files.size(); ++done) pictures[i] = look_at(files[i], board);
    });
  }
  while (done < files.size()) {
    progress(static_cast<int>(done), static_cast<int>(files.size()));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return pictures;
}

Result<std::vector<PictureCorners>> folder_corners(const fs::path& folder, const fs::path& board_file,
                                                   const std::string& camera,
                                                   const std::function<void(int, int)>& progress) {
  if (board_file.empty()) {
    return fail(ErrorCode::usage, folder.string(), "is no session, and of a folder the board is not known",
                "give --board FILE with the YAML that `ca2 board` wrote");
  }
  const Result<Board> board = read_board(board_file);
  if (!board) return fail(board.error());
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (is_picture_name(at->path())) files.push_back(at->path());
  }
  if (error) return fail(ErrorCode::io, folder.string(), error.message());
  if (files.empty()) return fail(ErrorCode::data, folder.string(), "has no PNG or JPEG pictures");
  std::sort(files.begin(), files.end());
  PictureCorners found;
  found.camera = camera.empty() ? "camera" : camera;
  found.board = *board;
  std::vector<Problem> problems;
  const std::vector<Picture> pictures = look_at_all(files, *board, progress);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Picture& picture = pictures[i];
    if (picture.error) {
      problems.insert(problems.end(), picture.error->problems.begin(), picture.error->problems.end());
      continue;
    }
    if (found.width == 0) found.width = picture.width, found.height = picture.height;
    if (picture.width != found.width || picture.height != found.height) {
      problems.push_back({files[i].string(),
                          "the picture is " + std::to_string(picture.width) + " x " +
                              std::to_string(picture.height) + ", those before are " +
                              std::to_string(found.width) + " x " + std::to_string(found.height),
                          "intrinsics hold for one size only: take it out"});
    }
    found.names.push_back(files[i].filename().string());
    found.corners.push_back(picture.corners);
  }
  if (!problems.empty()) return fail(ErrorCode::data, problems);
  return std::vector{found};
}

Result<std::vector<PictureCorners>> session_corners(const Session& session, const std::string& camera,
                                                    const std::function<void(int, int)>& progress) {
  if (!camera.empty() && !session.rig.cameras.count(camera)) {
    std::string names;
    for (const auto& [name, rig_camera] : session.rig.cameras) names += " " + name;
    return fail(ErrorCode::usage, "--camera " + camera, "the session has no such camera",
                "its cameras are:" + names);
  }
  Result<std::vector<SensorFile>> files = list_files(session, {});
  if (!files) return fail(files.error());
  std::erase_if(*files, [&](const SensorFile& file) {
    return !file.is_image || (!camera.empty() && file.sensor != camera);
  });
  ExtractOptions options;
  options.progress = progress;
  search(session, *files, options);
  std::map<std::string, PictureCorners> cameras;
  std::vector<Problem> problems;
  for (const SensorFile& file : *files) {
    PictureCorners& found = cameras[file.sensor];
    found.camera = file.sensor;
    found.board = session.rig.board;
    if (file.error) {
      problems.insert(problems.end(), file.error->problems.begin(), file.error->problems.end());
      continue;
    }
    if (found.width == 0) found.width = file.image.width, found.height = file.image.height;
    if (file.image.width != found.width || file.image.height != found.height) {
      problems.push_back(
          {file.path.string(), "the picture has another size than those before", "take the view out"});
    }
    found.names.push_back("view " + std::to_string(session.views[file.view].id));
    found.corners.push_back(file.image.corners);
  }
  if (!problems.empty()) return fail(ErrorCode::data, problems);
  std::vector<PictureCorners> list;
  for (auto& [name, found] : cameras) list.push_back(std::move(found));
  if (list.empty()) return fail(ErrorCode::data, session.directory.string(), "has no pictures");
  return list;
}

}  // namespace

Result<Board> read_board(const fs::path& file) {
  const Result<std::string> text = read_text(file, max_yaml_bytes);
  if (!text) return fail(text.error());
  // A rig has sensors; a board's file need not name any.
  const Result<YamlNode> root = parse_yaml(*text, file.string());
  if (!root) return fail(root.error());
  std::string whole = *text;
  if (!root->find("version")) whole += "\nversion: 1\n";
  if (!root->find("cameras") && !root->find("lidars")) whole += "\ncameras: {camera: {}}\n";
  const Result<Rig> rig = parse_rig(whole, file, {"software", "created", "start"});
  if (!rig) return fail(rig.error());
  return rig->board;
}

Result<std::vector<PictureCorners>> read_corners(const fs::path& source, const fs::path& board,
                                                 const std::string& camera,
                                                 const std::function<void(int, int)>& progress) {
  std::error_code error;
  if (!fs::is_directory(source, error))
    return fail(ErrorCode::io, source.string(), "there is no such directory");
  if (!fs::exists(source / "session.yaml", error)) return folder_corners(source, board, camera, progress);
  const Result<Session> session = open_session(source);
  if (!session) return fail(session.error());
  return session_corners(*session, camera, progress);
}

}  // namespace ca2
