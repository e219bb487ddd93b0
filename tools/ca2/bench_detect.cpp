/// `ca2 bench detect`: our search for a board against OpenCV's two, board present and absent.
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>

#include "core/io/files.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_pictures.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

// CPU seconds after which a peer is stopped: the default search can take minutes on texture.
constexpr int peer_limit_s = 4;

struct Run {
  double ms = 0;
  bool found = false;
  bool stopped = false;  ///< at the limit; ms is then the limit
};

Run timed(const std::function<bool()>& search) {
  const double start = cpu_ms();
  const bool found = search();
  return {cpu_ms() - start, found, false};
}

/// The same in a child process with a limit on its CPU time.
Run timed_in_child(const std::function<bool()>& search) {
  Run run{1e3 * peer_limit_s, false, true};
  int ends[2];
  if (pipe(ends) != 0) return run;
  const pid_t child = fork();
  if (child == 0) {
    const itimerval limit{{0, 0}, {peer_limit_s, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    const Run own = timed(search);
    const bool written = write(ends[1], &own, sizeof own) == static_cast<ssize_t>(sizeof own);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Run answer;
  if (child > 0 && read(ends[0], &answer, sizeof answer) == static_cast<ssize_t>(sizeof answer)) run = answer;
  close(ends[0]);
  if (child > 0) waitpid(child, nullptr, 0);
  return run;
}

struct Sets {
  std::string name;
  Board board;
  bool present = false;
  std::vector<BenchPicture> pictures;
};

// The peers take seconds on hard pictures: they search so many of each set, ours all of them.
constexpr std::size_t peer_pictures = 20;

/// The four searches over one picture, each the median of interleaved repeats; the default search runs once.
struct Row {
  Run find, detect, sectors, classic;
};

Run median(std::vector<Run> runs) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.ms < b.ms; });
  return runs[runs.size() / 2];
}

Row measure(const Board& board, const Image& image, int repeats, bool with_peers) {
  const cv::Mat picture(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.bytes.data()));
  const cv::Size size(board.columns, board.rows);
  std::vector<Run> find, detect, sectors;
  for (int i = 0; i < repeats; ++i) {
    find.push_back(timed([&] { return !board.type->find(board, image).empty(); }));
    detect.push_back(timed([&] { return !detect_board(board, image).empty(); }));
    if (!with_peers) continue;
    sectors.push_back(timed([&] {
      std::vector<cv::Point2f> corners;
      return cv::findChessboardCornersSB(picture, size, corners, cv::CALIB_CB_EXHAUSTIVE);
    }));
  }
  if (!with_peers) return {median(find), median(detect), {}, {}};
  const Run classic = timed_in_child([&] {
    std::vector<cv::Point2f> corners;
    return cv::findChessboardCorners(picture, size, corners);
  });
  return {median(find), median(detect), median(sectors), classic};
}

struct Column {
  std::vector<double> ms;
  int found = 0;
  int stopped = 0;

  void add(const Run& run) {
    ms.push_back(run.ms);
    found += run.found ? 1 : 0;
    stopped += run.stopped ? 1 : 0;
  }
  double middle() const {
    std::vector<double> sorted = ms;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  double worst() const { return *std::max_element(ms.begin(), ms.end()); }
  double sum() const {
    double total = 0;
    for (const double t : ms) total += t;
    return total;
  }
};

nlohmann::json report(const Sets& set, int repeats, bool quiet) {
  Column find, detect, beside_peers, sectors, classic;
  for (std::size_t i = 0; i < set.pictures.size(); ++i) {
    const bool with_peers = i < (set.present ? peer_pictures : peer_pictures / 5);
    const Row row = measure(set.board, set.pictures[i].image, repeats, with_peers);
    find.add(row.find);
    detect.add(row.detect);
    if (!with_peers) continue;
    beside_peers.add(row.find);
    sectors.add(row.sectors);
    classic.add(row.classic);
  }
  const double ratio = beside_peers.sum() / sectors.sum();
  const double ratio_classic = beside_peers.sum() / classic.sum();
  if (!quiet) {
    std::printf(
        "%-22s %3zu | %6.1f /%6.1f  %6.1f | %7.1f /%7.1f | %7.1f /%7.1f%s | %6.3f  %6.3f | %3d  %3d %3d "
        "%3d\n",
        set.name.c_str(), set.pictures.size(), find.middle(), find.worst(), detect.middle(), sectors.middle(),
        sectors.worst(), classic.middle(), classic.worst(), classic.stopped > 0 ? "+" : " ", ratio,
        ratio_classic, find.found, beside_peers.found, sectors.found, classic.found);
    std::fflush(stdout);
  }
  return {{"set", set.name},
          {"pictures", set.pictures.size()},
          {"present", set.present},
          {"find_ms", {find.middle(), find.worst()}},
          {"find_and_refine_ms", {detect.middle(), detect.worst()}},
          {"sector_search_ms", {sectors.middle(), sectors.worst()}},
          {"default_search_ms", {classic.middle(), classic.worst()}},
          {"default_search_stopped", classic.stopped},
          {"find_over_sector_search", ratio},
          {"find_over_default_search", ratio_classic},
          {"found", find.found},
          {"found_beside_peers", {beside_peers.found, sectors.found, classic.found}}};
}

Result<std::vector<Sets>> picture_sets(const BenchOptions& options) {
  std::mt19937_64 random(2024);
  Board board = bench_board();
  std::vector<Sets> sets;
  for (const BenchCamera& bench : bench_cameras()) {
    sets.push_back({std::string("present ") + bench.name, board, true,
                    board_pictures("board", board, bench.camera, bench.places, 8, random)});
  }
  std::map<std::string, std::vector<BenchPicture>> by_kind;
  for (BenchPicture& picture : hard_pictures(1388, 1038, 34, random))
    by_kind[picture.kind].push_back(std::move(picture));
  for (auto& [kind, pictures] : by_kind)
    sets.push_back({"absent " + kind, board, false, std::move(pictures)});
  if (!options.data.empty()) {
    board.columns = 7;
    board.rows = 5;
    board.square = 0.095;
    Sets real{"present real 1920x1208", board, true, {}};
    for (int i = 1; i < 40; i += 2) {
      const auto image =
          read_png(options.data / "acfr_vlp16" / "images" / ("pose" + std::to_string(i) + ".png"));
      if (!image) return fail(image.error());
      real.pictures.push_back({"real", to_grey8(*image)});
    }
    sets.push_back(std::move(real));
  }
  return sets;
}

}  // namespace

Result<int> bench_detect(const BenchOptions& options) {
  cv::setNumThreads(1);
  const auto sets = picture_sets(options);
  if (!sets) return fail(sets.error());
  if (!options.json) {
    std::printf(
        "CPU ms per picture, median / worst, one thread. Ours: find, find + refine. OpenCV: the "
        "sector-based\n"
        "search (exhaustive) and the default one (+: stopped at %d s). Ratios are of find's sum over "
        "theirs, on the first %zu pictures (a fifth of it where no board is): the last columns count what\n"
        "ours found in all, and ours, the sector-based and the default search on those.\n\n"
        "%-22s %3s | %14s  %6s | %16s | %16s  | %6s  %6s | found by\n",
        peer_limit_s, peer_pictures, "pictures", "n", "find", "+refine", "sector-based", "default", "/sect.",
        "/def.");
  }
  nlohmann::json rows = nlohmann::json::array();
  for (const Sets& set : *sets) rows.push_back(report(set, options.repeats, options.json));
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
