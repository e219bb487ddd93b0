#include "core/guidance/choose_views.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace ca2 {
namespace {

// Before three views nothing is determined and all costs are infinite: this much is said to be known then, so
// that the first views have an order.
constexpr double vague_translation = 1;  // m
constexpr double vague_rotation = 1;     // rad

class Chooser {
 public:
  Chooser(const std::vector<PairInformation>& views, const PairInformation& prior, const SigmaTarget& target)
      : views_(views), prior_(prior), target_(target) {
    for (int i = 0; i < 3; ++i) {
      prior_(i, i) += 1 / (vague_rotation * vague_rotation);
      prior_(i + 3, i + 3) += 1 / (vague_translation * vague_translation);
    }
  }

  double cost(const PairInformation& information) const { return expected_sigma(information, target_).cost; }

  PairInformation sum(const std::vector<std::size_t>& chosen) const {
    PairInformation total = prior_;
    for (const std::size_t i : chosen) total += views_[i];
    return total;
  }

  /// Adds the view that helps most, until there are `count`.
  void fill(std::vector<std::size_t>& chosen, std::size_t count) const {
    PairInformation total = sum(chosen);
    while (chosen.size() < count) {
      std::size_t best = views_.size();
      double least = 0;
      for (std::size_t i = 0; i < views_.size(); ++i) {
        if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
        const double here = cost(total + views_[i]);
        if (best == views_.size() || here < least) best = i, least = here;
      }
      chosen.push_back(best);
      total += views_[best];
    }
  }

  /// Exchanges one chosen view for one that is not, the best exchange first, while that helps.
  void exchange(std::vector<std::size_t>& chosen) const {
    double least = cost(sum(chosen));
    for (bool better = true; better;) {
      better = false;
      std::size_t out = 0, in = 0;
      const PairInformation total = sum(chosen);
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        const PairInformation without = total - views_[chosen[k]];
        for (std::size_t i = 0; i < views_.size(); ++i) {
          if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
          const double here = cost(without + views_[i]);
          if (here < least * (1 - 1e-9)) least = here, out = k, in = i, better = true;
        }
      }
      if (better) chosen[out] = in;
    }
  }

 private:
  const std::vector<PairInformation>& views_;
  PairInformation prior_;
  SigmaTarget target_;
};

}  // namespace

std::vector<std::size_t> choose_views(const std::vector<PairInformation>& views, std::size_t count,
                                      const PairInformation& prior, const SigmaTarget& target) {
  std::vector<std::size_t> best(views.size());
  std::iota(best.begin(), best.end(), std::size_t{0});
  if (count >= views.size()) return best;
  const Chooser chooser(views, prior, target);
  // Greedy choices are as good as their beginning: with many views a few beginnings do.
  const std::size_t step = std::max<std::size_t>(1, views.size() / 8);
  double least = std::numeric_limits<double>::infinity();
  best.clear();
  for (std::size_t first = 0; count > 0 && first < views.size(); first += step) {
    std::vector<std::size_t> chosen{first};
    chooser.fill(chosen, count);
    chooser.exchange(chosen);
    const double here = chooser.cost(chooser.sum(chosen));
    if (here < least) best = chosen, least = here;
  }
  std::sort(best.begin(), best.end());
  return best;
}

}  // namespace ca2
