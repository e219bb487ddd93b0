/// `ca2 report`: a session as a page to look at, whatever state it is in.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/features/result_inputs.h"
#include "core/io/files.h"
#include "core/report/html_report.h"
#include "core/solve/calibrate.h"
#include "tools/ca2/command.h"
#include "tools/ca2/print_warnings.h"
#include "tools/ca2/progress.h"
#include "tools/ca2/provenance.h"
#include "tools/ca2/report_pictures.h"

namespace ca2 {
namespace {

namespace fs = std::filesystem;

void tell_missing(ReportInput& input, const Error& error) {
  for (const Problem& problem : error.problems) input.missing.push_back(Error(error.code, {problem}).text());
}

/// What an unsolved session lacks: nothing but the command, or what the command would say.
void say_what_solve_would(ReportInput& input, const Extraction& features, const std::string& directory) {
  CalibrateOptions options;
  options.estimated = features.estimated;
  if (const Result<Calibration> answer = calibrate(features.rig, features.views, options); !answer) {
    tell_missing(input, answer.error());
  } else {
    input.missing.push_back("The views determine an answer: run `ca2 solve " + directory + "`.");
  }
}

/// The page's content. `failure` is of a result that cannot be read.
void fill(ReportInput& input, ReportPictures& pictures, std::optional<Error>& failure,
          const std::string& directory) {
  const Session& session = *input.session;
  input.problems = session.warnings;
  for (const ProvenanceEntry& entry : provenance(session))
    input.provenance.emplace_back(entry.subject, entry.value);
  if (const fs::path file = session.directory / "result.yaml"; fs::exists(file)) {
    const Result<Calibration> calibration = read_calibration(file);
    if (calibration) {
      input.calibration = *calibration;
      input.outdated = outdated_result(*calibration, session);
    } else {
      failure = calibration.error();
      tell_missing(input, *failure);
    }
  }
  if (session.views.empty()) {
    input.missing.push_back(
        "There are no views yet: capture some, or copy pairs of pictures and clouds to views/000001 "
        "and so on.");
    return;
  }
  Progress searching("finding the board");
  ExtractOptions options;
  options.progress = [&](int done, int total) { searching.show(done, total); };
  const Result<Extraction> features = extract_features(session, options);
  if (!features) {
    tell_missing(input, features.error());
  } else {
    input.problems.insert(input.problems.end(), features->problems.begin(), features->problems.end());
    if (input.calibration) {
      input.evidence = gather_evidence(*features, *input.calibration);
    } else {
      say_what_solve_would(input, *features, directory);
    }
  }
  if (!input.calibration) return;
  Progress drawing("drawing");
  pictures = draw_pictures(session, *input.calibration, input.evidence ? &*input.evidence : nullptr,
                           [&](int done, int total) { drawing.show(done, total); });
  input.pictures = std::move(pictures.pictures);
  input.cloud = std::move(pictures.cloud);
  input.problems.insert(input.problems.end(), pictures.problems.begin(), pictures.problems.end());
}

Result<int> report(const std::string& directory) {
  const fs::path folder = fs::path(directory) / "report";
  ReportInput input;
  input.title = "Calibration of " + session_name(directory);
  ReportPictures pictures;
  std::optional<Error> failure;
  Result<Session> session = open_session(directory);
  if (session) {
    input.session = std::move(*session);
    fill(input, pictures, failure, directory);
  } else {
    // What is no session's directory gets no page; a session that cannot be read gets one that says why.
    failure = session.error();
    if (!fs::exists(fs::path(directory) / "session.yaml")) return fail(*failure);
    tell_missing(input, *failure);
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail(ErrorCode::cannot_create, folder.string(), error.message());
  const auto put = [&](const char* name, const std::string& content) {
    Result<void> written = write_atomically(folder / name, content);
    if (written) std::printf("%s\n", (folder / name).string().c_str());
    return written;
  };
  if (const auto written = put("index.html", html_report(input)); !written) return fail(written.error());
  if (!pictures.overlay.empty()) {
    const Result<std::string> png = encode_png(pictures.overlay);
    if (!png) return fail(png.error());
    if (const auto written = put("overlay.png", *png); !written) return fail(written.error());
    if (const auto written = put("cloud.ply", pictures.ply); !written) return fail(written.error());
  }
  if (failure) return fail(*failure);
  if (input.outdated) print_warnings({*input.outdated});
  for (const std::string& line : input.missing)
    std::fprintf(stderr, "ca2: %s: warning: %s\n", directory.c_str(), line.c_str());
  return 0;
}

}  // namespace

CommandBody setup_report(CLI::App& app) {
  auto session = std::make_shared<std::string>();
  app.add_option("session", *session, "Session directory")->required();
  app.footer(
      "Writes SESSION/report/index.html: verdict, extrinsics with sigma, residuals, coverage and the LiDAR's "
      "points on\n"
      "the pictures, in one file to open in any browser; overlay.png and cloud.ply, a coloured cloud, beside "
      "it. A\n"
      "session that is not solved, or cannot be, gets a page that says what is missing.");
  return [session] { return report(*session); };
}

}  // namespace ca2
