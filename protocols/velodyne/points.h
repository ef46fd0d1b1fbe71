// From a decoded data packet to measurements in SI units: what a client wants.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"

namespace rigwire::protocols::velodyne {

/// One measured return. Frame of the sensor, x forward, y left, z up, origin on the spin axis at
/// the height of the horizontal laser's exit.
struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  float range_m = 0.0F;      ///< From the beam's exit.
  float azimuth_rad = 0.0F;  ///< Clockwise from forward, [0, 2 pi), at the laser's own instant.
  float elevation_rad = 0.0F;
  std::int32_t packet_offset_ns = 0;  ///< Fired so long after the packet's timestamp.
  std::uint8_t laser = 0;
  std::uint8_t reflectivity = 0;
};

/// Appends the points of a single-return packet to `points`; empty channels make none.
///
/// The azimuth of each laser is interpolated in time between this block's azimuth and the next
/// one's (the last block uses the step before it), because the head turns by 0.13 degrees while it
/// fires at 600 rpm. Steps of half a turn and more cannot come from a rotor and count as no step.
/// Errors: range half a distance unit, azimuth 0.005 degrees from the field plus the share of the
/// rounding of the neighbour.
void append_points(const DataPacket& packet, const Model& model, std::vector<Point>& points);

}  // namespace rigwire::protocols::velodyne
