/// The search against views whose misfit is known in closed form.
#include "core/solve/shared_error.h"

#include <gtest/gtest.h>

#include <vector>

namespace ca2 {
namespace {

/// Views with these standard deviations (m) of their own that err together by `truth` (m): degrees of freedom
/// over misfit, where `error` is taken into account.
double share(const std::vector<double>& sigmas, double truth, double error) {
  double misfit = 0;
  for (const double sigma : sigmas)
    misfit += (sigma * sigma + truth * truth) / (sigma * sigma + error * error);
  return static_cast<double>(sigmas.size()) / misfit;
}

struct Found {
  double error = 0;
  int tries = 0;
};

Found search(const std::vector<double>& sigmas, double truth) {
  Found found;
  SharedErrorSearch search(share(sigmas, truth, 0));
  while (const auto error = search.next()) {
    found = {*error, found.tries + 1};
    search.take(share(sigmas, truth, *error));
  }
  return found;
}

TEST(SharedError, IsFoundToAPercentInAFewTries) {
  for (const double truth : {0.0003, 0.001, 0.004, 0.02}) {
    for (const std::vector<double>& sigmas :
         {std::vector<double>{0.001}, {0.0002, 0.0003, 0.0002}, {0.0001, 0.001, 0.01, 0.0005}}) {
      const Found found = search(sigmas, truth);
      EXPECT_NEAR(found.error / truth, 1, 0.02) << truth;
      EXPECT_LE(found.tries, 8) << truth;
    }
  }
}

/// Nothing explains a misfit that does not change, or one beyond what is looked for: it ends within its
/// bounds.
TEST(SharedError, EndsWhereNothingIsFound) {
  SharedErrorSearch stuck(0.5);
  int tries = 0;
  while (const auto error = stuck.next()) {
    EXPECT_GE(*error, 1e-4);
    EXPECT_LE(*error, 0.05);
    ++tries;
    stuck.take(0.5);
  }
  EXPECT_LE(tries, 8);
  const Found beyond = search({0.001}, 1.0);
  EXPECT_GT(beyond.error, 0.02);
  EXPECT_LE(beyond.error, 0.05);
}

}  // namespace
}  // namespace ca2
