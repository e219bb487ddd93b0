#include "tools/sim/session_writer.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

#include "core/io/files.h"
#include "core/session/session.h"
#include "tools/sim/truth_file.h"
#include "tools/sim/view_simulator.h"

namespace ca2 {
namespace {

/// Copies the files that the rig names into the session, so that it can be moved; their names become
/// relative to it.
Result<void> carry_along(const ScenarioFile& scenario, const std::filesystem::path& directory, Rig& rig,
                         std::vector<std::pair<std::filesystem::path, std::string>>& files) {
  for (auto& [name, lidar] : rig.lidars) {
    for (std::string* file : {&lidar.metadata, &lidar.calibration}) {
      if (file->empty()) continue;
      const std::filesystem::path source = scenario.file.parent_path() / *file;
      Result<std::string> content = read_text(source);
      if (!content) return fail(content.error());
      *file = name + source.extension().string();
      files.emplace_back(directory / *file, std::move(*content));
    }
  }
  return {};
}

}  // namespace

Result<void> write_simulated_session(const ScenarioFile& file, const std::filesystem::path& directory,
                                     const std::function<void(int, int)>& progress) {
  const Scenario& scenario = file.scenario;
  Rig rig = stated_rig(file);
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  if (const Result<void> carried = carry_along(file, directory, rig, files); !carried) return carried;
  if (const Result<Session> session = create_session(directory, rig); !session) return fail(session.error());
  for (const auto& [path, content] : files) {
    if (const Result<void> written = write_atomically(path, content); !written) return written;
  }

  const ViewSimulator simulator(scenario);
  std::vector<ViewTruth> truths(static_cast<std::size_t>(scenario.views));
  std::atomic<int> next{1};
  std::atomic<bool> failed{false};
  std::mutex mutex;
  int done = 0;
  std::optional<Error> error;
  const auto work = [&] {
    for (int id = next++; id <= scenario.views && !failed; id = next++) {
      const Result<RenderedView> view = simulator.render(id);
      const auto written = view ? write_view(directory, id, view->images, view->scans)
                                : Result<SessionView>(fail(view.error()));
      const std::lock_guard lock(mutex);
      if (!written) {
        if (!failed) error = written.error();
        failed = true;
        return;
      }
      truths[static_cast<std::size_t>(id - 1)] = {id, view->wrong_object, view->T_sensor_board};
      if (progress) progress(++done, scenario.views);
    }
  };
  {
    std::vector<std::jthread> workers;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    for (unsigned i = 0; i < cores; ++i) workers.emplace_back(work);
  }
  if (error) return fail(std::move(*error));
  return write_atomically(directory / "truth.yaml", truth_text(scenario, truths));
}

}  // namespace ca2
