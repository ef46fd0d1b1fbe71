// What an emulated u-blox receiver knows at one navigation epoch, in SI units:
// navigation_messages.h and nmea_epoch.h say it on the wire.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sim/samples/calendar.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::emulators {

/// A base station as its messages describe it.
struct UbloxBase {
  std::uint16_t station = 0;
  SimTime measured{};
  std::array<double, 3> position_E_m{};
  std::array<double, 3> velocity_E_mps{};  ///< 0 unless it moves.
  bool moving = false;

  /// Returns its position at `time`, extrapolated with its velocity.
  [[nodiscard]] std::array<double, 3> at(SimTime time) const;
};

/// How far the survey of a base station's own place is: NAV-SVIN.
struct UbloxSurvey {
  bool active = false;
  bool valid = false;
  std::uint32_t duration_s = 0;
  std::uint32_t observations = 0;
  std::array<double, 3> mean_E_m{};
  double accuracy_m = 0.0;
};

struct UbloxSolution {
  bool time_known = false;            ///< Time of day.
  bool date_known = false;            ///< Date and week.
  bool leap_known = false;            ///< leap_seconds was received, not the firmware's.
  bool orbits_known = false;          ///< Elevation and azimuth of satellites can be said.
  std::uint32_t time_of_week_ms = 0;  ///< Label of the epoch; since start while time is unknown.
  std::int32_t time_of_week_rest_ns = 0;  ///< The measurement less time_of_week_ms.
  std::int32_t week = 0;                  ///< Resolved by the firmware's first week.
  std::int32_t week_shift = 0;            ///< week less the true one, when the date is known.
  std::int32_t leap_seconds = 0;
  UtcTime utc;                   ///< Rounded to 1/100 s, so that 23:59:59.996 is the next day.
  std::int32_t utc_rest_ns = 0;  ///< The measurement less the full second in `utc`; may be < 0.
  std::uint32_t since_start_ms = 0;
  std::uint32_t first_fix_ms = 0;  ///< 0 while there was none.

  int dimensions = 0;         ///< 0 (no fix), 2 or 3. At 0 the position is the last one.
  bool fix_ok = false;        ///< A fix within the limits of CFG-NAV5.
  bool differential = false;  ///< SBAS or other corrections are applied.
  std::optional<double> differential_age_s;
  CarrierSolution carrier = CarrierSolution::none;
  /// Base station whose corrections are used: its position at this epoch, and its identity.
  std::optional<UbloxBase> base;
  bool time_only = false;  ///< Its own position is known (base station): fix type 5.
  UbloxSurvey survey;
  std::uint8_t spoofing = 0;  ///< NAV-STATUS spoofDetState of this epoch.
  bool has_position = false;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double ellipsoid_height_m = 0.0;
  double geoid_separation_m = 0.0;
  Vector3 velocity_ned_mps;
  double heading_deg = 0.0;  ///< Heading of motion, 0..360; the last one while frozen.
  double heading_accuracy_deg = 180.0;
  bool heading_frozen = true;
  double horizontal_accuracy_m = std::numeric_limits<double>::infinity();
  double vertical_accuracy_m = std::numeric_limits<double>::infinity();
  double speed_accuracy_mps = std::numeric_limits<double>::infinity();
  double time_accuracy_s = std::numeric_limits<double>::infinity();
  /// GnssSample::position_covariance_ned_m2, or computed from the accuracies if that was not given.
  std::array<double, 6> position_covariance_ned_m2{};
  double clock_bias_s = 0.0;  ///< time_of_week_rest_ns + this is a whole number of milliseconds.
  double clock_drift = 0.0;
  double horizontal_dilution = std::numeric_limits<double>::quiet_NaN();
  double vertical_dilution = std::numeric_limits<double>::quiet_NaN();
  double position_dilution = std::numeric_limits<double>::quiet_NaN();
  double time_dilution = std::numeric_limits<double>::quiet_NaN();
  double north_dilution = std::numeric_limits<double>::quiet_NaN();
  double east_dilution = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = 0.0;            ///< In space, filtered when CFG-ODO says so: NAV-VELNED alone.
  double distance_m = 0.0;           ///< Odometer: since NAV-RESETODO ...
  double distance_accuracy_m = 0.0;  ///< ... with this standard deviation,
  double total_distance_m = 0.0;     ///< and since the last cold start.
  std::vector<SatelliteView> satellites;  ///< Known so far; `used` and `tracked` as the receiver's.
  int satellites_used = 0;

  /// The sample behind it, for raw measurements; null before the first one. Owned by the receiver.
  const GnssSample* sample = nullptr;
};

/// How a receiver resolves weeks and leap seconds that the satellites do not give.
struct UbloxTimeBase {
  std::int32_t first_week = 1691;  ///< The 10-bit week is that of the 1024 weeks from here on.
  std::int32_t default_leap_seconds = 16;  ///< While solution.leap_known is false.
  std::int32_t leap_error_s = 0;           ///< Fault.
};

/// Fills the time fields of an epoch that was wanted at `epoch` and measured `measured_after`
/// later; by since_start_ms while time is unknown.
void set_time(UbloxSolution& solution, const Calendar& calendar, const UbloxTimeBase& base,
              SimTime epoch, Duration measured_after);

}  // namespace rigwire::emulators
