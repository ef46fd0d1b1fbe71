// Engine, centrifugal clutch, belt variator, range groups, differentials with locks.
//
// The variator's ratio follows the engine's speed (flyweights) with a lag; the engine's inertia
// takes part in each change of ratio through the clutch. Gears are the range groups; they change
// near standstill and with the clutch open only.
#pragma once

#include "sim/driveline/clutched_driveline.h"

namespace rigwire::sim {

class CvtDriveline final : public ClutchedDriveline {
 public:
  /// In neutral, at idle, the variator at launch. Throws as validate() does.
  explicit CvtDriveline(const CvtParameters& parameters);

  /// The slowest range that reaches the target with its variator at top; only near standstill.
  [[nodiscard]] int select_gear(double rate_radps, double target_radps, int lower) const override;

 private:
  void request(const VehicleCommand& command) override;
  void advance(double h, double output_radps, Transmission& transmission) override;
  [[nodiscard]] double range_ratio(int gear) const;

  VariatorParameters variator_;
  double variator_ratio_;
  int gear_ = 0;
  int target_ = 0;
};

}  // namespace rigwire::sim
