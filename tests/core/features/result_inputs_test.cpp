#include "core/features/result_inputs.h"

#include <gtest/gtest.h>

#include "tests/core/session/rig_text.h"

namespace ca2 {
namespace {

/// Digests as they are written today: with others, all results that were ever made would be called outdated.
TEST(ResultInputs, DigestsOfARigStayAsTheyAre) {
  Session session;
  session.rig = parse_rig(test::rig_text, "rig.yaml").value();
  const std::map<std::string, std::string> expected{
      {"board", "8bea8514ed9d923a"},         {"cameras.left", "b4e3f6f83ff3a0e2"},
      {"cameras.right", "44dcbd33529c5401"}, {"extrinsics", "a63646d36ce14af8"},
      {"lidars.front", "09304995bfb11e7f"},  {"lidars.top", "e5d32d9eb941470c"}};
  EXPECT_EQ(result_inputs(session, {}).rig, expected);
}

}  // namespace
}  // namespace ca2
