// What an HDL-64E says in the last two bytes of each data packet: time, state and calibration, one
// byte at a time (protocols/velodyne/status_channel.h).
#pragma once

#include <cstdint>
#include <optional>

#include "emulators/velodyne/time_input.h"
#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/model.h"
#include "protocols/velodyne/status_channel.h"

namespace rigwire::emulators {

/// The calibration that an HDL-64E of these settings measures and reports: as the status channel
/// can carry it. Nothing for other models.
[[nodiscard]] std::optional<protocols::velodyne::Hdl64eCalibration> unit_calibration(
    const VelodyneSettings& settings, const protocols::velodyne::Model& model);

class UnitReport {
 public:
  UnitReport(const protocols::velodyne::Model& model,
             const protocols::velodyne::Hdl64eCalibration& calibration,
             const VelodyneLiveSettings& live);

  /// Restarts the cycle of status bytes.
  void power_up() { packets_ = 0; }
  void settings_changed(const VelodyneLiveSettings& live);
  /// Returns the status byte of the next data packet, which is sent at `now`. The values of a cycle
  /// of 16 packets are those at its beginning.
  [[nodiscard]] protocols::velodyne::StatusByte next(SimTime now, const TimeInput& input);

 private:
  void fill(const VelodyneLiveSettings& live);

  protocols::velodyne::StatusRecord record_;
  protocols::velodyne::StatusChannel channel_;
  protocols::velodyne::StatusLive now_;
  std::uint64_t packets_ = 0;
};

}  // namespace rigwire::emulators
