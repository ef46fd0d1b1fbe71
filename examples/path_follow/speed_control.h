// Speed through engine, gear and brake: the engine's governor is asked for the speed that belongs
// to the wish in the engaged gear, which is learnt while driving; the brake takes what the engine's
// drag does not.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace rigwire::path_follow {

struct SpeedControlSettings {
  /// Engine speed over road speed in each forward gear, rad/s per m/s, to begin with. Unimog U5023
  /// on 395/85 R20; estimates.
  std::array<double, 8> engine_per_speed{118.2, 82.1, 57.0, 39.6, 27.5, 19.1, 13.3, 9.2};
  double engine_idle_radps = 78.0;     ///< 745 rpm: the automated clutch is about to close.
  double engine_most_radps = 225.0;    ///< 2150 rpm.
  double engine_cruise_radps = 180.0;  ///< The gear is the highest that needs less at the cruise...
  double engine_least_radps = 112.0;   ///< ... and more than this.
  double gain = 0.8;                   ///< Gain of the speed error.
  double integral_per_s = 0.4;
  double brake_from_mps = 0.25;  ///< The brake begins at this much above the set speed.
  double brake_gain_per_s = 1.5;
  double brake_most_mps2 = 3.0;
};

struct SpeedOutput {
  double engine_radps = 0.0;
  double brake_mps2 = 0.0;
};

class SpeedControl {
 public:
  /// `gear`: fixed; nothing: chosen for the cruise speed.
  SpeedControl(const SpeedControlSettings& settings, double cruise_mps, std::optional<int> gear);

  [[nodiscard]] int gear() const { return gear_; }
  [[nodiscard]] SpeedOutput update(double wish_mps, double speed_mps, double engine_radps,
                                   bool in_gear, double step_s);

 private:
  SpeedControlSettings settings_;
  int gear_ = 1;
  double engine_per_speed_;  ///< Learnt.
  double integral_mps_ = 0.0;
};

}  // namespace rigwire::path_follow
