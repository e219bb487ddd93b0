#include "core/solve/half_turn.h"

namespace ca2 {

Pose half_turned(const Pose& T_sensor_board) {
  Pose turned = T_sensor_board;
  turned.R.col(0) = -turned.R.col(0);
  turned.R.col(1) = -turned.R.col(1);
  return turned;
}

void turn_ids(std::vector<Corner>& corners, int count) {
  for (Corner& corner : corners) corner.id = count - 1 - corner.id;
}

}  // namespace ca2
