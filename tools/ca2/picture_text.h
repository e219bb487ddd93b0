/// @file Pictures in a terminal's characters (libchafa).
#pragma once

#include <string>
#include <vector>

#include "core/types/image.h"

namespace ca2 {

/// 8-bit grey or colour, fitted into the columns and rows with its proportions kept. `true_colour`: 24 bits;
/// else the 256 colours that every terminal has.
std::vector<std::string> picture_text(const Image& image, int columns, int rows, bool true_colour);

}  // namespace ca2
