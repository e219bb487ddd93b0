#include "drivers/lidar/ouster/profile.h"

namespace ca2 {

// Ouster Firmware User Manual, "Lidar Data Packet Format"; those of firmware 3.2 from the vendor's library.
const std::vector<OusterProfile>& ouster_profiles() {
  constexpr OusterField none{};
  constexpr OusterField rng19{0, 19, 0}, rng19_second{32, 19, 0};
  constexpr OusterField rng15{0, 15, 3}, rng15_second{32, 15, 3};
  static const std::vector<OusterProfile> profiles{
      {"LEGACY", 12, {{0, 20, 0}, none}, {{32, 8, 0}, none}, {{48, 16, 0}, none}, {64, 16, 0}},
      {"RNG19_RFL8_SIG16_NIR16", 12, {rng19, none}, {{32, 8, 0}, none}, {{48, 16, 0}, none}, {64, 16, 0}},
      {"RNG19_RFL8_SIG16_NIR16_DUAL",
       16,
       {rng19, rng19_second},
       {{24, 8, 0}, {56, 8, 0}},
       {{64, 16, 0}, {80, 16, 0}},
       {96, 16, 0}},
      {"RNG15_RFL8_NIR8", 4, {rng15, none}, {{16, 8, 0}, none}, {none, none}, {24, 8, 4}},
      {"FIVE_WORD_PIXEL",
       20,
       {rng19, rng19_second},
       {{24, 8, 0}, {56, 8, 0}},
       {{64, 16, 0}, {80, 16, 0}},
       {96, 16, 0}},
      {"FUSA_RNG15_RFL8_NIR8_DUAL",
       8,
       {rng15, rng15_second},
       {{16, 8, 0}, {48, 8, 0}},
       {none, none},
       {24, 8, 4}},
      {"RNG15_RFL8_NIR8_DUAL", 8, {rng15, rng15_second}, {{16, 8, 0}, {48, 8, 0}}, {none, none}, {24, 8, 4}},
      {"RNG15_RFL8_NIR8_ZONE16", 8, {rng15, none}, {{16, 8, 0}, none}, {none, none}, {24, 8, 4}},
      {"RNG19_RFL8_SIG16_NIR16_ZONE16",
       12,
       {rng19, none},
       {{32, 8, 0}, none},
       {{48, 16, 0}, none},
       {64, 16, 0}},
      {"RNG15_RFL8_WIN8", 4, {rng15, none}, {{16, 8, 0}, none}, {none, none}, none},
      {"RNG19_RFL8_SIG16_ZONE16_DUAL",
       16,
       {rng19, rng19_second},
       {{24, 8, 0}, {56, 8, 0}},
       {{64, 16, 0}, {80, 16, 0}},
       none},
      {"RNG19_RFL8_SIG16_NIR16_RGB16",
       16,
       {rng19, none},
       {{24, 8, 0}, none},
       {{32, 16, 0}, none},
       {48, 16, 0}},
      {"RNG19_RFL8_SIG16_NIR16_RGB16_DUAL",
       20,
       {rng19, rng19_second},
       {{24, 8, 0}, {56, 8, 0}},
       {{64, 16, 0}, {80, 16, 0}},
       {96, 16, 0}},
  };
  return profiles;
}

const OusterProfile* find_ouster_profile(std::string_view name) {
  for (const OusterProfile& profile : ouster_profiles()) {
    if (profile.name == name) return &profile;
  }
  return nullptr;
}

}  // namespace ca2
