// Engine, automated friction clutch, step gearbox with crawler group, differentials with locks.
//
// A shift ramps engine torque and clutch capacity down, changes the ratio with the clutch open,
// brings the engine near the new gear's speed, and closes the clutch again; the clutch merges the
// remaining difference of speed, keeping angular momentum. A gear is not engaged while it would
// turn the engine above its maximum speed, or backwards faster than idle. The crawler group changes
// only near standstill.
#pragma once

#include "sim/driveline/clutched_driveline.h"
#include "sim/driveline/shift_sequence.h"

namespace rigwire::sim {

class GearedDriveline final : public ClutchedDriveline {
 public:
  /// In neutral, at idle. Throws as validate() does.
  explicit GearedDriveline(const GearedParameters& parameters);

  [[nodiscard]] bool has(const GearSelection& selection) const;
  /// Gearbox input to output, reverse negative; 0 in neutral and for a gear that does not exist.
  [[nodiscard]] double gear_ratio(const GearSelection& selection) const;

  /// The highest gear in which the engine has kSelected of its speeds at the target, reached gear
  /// by gear as the wheels speed up; at standstill no higher than the launching gear.
  [[nodiscard]] int select_gear(double rate_radps, double target_radps, int lower) const override;

 private:
  /// Share of the engine's way from idle to maximum that a gear is chosen for.
  static constexpr double kSelected = 0.35;
  /// A gear is left for a lower one below this share of that speed.
  static constexpr double kLeft = 0.75;
  /// The vehicle can launch in gears with at least this share of the first one's ratio.
  static constexpr double kLaunches = 0.45;

  void request(const VehicleCommand& command) override;
  void advance(double h, double output_radps, Transmission& transmission) override;
  [[nodiscard]] bool permitted(double output_radps) const;

  GearboxParameters gearbox_;
  ShiftSequence shift_;
};

}  // namespace rigwire::sim
