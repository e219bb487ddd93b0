/// @file What to say to who asks for a type of board that is not there.
#pragma once

#include <string>
#include <string_view>

namespace ca2 {

/// What to do about a name that is no type's: the CMake option that brings a type that this build was made
/// without, or the nearest name.
std::string board_type_hint(std::string_view name);

}  // namespace ca2
