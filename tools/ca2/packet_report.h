/// @file Packet counters for people and for programs.
#pragma once

#include <cstdio>
#include <nlohmann/json_fwd.hpp>

#include "drivers/net/packet_counters.h"

namespace ca2 {

/// The counters that are not zero, a line each.
void print_counters(std::FILE* file, const PacketCounters& counters);

/// All counters by name, and "lost", their sum over what was not delivered.
nlohmann::json counters_json(const PacketCounters& counters);

}  // namespace ca2
