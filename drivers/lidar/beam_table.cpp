#include "drivers/lidar/beam_table.h"
