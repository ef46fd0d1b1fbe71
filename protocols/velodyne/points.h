// From decoded data packets to measurements in SI units: what a client wants.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/packet_layout.h"

namespace rigwire::protocols::velodyne {

enum class PointEcho : std::uint8_t {
  strongest,  ///< In a dual return the second strongest, where the last is the strongest.
  last,
  both,  ///< Dual return, both say the same: there was one echo.
};

/// One measured return. Frame of the sensor, x forward, y left, z up, origin on the spin axis at
/// the height of the horizontal laser's exit (HDL-64E: at the foot of the sensor).
struct Point {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  float range_m = 0.0F;      ///< From the beam's exit.
  float azimuth_rad = 0.0F;  ///< Clockwise from forward, [0, 2 pi), at the laser's own instant,
                             ///< with the laser's azimuth offset.
  float elevation_rad = 0.0F;
  std::int32_t packet_offset_ns = 0;  ///< Fired so long after the packet's timestamp.
  std::uint8_t laser = 0;
  std::uint8_t reflectivity = 0;
  PointEcho echo = PointEcho::strongest;
};

/// Reads the packets of one sensor in the order in which they came.
///
/// The azimuth of each laser is the block's, moved on with the rotor, because the head turns by
/// 0.13 degrees while an HDL-32E fires at 600 rpm. The rotor's speed is the mean over the packet,
/// of those steps from firing to firing that a rotor can make within its limits: larger ones are
/// gaps of the view window (or lost firings), backward ones none at all. A packet without a step
/// (VLS-128, two returns: one firing) takes the speed from the packet before it.
///
/// Errors: range half a distance unit; azimuth 0.005 degrees from the field and 0.001 from the
/// speed.
class PointReader {
 public:
  /// With a calibration (of an HDL-64E, validated) ranges and positions are after it.
  explicit PointReader(const Model& model,
                       const std::optional<Hdl64eCalibration>& calibration = {});

  /// Appends the points of a packet to `points`; channels without echo make none.
  void append(const DataPacket& packet, std::vector<Point>& points);

 private:
  /// What is the same of a laser at every shot.
  struct Optics {
    double azimuth_deg = 0.0;  ///< Before the rotor's.
    double elevation_rad = 0.0;
    BeamDirection direction;  ///< The rotor at 0.
    double right_m = 0.0;     ///< Where the beam leaves.
    double up_m = 0.0;
  };
  /// Azimuth of the rotor.
  struct Heading {
    double deg = 0.0;
    double cos = 1.0;
    double sin = 0.0;
  };

  void lay_out(ReturnMode mode);
  [[nodiscard]] double counts_per_ns(const DataPacket& packet, ReturnMode mode) const;
  [[nodiscard]] Point point(const Channel& channel, std::size_t laser,
                            const Heading& heading) const;

  const Model* model_;
  std::optional<Hdl64eCalibration> calibration_;
  std::vector<Optics> optics_;  ///< By laser.
  /// What each place holds in a packet of that mode, block by block; empty: none has come.
  std::vector<Shot> shots_;
  ReturnMode mode_{};
  std::optional<std::uint16_t> previous_azimuth_counts_;
  std::uint32_t previous_timestamp_us_ = 0;
};

}  // namespace rigwire::protocols::velodyne
