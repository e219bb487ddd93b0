#include "tools/ca2/solve_session.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/features/extract.h"
#include "core/features/result_inputs.h"
#include "core/guidance/next_pose.h"
#include "core/io/files.h"
#include "core/session/session.h"
#include "core/solve/calibrate.h"
#include "tools/ca2/id_list.h"
#include "tools/ca2/input_files.h"
#include "tools/ca2/print_calibration.h"
#include "tools/ca2/print_warnings.h"
#include "tools/ca2/progress.h"
#include "tools/ca2/rig_doubts.h"
#include "tools/sim/truth_file.h"

namespace ca2 {
namespace {

/// A refused solve must not leave the result of an earlier one in place as if it were the answer.
void set_aside(const std::filesystem::path& output) {
  std::error_code error;
  if (!std::filesystem::exists(output, error)) return;
  const std::filesystem::path aside = output.parent_path() / (output.stem().string() + ".previous.yaml");
  std::filesystem::rename(output, aside, error);
  if (!error) std::fprintf(stderr, "ca2: the earlier result is now %s\n", aside.string().c_str());
}

/// Simulated sessions say what is true: then the error is measured, not only estimated.
void print_true_errors(const Session& session, const Calibration& calibration) {
  const std::filesystem::path file = session.directory / "truth.yaml";
  if (!std::filesystem::exists(file)) return;
  const Result<std::vector<TrueTransform>> truth = read_true_transforms(file);
  if (!truth) return print_warnings(truth.error().problems);
  for (const TrueTransform& real : *truth) {
    for (const CalibratedTransform& found : calibration.transforms) {
      if (found.parent != real.parent || found.child != real.child) continue;
      const Vector6d error = found.T_parent_child.difference(real.T_parent_child);
      std::printf("true error of T_%s_%s: %.2f mm, %.2f mrad (truth.yaml)\n", real.parent.c_str(),
                  real.child.c_str(), 1e3 * error.tail<3>().norm(), 1e3 * error.head<3>().norm());
    }
  }
}

/// The answer of the best `count` views; the others are listed as left out.
Result<Calibration> calibrate_best(const Extraction& features, const Calibration& all, std::size_t count,
                                   const CalibrateOptions& options, const HeldValues& held) {
  const std::vector<int> ids = best_views(features.rig, all, features.views, count, {});
  const auto chosen = [&](int id) { return std::binary_search(ids.begin(), ids.end(), id); };
  std::vector<ViewSights> views;
  for (const ViewSights& view : features.views) {
    if (chosen(view.id)) views.push_back(view);
  }
  Result<Calibration> best = calibrate_holding(features.rig, views, options, held);
  if (!best) return best;
  for (const CalibratedView& view : all.views) {
    if (chosen(view.id)) continue;
    CalibratedView left_out{view.id, false, view.reason, 0, 0};
    if (view.used) left_out.reason = "not among the best " + std::to_string(count);
    best->views.push_back(left_out);
  }
  std::sort(best->views.begin(), best->views.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return best;
}

/// What would help most, unless the answer is good enough for most uses.
void print_next_pose(const Extraction& features, const Calibration& calibration) {
  const SigmaTarget target;
  const auto next = suggest_next_pose(features.rig, calibration, features.views, {}, target);
  const bool reached = std::all_of(
      calibration.transforms.begin(), calibration.transforms.end(), [&](const CalibratedTransform& t) {
        return t.sigma_translation() <= target.translation && t.sigma_rotation() <= target.rotation;
      });
  if (reached || !next) return;
  std::printf("next: show the board %s (%s): expect %.2f mm, %.2f mrad\n", next->words.c_str(),
              next->camera.c_str(), 1e3 * next->sigma_translation, 1e3 * next->sigma_rotation);
}

}  // namespace

Result<int> solve_session(const SolveArguments& arguments) {
  ExtractOptions extract;
  extract.cache = !arguments.no_cache;
  extract.threads = arguments.threads;
  if (!arguments.views.empty()) {
    Result<std::vector<int>> ids = parse_id_list(arguments.views);
    if (!ids) return fail(ids.error());
    extract.views = std::move(*ids);
  }
  const Result<Session> session = open_session(arguments.session);
  if (!session) return fail(session.error());
  const std::filesystem::path output =
      arguments.output.empty() ? session->directory / "result.yaml" : std::filesystem::path(arguments.output);
  if (const auto spared = spare_inputs(output, input_files(*session)); !spared) return fail(spared.error());
  print_warnings(rig_doubts(session->rig, (session->directory / "session.yaml").string()));
  print_warnings(session->warnings);

  Progress progress("finding the board");
  extract.progress = [&](int done, int total) { progress.show(done, total); };
  const Result<Extraction> features = extract_features(*session, extract);
  if (!features) {
    if (features.error().code == ErrorCode::refused) set_aside(output);
    return fail(features.error());
  }
  print_warnings(features->problems);

  CalibrateOptions options;
  options.method = arguments.method == "kim"              ? Method::kim
                   : arguments.method == "plane_to_plane" ? Method::plane_to_plane
                                                          : Method::joint;
  options.estimated = features->estimated;
  Result<Calibration> calibration =
      calibrate_holding(features->rig, features->views, options, arguments.held);
  if (calibration && arguments.best > 0) {
    calibration = calibrate_best(*features, *calibration, static_cast<std::size_t>(arguments.best), options,
                                 arguments.held);
  }
  if (!calibration) {
    set_aside(output);
    return fail(calibration.error());
  }
  calibration->inputs = result_inputs(*session, extract.views, extract.cache);
  const Result<void> written = write_atomically(output, to_yaml(*calibration));
  // An answer that took minutes is shown whether or not it can be kept.
  if (arguments.json) {
    std::printf("%s\n", to_json(*calibration).c_str());
  } else {
    std::printf("%s", describe(*calibration).c_str());
    print_true_errors(*session, *calibration);
    print_next_pose(*features, *calibration);
    if (written) std::printf("written to %s\n", output.string().c_str());
  }
  if (written) return 0;
  const Problem& problem = written.error().problems.front();
  return fail(written.error().code, problem.where, problem.what, "--output FILE writes the result elsewhere");
}

}  // namespace ca2
