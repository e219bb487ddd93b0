/// @file The returns of an Ouster's column as points, for every kind of processor.
#pragma once

#include <cstddef>

#include "drivers/lidar/ouster/geometry.h"
#include "drivers/lidar/return_writer.h"

namespace ca2::detail {

// The geometry's formula in single precision: within 2e-7 of the range, 20 um at 100 m, where the sensor's
// step is 1 mm. Rows without a return are computed too, which is cheaper than a branch taken at random.

/// Ranges in mm, readable up to the next multiple of lanes::count.
void project_ouster_column(const OusterGeometry& geometry, std::size_t column, const std::uint32_t* ranges,
                           int rows, FiredBeams& out);

#if defined(__x86_64__)
/// The same numbers, written in the same step as write_returns_portable() writes; only where has_avx512().
/// `names` need not be readable beyond its beams.
std::size_t write_ouster_column_avx512(const OusterGeometry& geometry, std::size_t column,
                                       const FiredNames& names, const ReturnTargets& out, std::size_t at);
#endif

}  // namespace ca2::detail
