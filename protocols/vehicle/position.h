// Where a vehicle is, by satellites: VP, VDS and VP2.
//
// Bearings run clockwise from north, unlike the other angles of this folder. Altitude is above mean
// sea level.
//
// Sources: SAE J1939 digital annex (VP, VDS); VP2 as in can-utils, j1939_vehicle_position.
#pragma once

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// One count of 1e-7 degree, from -210 degrees.
inline constexpr Scale kGeodetic{1e-7, -210.0, "deg"};
/// One count of 1/128 degree.
inline constexpr Scale kBearing{kDegree_rad / 128.0, 0.0, "rad", kInDegree};
/// One count of 1/128 degree, from -200 degrees.
inline constexpr Scale kPitch{kDegree_rad / 128.0, -200.0 * kDegree_rad, "rad", kInDegree};
/// One count of 1/256 km/h.
inline constexpr Scale kNavigationSpeed{kKilometrePerHour_mps / 256.0, 0.0, "m/s",
                                        kInKilometrePerHour};
/// One count of 1/8 m, from -2500 m.
inline constexpr Scale kAltitude{0.125, -2500.0, "m"};
inline constexpr Scale kDilution{0.1, 0.0, "1"};

/// Vehicle Position.
struct VehiclePosition {
  static constexpr Group kGroup{"VP", 65267, 6, std::chrono::milliseconds{5000}};

  double latitude_deg = kNotAvailable;
  double longitude_deg = kNotAvailable;

  static constexpr auto parameters() {
    using M = VehiclePosition;
    return std::array{
        number("latitude", 584, {1}, 32, kGeodetic, &M::latitude_deg),
        number("longitude", 585, {5}, 32, kGeodetic, &M::longitude_deg),
    };
  }
};

/// Vehicle Direction/Speed. Sent on request or as often as its sender likes.
struct VehicleDirectionSpeed {
  static constexpr Group kGroup{"VDS", 65256, 6, std::chrono::milliseconds{0}};

  double bearing_rad = kNotAvailable;
  double speed_mps = kNotAvailable;
  double pitch_rad = kNotAvailable;  ///< Nose up positive.
  double altitude_m = kNotAvailable;

  static constexpr auto parameters() {
    using M = VehicleDirectionSpeed;
    return std::array{
        number("compass bearing", 165, {1}, 16, kBearing, &M::bearing_rad),
        number("navigation-based vehicle speed", 517, {3}, 16, kNavigationSpeed, &M::speed_mps),
        number("pitch", 583, {5}, 16, kPitch, &M::pitch_rad),
        number("altitude", 580, {7}, 16, kAltitude, &M::altitude_m),
    };
  }
};

/// Vehicle Position 2: how good the position is.
struct VehiclePosition2 {
  static constexpr Group kGroup{"VP2", 64502, 6, std::chrono::milliseconds{5000}};

  double satellites = kNotAvailable;  ///< In view.
  double horizontal_dilution = kNotAvailable;
  double vertical_dilution = kNotAvailable;
  double position_dilution = kNotAvailable;
  double time_dilution = kNotAvailable;

  static constexpr auto parameters() {
    using M = VehiclePosition2;
    return std::array{
        number("satellites in view", 8128, {1}, 8, {1.0, 0.0, "1"}, &M::satellites),
        number("horizontal dilution", 8129, {2}, 8, kDilution, &M::horizontal_dilution),
        number("vertical dilution", 8130, {3}, 8, kDilution, &M::vertical_dilution),
        number("position dilution", 8131, {4}, 8, kDilution, &M::position_dilution),
        number("time dilution", 8132, {5}, 8, kDilution, &M::time_dilution),
    };
  }
};

}  // namespace rigwire::protocols::vehicle
