// What the vehicle gateway knows by satellites, when a receiver is wired to it: VP and VDS every
// second, VP2 every five.
//
// The latest fix counts until it is kStale old; then everything is not available.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "emulators/j1939/position_report.h"
#include "emulators/vehicle_gateway/report.h"
#include "protocols/can/frame.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

class VehicleSatellites {
 public:
  static constexpr Duration kStale = std::chrono::seconds{2};

  [[nodiscard]] static std::span<const VehicleReport::Entry> schedule();

  void take(const GnssSample& sample);
  /// The frame of group `pgn`, if it is one of schedule().
  [[nodiscard]] std::optional<protocols::can::Frame> frame(SimTime now, std::uint32_t pgn,
                                                           std::uint8_t source) const;

 private:
  PositionReport report_;
  std::optional<SimTime> taken_at_;
};

}  // namespace rigwire::emulators
