// The navigation engine of an emulated u-blox receiver: from one sample of the antenna to what the
// receiver claims to know. Start-up ladder, limits and masks of CFG-NAV5 and CFG-NAVX5, position
// hold, frozen course, accuracy without fix.
//
// What the settings allow (systems, masks, counts, dynamic model) goes to the engine behind the
// samples as a GnssCommand, which holds from the next epoch on; position, dilutions and accuracies
// are then of the satellites that it used. Where fewer count here than there (an epoch's time after
// a setting, and after a start without ephemerides, when a fix begins with four satellites and the
// others join as their orbits are received), dilutions are greater by the ratio of the two
// geometries, after such a start the accuracies, too; the position stays.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, sections 8 "Navigation Configuration
// Settings Description", 21 "Odometer" and 32.10.18 "UBX-CFG-NAV5"; the ladder from a recorded cold
// start of a NEO-7P; times to first fix from its data sheet (UBX-13003342).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/geodesy.h"
#include "emulators/ublox/settings.h"
#include "emulators/ublox/signal_security.h"
#include "emulators/ublox/solution.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

/// What the receiver still knows when it begins to navigate.
struct UbloxMemory {
  bool ephemerides = false;
  bool almanac = false;
  bool position = false;
  bool time = false;
  bool leap_seconds = false;

  [[nodiscard]] static UbloxMemory everything() { return {true, true, true, true, true}; }
  /// By navBbrMask of CFG-RST: what its bits do not clear.
  [[nodiscard]] static UbloxMemory after_clearing(std::uint16_t mask);
};

/// Faults that are active at an epoch.
struct UbloxNavigationFaults {
  bool frozen = false;
  std::int32_t leap_error_s = 0;
};

class UbloxNavigator {
 public:
  UbloxNavigator(const UbloxSettings& settings, const Calendar& calendar);

  /// Power-on or reset of the whole receiver: the counter of NAV-STATUS begins.
  void power_on(SimTime now) {
    powered_ = now;
    security_.restart();
  }
  /// Begins to search for satellites. The first time the settings' time to first fix counts; later
  /// what is remembered decides.
  void begin(SimTime now, const UbloxMemory& memory, const UbloxConfiguration& configuration);

  void take(const GnssSample& sample, const UbloxConfiguration& configuration,
            const UbloxNavigationFaults& faults);

  /// What the settings ask of the engine.
  [[nodiscard]] GnssCommand command(const UbloxConfiguration& configuration) const;

  /// After take(): the source of the solution's corrections, by code or carrier.
  void set_base(const std::optional<UbloxBase>& base) {
    if (base && solution_.differential && solution_.sample != nullptr) {
      solution_.differential_age_s = solution_.sample->differential_age_s;
    }
    solution_.base = solution_.differential_age_s ? base : std::nullopt;
  }
  /// After take(), for a base station: its survey, and its position if that is known, which it then
  /// reports whatever the satellites say.
  void set_own_place(const UbloxSurvey& survey,
                     const std::optional<std::array<double, 3>>& place_E_m);

  /// NAV-RESETODO.
  void reset_odometer();

  /// Aiding: a position with its accuracy, and that the time is known.
  void aid_position(const Geodetic& position, double accuracy_m);
  void aid_time(SimTime now, const UbloxConfiguration& configuration);

  [[nodiscard]] const UbloxSolution& solution() const { return solution_; }
  [[nodiscard]] const UbloxSignalSecurity& security() const { return security_; }

 private:
  struct Hold {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double ellipsoid_height_m = 0.0;
  };

  [[nodiscard]] UbloxTimeBase time_base(const UbloxConfiguration& configuration,
                                        std::int32_t leap_error_s) const;
  void climb(const GnssSample& sample, bool tracking);
  void hear_leap_seconds(const GnssSample& sample);
  void list_satellites(const GnssSample& sample, const UbloxConfiguration& configuration);
  [[nodiscard]] int dimensions_of(const GnssSample& sample,
                                  const UbloxConfiguration& configuration) const;
  [[nodiscard]] bool within_limits(const GnssSample& sample,
                                   const UbloxConfiguration& configuration) const;
  void take_dilutions(const GnssSample& sample);
  void lose_position(const GnssSample& sample, const UbloxConfiguration& configuration);
  void take_position(const GnssSample& sample, const UbloxConfiguration& configuration);
  void hold_position(const protocols::ubx::CfgNav5& limits);
  void filter_speed(const protocols::ubx::CfgOdo& odometer);
  void take_course(SimTime now, const protocols::ubx::CfgOdo& odometer);
  /// The course of slow motion, from positions; false where it is not to be had so.
  bool take_slow_course(SimTime now, const protocols::ubx::CfgOdo& odometer, double speed_mps);
  void count_distance(SimTime now, const protocols::ubx::CfgOdo& odometer);
  /// Before all orbits are received: only satellites whose orbit is known stay used.
  void keep_known_orbits(SimTime now);

  const Calendar calendar_;
  Duration cold_start_;
  std::int32_t default_leap_seconds_;
  UbloxSolution solution_;
  UbloxSignalSecurity security_;
  SimTime powered_ = kStart;
  SimTime searching_ = kStart;
  Duration time_to_first_fix_{0};
  bool begun_ = false;
  std::uint32_t starts_ = 0;  ///< After the first.
  bool had_fix_ = false;
  bool had_3d_fix_ = false;
  std::int64_t tracking_since_s_ = -1;  ///< GPS time of week; < 0 while nothing is tracked.
  std::optional<Hold> hold_;
  /// After a start without ephemerides: satellites whose orbit was received so far.
  bool hearing_orbits_ = false;
  std::vector<std::pair<GnssSystem, std::uint8_t>> heard_;
  bool had_course_ = false;
  /// Where the course of slow motion was last taken from, and when.
  struct Anchor {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    SimTime since{};
  };
  std::optional<Anchor> anchor_;
  SimTime counted_ = kNever;  ///< The odometer's last fix.
  /// By which accuracies are greater than the sample's: horizontal, vertical, time.
  std::array<double, 3> dilution_ratio_{1.0, 1.0, 1.0};
};

}  // namespace rigwire::emulators
