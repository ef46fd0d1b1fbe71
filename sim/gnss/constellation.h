// Where the GPS satellites are: the nominal 24 slots, propagated over GPS time.
//
// Source: GPS Standard Positioning Service Performance Standard, nominal 24-slot constellation,
// epoch 1993-07-01 00:00 UTC: circular orbits, a = 26559.7 km, inclination 55 deg, Greenwich angle
// 18 h 36 m 14.4 s. No perturbations: slots keep their places relative to each other, as the real
// satellites are kept in theirs. Directions differ from today's by what satellites really fly
// (31 instead of 24), not by an error of use to anybody.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/samples/calendar.h"

namespace rigwire::sim {

inline constexpr std::size_t kGpsSlots = 24;

/// Earth-centred earth-fixed position of slot 0..23 (A1..A4, B1.., F4; PRN = slot + 1), m.
[[nodiscard]] Eigen::Vector3d gps_satellite_ecef(std::size_t slot, const GpsTime& time);

/// All slots at once.
[[nodiscard]] std::array<Eigen::Vector3d, kGpsSlots> gps_constellation_ecef(const GpsTime& time);

}  // namespace rigwire::sim
