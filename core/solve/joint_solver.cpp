#include "core/solve/joint_solver.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/solve/answer_covariance.h"
#include "core/solve/corner_doubts.h"
#include "core/solve/corner_noise.h"
#include "core/solve/joint_start.h"
#include "core/solve/lens_evidence.h"
#include "core/solve/lidar_returns.h"
#include "core/solve/plate_rims.h"
#include "core/solve/range_noise.h"
#include "core/solve/rim_conflict.h"
#include "core/solve/shared_error.h"
#include "core/solve/view_use.h"

namespace ca2 {
namespace {

/// How far boards may move before corners are projected anew, rad and of their distance: while returns and
/// noise are still being settled, and for the answer. The neglected second order is the square of it.
constexpr double coarse_reach = 1e-3, fine_reach = 5e-4;
/// Standard deviation of a LiDAR's place from which on rays choose the returns, m.
constexpr double well_placed = 0.01;
/// And from as many views on they do in any case: only what rays choose can be rid of the lasers' own errors.
constexpr std::size_t enough_views = 5;
/// Few views leave too little over to contradict given intrinsics.
constexpr std::size_t least_views_to_doubt = 5;
/// From as many on they contradict most of what is wrong with given values.
constexpr std::size_t many_views = 10;
/// PlateRims::slacks, where planes told nothing.
constexpr std::array rim_slacks_alone{usual_rim_slack, 0.025, 0.015, 0.01};
/// A solve that starts from the one before is close enough for whole Newton steps.
constexpr double cold_damping = 1e-4, warm_damping = 1e-8;
/// What is solved once more anyway is solved well enough where the cost is to fall by less than this share of
/// it: the step that is left, and taken, is a thousandth of a standard deviation of each unknown.
constexpr double enough_decrease = 3e-6;

class Solver {
 public:
  Solver(const Board& board, const std::vector<Camera>& cameras, int lidars,
         const std::vector<ViewSights>& views, const RigSeed& seed, const JointOptions& options)
      : ink_(board),
        views_(views),
        lidars_(static_cast<std::size_t>(lidars)),
        rims_(board, views, seed.chosen, lidars_),
        options_(options),
        input_(first_input(board, cameras, lidars_, options)),
        state_(first_state(cameras, lidars_, views, seed)),
        neighbours_(neighbouring_corners(input_.board_corners, 1.2 * board.square)),
        answer_(first_answer(cameras.size(), lidars_, views.size(), seed)) {
    for (std::size_t l = 0; l < lidars_; ++l) returns_.emplace_back(views, l, seed.chosen, ink_);
    corners_ = settled_corners(views, seed, static_cast<int>(input_.board_corners.size()));
    for (std::size_t v = 0; v < views.size(); ++v) note_usability(v);
  }

  JointAnswer run() {
    if (answer_.by_rims) {
      solve_by_rims();
      return std::move(answer_);
    }
    answer_.plane_misfits = plane_misfits(Disagreeing::dropped);
    if (!stopping()) explain_misfit();
    if (!stopping()) finish(weighed());
    if (!stopping()) add_edges();
    return std::move(answer_);
  }

  enum class Disagreeing { kept, dropped };  ///< views that disagree with the others
  /// By view, zero where not used. Returns, noise and views are settled then.
  std::vector<Misfit> plane_misfits(Disagreeing views) {
    // First with the finder's returns, then with those whose rays meet the board where the solution has it.
    solve();
    estimate_corner_noise();
    // Only the second time round are returns and their noise those of the solution, and views to be blamed.
    solve();
    solve_and_judge();
    if (!stopping()) question_corners();
    if (views == Disagreeing::dropped && !stopping()) question_size();
    while (views == Disagreeing::dropped && !stopping() && drop_worst()) solve_and_judge();
    std::vector<Misfit> misfits;
    for (const JointViewOutcome& view : answer_.views) misfits.push_back(view.used ? view.misfit : Misfit{});
    return misfits;
  }

 private:
  void note_usability(std::size_t v) {
    JointViewOutcome& outcome = answer_.views[v];
    const auto cameras = std::ranges::count_if(corners_[v], [](const auto& seen) { return !seen.empty(); });
    const auto lidars =
        std::ranges::count_if(answer_.chosen[v], [](int hypothesis) { return hypothesis >= 0; });
    outcome.used = cameras + lidars >= 2;
    if (!outcome.used) outcome.reason = why_unusable(views_[v]);
  }

  Pose T_lidar_board(std::size_t v, std::size_t l) const {
    return state_.T_ref_lidar[l].inverse() * state_.T_ref_board[v];
  }

  /// Fills input_ for the views in use (with their indices in active_).
  void prepare() {
    choose_views();
    input_.nuisances.reset();
    input_.range_sigma = answer_.range_sigma;
    input_.corner_scale = answer_.corner_scale;
    input_.prior_range_slope.resize(lidars_);
    for (JointView& view : input_.views) {
      view.ranges.assign(lidars_, std::nullopt);
      view.edges.assign(lidars_, {});
    }
    for (std::size_t l = 0; l < lidars_; ++l) prepare_ranges(l);
    if (rims_.in_use()) prepare_edges();
  }

  void choose_views() {
    std::vector<std::size_t> chosen;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      if (answer_.views[v].used) chosen.push_back(v);
    }
    if (problem_ && chosen == active_) return;
    active_ = std::move(chosen);
    input_.range_sigma = answer_.range_sigma;
    input_.views.clear();
    for (const std::size_t v : active_) input_.views.emplace_back().corners = corners_[v];
    problem_.emplace(input_);
  }

  /// The sums of one LiDAR's returns in every view in use.
  void prepare_ranges(std::size_t l) {
    std::vector<PlacedBoard> boards;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const std::size_t v = active_[i];
      if (!returns_[l].sees(v)) continue;
      if (!placed_) {
        input_.views[i].ranges[l] = returns_[l].as_found(v);
      } else {
        boards.push_back({v, rims_.outline(v), T_lidar_board(v, l)});
        places.push_back(i);
      }
    }
    const auto sums = returns_[l].by_ray(boards, {state_.range_bias[l], answer_.range_sigma[l]});
    for (std::size_t k = 0; k < boards.size(); ++k) input_.views[places[k]].ranges[l] = sums[k];
    input_.prior_range_slope[l] = returns_[l].slope_sigma();
  }

  JointState active_state() const { return state_of_views(state_, active_); }
  void take(JointState active) { take_state_of_views(state_, std::move(active), active_); }

  bool stopping() const { return options_.stop.stop_requested(); }

  void solve() {
    if (stopping()) return;
    prepare();
    input_.range_sigma = answer_.range_sigma = range_noise(input_, state_);
    marginalize_view_errors(input_, answer_.view_sigma);
    solve_prepared();
  }

  void solve_prepared() {
    JointState active = active_state();
    input_.corner_reach = coarse_reach;
    LmOptions options{.max_iterations = 30, .initial_damping = damping_, .stop = options_.stop};
    options.gradient_tolerance = enough_decrease;
    minimize(*problem_, active, options);
    damping_ = warm_damping;
    take(std::move(active));
    placed_ = answer_.by_rims || boards_are_placed();
  }

  void solve_and_judge() {
    solve();
    judge();
  }

  void judge() {
    if (stopping()) return;
    note_misfits(active_state());
    estimate_corner_noise();
  }

  void note_misfits(const JointState& active) {
    for (std::size_t i = 0; i < active_.size(); ++i)
      answer_.views[active_[i]].misfit = problem_->misfit(active, i);
  }

  /// Is it known well enough where the LiDARs are for rays to tell which returns are the boards'? Three
  /// views' planes may leave it open by centimetres, and returns chosen by a wrong place make that worse.
  bool boards_are_placed() const {
    return active_.size() >= enough_views || problem_->lidar_place_sigma() < well_placed;
  }

  /// Sum over the views of their sensors' disagreement. The relative poses took 6 degrees of freedom each.
  Misfit total_misfit() const {
    Misfit sum;
    sum.lidar_freedom = -6 * static_cast<int>(lidars_);
    sum.camera_freedom = -6 * (static_cast<int>(input_.cameras.size()) - 1);
    for (const std::size_t v : active_) sum += answer_.views[v].misfit;
    return sum;
  }

  /// Where camera and LiDAR disagree by more than noise and chance explain, the returns of a view err
  /// together (temperature, incidence, flatness): finds the shared error that explains it.
  void explain_misfit() {
    const Misfit before = total_misfit();
    if (!lidars_disagree(before)) return;
    const auto share = [](const Misfit& misfit) { return misfit.lidar_freedom / misfit.lidars; };
    // Returns, rims and noise are what they were: only what the views' sums are worth changes.
    prepare();
    std::vector<std::vector<std::optional<RangeSums>>> ranges;
    for (const JointView& view : input_.views) ranges.push_back(view.ranges);
    const auto solve_with = [&](double view_sigma) {
      answer_.view_sigma.assign(lidars_, view_sigma);
      for (std::size_t i = 0; i < ranges.size(); ++i) input_.views[i].ranges = ranges[i];
      marginalize_view_errors(input_, answer_.view_sigma);
      solve_prepared();
      note_misfits(active_state());
    };
    SharedErrorSearch search(share(before));
    for (auto error = search.next(); error && !stopping(); error = search.next()) {
      solve_with(*error);
      search.take(share(total_misfit()));
    }
    if (!lidars_disagree(total_misfit())) return;
    // It is not the LiDARs that disagree: the covariance makes up for it instead.
    solve_with(0);
  }

  void prepare_edges() {
    answer_.edges = 0;
    answer_.edge_noise = rims_.noise();
    for (std::size_t l = 0; l < lidars_; ++l) {
      input_.edge_sway[l] = answer_.edge_noise[l].sway;
      for (std::size_t i = 0; i < active_.size(); ++i) {
        input_.views[i].edges[l] = rims_.sums(state_, active_[i], l);
        answer_.edges += static_cast<int>(input_.views[i].edges[l].size());
      }
    }
  }

  /// Solves once more with the plates' rims, which fix the position inside the planes that planes alone
  /// leave weak. Kept unless the answer moves by more than its uncertainty without them allows.
  void add_edges() {
    if (!rims_.any(active_)) return;
    JointAnswer without = answer_;
    const double place_sigma = problem_->lidar_place_sigma();
    for (const std::vector<double> slacks = rims_.slacks(place_sigma); const double slack : slacks) {
      const bool near = slack < usual_rim_slack;
      // Where planes are sure, rims that lie off are not taken for a LiDAR that does.
      if (near || place_sigma < sure_place_sigma) input_.rim_freedom = rim_freedom;
      look_at_rims(slack);
      if (slack == slacks.front())
        without.outline_offset = answer_.outline_offset = rims_.center_offsets(state_, active_);
      if (near) rims_.estimate_errors(state_, active_);
      solve();
      if (answer_.edges == 0) {
        answer_ = std::move(without);
        return;
      }
    }
    judge();
    without.lens_gain = answer_.lens_gain =
        rims_.lens_gains(state_, active_, input_.rim_freedom, options_.lens_radius);
    // With their rims views may disagree where planes alone left room to agree.
    explain_misfit();
    finish(weighed());
    if (!contradicts(answer_, without) || !contradicts(answer_, planes_alone())) return;
    answer_ = std::move(without);
    answer_.edges_dropped = true;
  }

  void look_at_rims(double slack) {
    rims_.look_within(slack);
    rims_.settle_half_turns(state_, active_);
    rims_.estimate_blur(state_, active_);
  }

  /// One or two views: planes leave the LiDARs' places open, so that rims take part from the start, and
  /// nothing is left over that could contradict them or given values.
  void solve_by_rims() {
    choose_views();
    rims_.expect_at_least(usual_edge_noise);
    for (const double slack : rim_slacks_alone) {
      look_at_rims(slack);
      if (slack != rim_slacks_alone.front()) rims_.estimate_errors(state_, active_);
      solve_and_judge();
    }
    if (!stopping()) explain_misfit();
    if (!stopping()) finish(Priors::as_given);
  }

  /// The answer without rims, with the views' own errors as they are known now and given values doubted
  /// as ever: planes may seem to confirm wrong ones, which rims then contradict.
  JointAnswer planes_alone() {
    JointAnswer with = answer_;
    const JointState state = state_;
    rims_.look_within(0);
    solve();
    finish(Priors::as_given);
    state_ = state;
    return std::exchange(answer_, std::move(with));
  }

  /// Corner noise, from the reprojection residuals at the solution.
  void estimate_corner_noise() {
    if (stopping()) return;
    for (std::size_t c = 0; c < input_.cameras.size(); ++c) {
      CornerNoise noise;
      for (std::size_t i = 0; i < active_.size(); ++i) {
        const CornerField& corners = problem_->corners(i, static_cast<int>(c));
        if (corners.empty()) continue;
        const std::size_t v = active_[i];
        const Pose T_camera_board = state_.T_ref_camera[c].inverse() * state_.T_ref_board[v];
        const CornerModel model{state_.cameras[c], T_camera_board, state_.stretch};
        answer_.views[v].reprojection_rms = corners.rms(model);
        noise.add_view(corners, corners.errors_about_own_pose(model), neighbours_);
      }
      if (const auto scale = noise.scale()) answer_.corner_scale[c] = *scale;
    }
  }

  /// Frees what the corners contradict, and solves with it.
  void question_corners() {
    if (active_.size() < least_views_to_doubt) return;
    input_.corner_scale = answer_.corner_scale;
    const CornerDoubts doubts = doubt_corners(input_, active_state(), neighbours_, options_.doubt_priors);
    if (!doubts.any()) return;
    doubts.open(input_);
    solve_anew();
  }

  /// Planes at several distances tell in metres what corners tell in squares. Where both disagree, and no
  /// longer do with another size of the print, it is that.
  void question_size() {
    const double believed = input_.prior_stretch;
    if (active_.size() < least_views_to_doubt || believed >= options_.doubt_priors.size) return;
    const Misfit before = total_misfit();
    if (!lidars_disagree(before)) return;
    const auto [answer, state] = std::pair(answer_, state_);
    input_.prior_stretch = options_.doubt_priors.size;
    solve_anew();
    if (explains(before, total_misfit())) return;
    answer_ = answer;
    state_ = state;
    input_.prior_stretch = believed;
    solve_anew();
  }

  /// With other unknowns.
  void solve_anew() {
    problem_.reset();
    damping_ = cold_damping;
    solve();
    estimate_corner_noise();
    solve_and_judge();
  }

  /// Takes out the view whose sensors disagree most, if chance does not explain it.
  bool drop_worst() {
    if (active_.size() <= 3) return false;
    std::vector<Misfit> misfits;
    for (const std::size_t v : active_) misfits.push_back(answer_.views[v].misfit);
    const std::optional<WorstView> worst = find_worst_view(misfits);
    if (!worst) return false;
    JointViewOutcome& outcome = answer_.views[active_[worst->index]];
    outcome.used = false;
    outcome.reason = worst->reason;
    return true;
  }

  /// By how much the cameras disagree beyond their noise, as a factor on its variance; 1: maybe chance.
  double camera_excess(const JointState& active) {
    note_misfits(active);
    return misfit_excess(total_misfit().cameras, total_misfit().camera_freedom);
  }

  /// Something that is not as it should be makes other things less likely to be.
  Priors weighed() const {
    const bool all_agree = active_.size() == views_.size() && !lidars_disagree(total_misfit()) &&
                           std::ranges::count(answer_.view_sigma, 0) == std::ssize(answer_.view_sigma);
    return all_agree && active_.size() >= many_views ? Priors::believed : Priors::doubted;
  }

  void finish(Priors priors) {
    prepare();
    marginalize_view_errors(input_, answer_.view_sigma);
    JointState active = active_state();
    input_.corner_reach = fine_reach;
    minimize_and_weigh(*problem_, input_, active, priors);
    answer_.camera_factor = camera_excess(active);
    if (answer_.camera_factor > 1) {
      // Corners are less sure than they seemed, and nothing else.
      for (double& scale : input_.corner_scale) scale *= std::sqrt(answer_.camera_factor);
      answer_.corner_scale = input_.corner_scale;
      if (priors == Priors::believed) priors = Priors::doubted;
      minimize_and_weigh(*problem_, input_, active, priors);
      note_misfits(active);
    }
    take(active);
    for (std::size_t i = 0; i < active_.size(); ++i)
      answer_.views[active_[i]].plane_rms = problem_->range_rms(active, i);
    answer_.state = state_;
    answer_.stretch_free = input_.prior_stretch > 0;
    answer_.free_intrinsics.clear();
    for (const CameraParameters& sigma : input_.prior_intrinsics)
      answer_.free_intrinsics.push_back(static_cast<int>(sigma.size()));
    // Disagreement beyond what chance explains is made up for in the covariance; chance itself is not.
    answer_.variance_factor = misfit_excess(total_misfit().lidars, total_misfit().lidar_freedom);
    add_covariance(answer_, *problem_, active, active_.size());
    answer_.rims_off = rims_.in_use() && rims_lie_off(answer_, *problem_, active);
  }

  const InkMap ink_;
  const std::vector<ViewSights>& views_;
  std::size_t lidars_;
  PlateRims rims_;
  const JointOptions& options_;
  JointInput input_;
  JointState state_;
  NeighbourTable neighbours_;
  JointAnswer answer_;
  std::vector<LidarReturns> returns_;                      ///< by LiDAR
  std::vector<std::vector<std::vector<Corner>>> corners_;  ///< [view][camera], ids settled
  std::vector<std::size_t> active_;                        ///< the views in input_
  bool placed_ = false;                  ///< see `boards_are_placed`; until then the returns are the finder's
  double damping_ = cold_damping;        ///< of the next solve's first step
  std::optional<JointProblem> problem_;  ///< of input_
};

}  // namespace

JointAnswer solve_joint(const Board& board, const std::vector<Camera>& cameras, int lidars,
                        const std::vector<ViewSights>& views, const RigSeed& seed,
                        const JointOptions& options) {
  return Solver(board, cameras, lidars, views, seed, options).run();
}

std::vector<Misfit> plane_misfits(const Board& board, const std::vector<Camera>& cameras, int lidars,
                                  const std::vector<ViewSights>& views, const RigSeed& seed,
                                  const JointOptions& options) {
  if (seed.by_rims) return {};
  return Solver(board, cameras, lidars, views, seed, options).plane_misfits(Solver::Disagreeing::kept);
}

}  // namespace ca2
