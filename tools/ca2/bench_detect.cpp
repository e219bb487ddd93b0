/// `ca2 bench detect`: our search for a board against OpenCV's and libapriltag's, board present and absent.
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <cstdio>
#include <deque>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "core/io/files.h"
#include "tools/ca2/bench.h"
#include "tools/ca2/bench_detect_peers.h"
#include "tools/ca2/bench_pictures.h"
#include "tools/ca2/bench_timing.h"

namespace ca2 {
namespace {

// CPU seconds after which an endless peer is stopped.
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

/// One board's pictures of one kind.
struct Set {
  std::string name;
  Board board;
  bool present = false;
  const std::vector<BenchPicture>* pictures = nullptr;
};

// For a pose: fewer are not counted as found.
constexpr std::size_t least_corners = 6;
// Of every camera. They take longer to draw than to search.
constexpr int present_pictures = 10;
// The peers take seconds on hard pictures: they search so many of each set, ours all of them.
constexpr std::size_t peer_pictures = 20;

struct Column {
  std::vector<double> ms;
  int found = 0;
  int stopped = 0;

  void add(const Run& run) {
    ms.push_back(run.ms);
    found += run.found ? 1 : 0;
    stopped += run.stopped ? 1 : 0;
  }
  double worst() const { return *std::max_element(ms.begin(), ms.end()); }
  double sum() const {
    double total = 0;
    for (const double t : ms) total += t;
    return total;
  }
};

Run middle(std::vector<Run> runs) {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.ms < b.ms; });
  return runs[runs.size() / 2];
}

/// Ours on all pictures and, as the peers, on the first of them.
struct Table {
  Column find, detect, beside_peers;
  std::vector<Column> peers;
};

/// Every search of one picture is the median of interleaved repeats; an endless one runs once.
void measure(const Board& board, const Image& image, int repeats, const std::vector<PeerSearch>& peers,
             bool with_peers, Table& table) {
  std::vector<Run> find, detect;
  std::vector<std::vector<Run>> theirs(peers.size());
  for (int i = 0; i < repeats; ++i) {
    find.push_back(timed([&] { return board.type->find(board, image).size() >= least_corners; }));
    detect.push_back(timed([&] { return !detect_board(board, image).empty(); }));
    for (std::size_t k = 0; with_peers && k < peers.size(); ++k) {
      if (!peers[k].endless) theirs[k].push_back(timed([&] { return peers[k].found(board, image); }));
    }
  }
  table.find.add(middle(find));
  table.detect.add(middle(detect));
  if (!with_peers) return;
  table.beside_peers.add(middle(find));
  for (std::size_t k = 0; k < peers.size(); ++k) {
    if (peers[k].endless) theirs[k].push_back(timed_in_child([&] { return peers[k].found(board, image); }));
    table.peers[k].add(middle(theirs[k]));
  }
}

nlohmann::json report(const Set& set, int repeats, bool quiet) {
  const std::vector<PeerSearch> peers = peer_searches(set.board);
  Table table;
  table.peers.resize(peers.size());
  for (std::size_t i = 0; i < set.pictures->size(); ++i) {
    const bool with_peers = i < (set.present ? peer_pictures : peer_pictures / 5);
    measure(set.board, (*set.pictures)[i].image, repeats, peers, with_peers, table);
  }
  nlohmann::json row{{"board", set.board.type->name()},
                     {"set", set.name},
                     {"pictures", set.pictures->size()},
                     {"present", set.present},
                     {"find_ms", {median(table.find.ms), table.find.worst()}},
                     {"find_and_refine_ms", {median(table.detect.ms), table.detect.worst()}},
                     {"found", table.find.found},
                     {"found_beside_peers", table.beside_peers.found},
                     {"peers", nlohmann::json::array()}};
  std::string text, found;
  char cell[64];
  for (std::size_t k = 0; k < peers.size(); ++k) {
    const Column& peer = table.peers[k];
    const double ratio = table.beside_peers.sum() / peer.sum();
    std::snprintf(cell, sizeof cell, " | %7.1f /%7.1f%s %6.3f", median(peer.ms), peer.worst(),
                  peer.stopped > 0 ? "+" : " ", ratio);
    text += cell;
    std::snprintf(cell, sizeof cell, " %3d", peer.found);
    found += cell;
    row["peers"].push_back({{"name", peers[k].name},
                            {"ms", {median(peer.ms), peer.worst()}},
                            {"stopped", peer.stopped},
                            {"find_over_it", ratio},
                            {"found", peer.found}});
  }
  if (!quiet) {
    std::printf("%-21s %3zu | %6.1f /%6.1f  %6.1f%s | %3d  %3d%s\n", set.name.c_str(), set.pictures->size(),
                median(table.find.ms), table.find.worst(), median(table.detect.ms), text.c_str(),
                table.find.found, table.beside_peers.found, found.c_str());
    std::fflush(stdout);
  }
  return row;
}

void print_header(const Board& board) {
  std::printf("\n%-21s %3s | %14s  %6s", std::string(board.type->name()).c_str(), "n", "find", "+refine");
  for (const PeerSearch& peer : peer_searches(board)) std::printf(" | %16s  %6s", peer.name.c_str(), "ratio");
  std::printf(" | found by\n");
}

Result<std::vector<BenchPicture>> real_pictures(const BenchOptions& options) {
  std::vector<BenchPicture> pictures;
  for (int i = 1; i < 40 && !options.data.empty(); i += 2) {
    const auto image =
        read_png(options.data / "acfr_vlp16" / "images" / ("pose" + std::to_string(i) + ".png"));
    if (!image) return fail(image.error());
    pictures.push_back({"real", to_grey8(*image)});
  }
  return pictures;
}

/// The pictures that sets refer to: what is hard about pictures without a board is so for every type.
struct Pictures {
  std::deque<std::vector<BenchPicture>> present;
  std::map<std::string, std::vector<BenchPicture>> absent;
};

Result<std::vector<Set>> picture_sets(const BenchOptions& options, Pictures& pictures) {
  std::vector<Set> sets;
  std::mt19937_64 hard(2024);
  for (BenchPicture& picture : hard_pictures(1388, 1038, 34, hard))
    pictures.absent[picture.kind].push_back(std::move(picture));
  for (const Board& board : bench_boards()) {
    const std::string type(board.type->name());
    if (type.find(options.only) == std::string::npos) continue;
    std::mt19937_64 random(2024);
    for (const BenchCamera& bench : bench_cameras()) {
      pictures.present.push_back(
          board_pictures("board", board, bench.camera, bench.places, present_pictures, random));
      sets.push_back({std::string("present ") + bench.name, board, true, &pictures.present.back()});
    }
    for (const auto& [kind, absent] : pictures.absent)
      sets.push_back({"absent " + kind, board, false, &absent});
    if (type != "checkerboard") continue;
    auto real = real_pictures(options);
    if (!real) return fail(real.error());
    if (real->empty()) continue;
    pictures.present.push_back(std::move(*real));
    Board shown = board;
    shown.columns = 7;
    shown.rows = 5;
    shown.square = 0.095;
    sets.push_back({"present real 1920x1208", shown, true, &pictures.present.back()});
  }
  return sets;
}

}  // namespace

Result<int> bench_detect(const BenchOptions& options) {
  cv::setNumThreads(1);
  Pictures pictures;
  const auto sets = picture_sets(options, pictures);
  if (!sets) return fail(sets.error());
  if (!options.json) {
    std::printf(
        "CPU ms per picture, median / worst, one thread. Ours: find, find + refine. OpenCV: the "
        "sector-based\n"
        "search (exhaustive) for a checkerboard and the default one (+: stopped at %d s), markers of a "
        "ChArUco\n"
        "and the corners between them. libapriltag: the tags. Ratios are of find's sum over theirs, on the\n"
        "first %zu pictures (a fifth of it where no board is). Found: by ours in all, by ours and theirs on\n"
        "those.\n",
        peer_limit_s, peer_pictures);
  }
  nlohmann::json rows = nlohmann::json::array();
  std::string_view type;
  for (const Set& set : *sets) {
    if (!options.json && set.board.type->name() != type) print_header(set.board);
    type = set.board.type->name();
    rows.push_back(report(set, options.repeats, options.json));
  }
  if (options.json) std::printf("%s\n", rows.dump(2).c_str());
  return 0;
}

}  // namespace ca2
