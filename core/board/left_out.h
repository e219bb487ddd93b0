/// @file Types of boards that a build may be without.
#pragma once

#include <string_view>

namespace ca2 {

/// The CMake option that brings a type that this build was made without; empty for all other names.
std::string_view board_type_option(std::string_view name);

}  // namespace ca2
