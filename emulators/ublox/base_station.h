// The position of a u-blox receiver that is a base station: CFG-TMODE, with the mode of a fixed
// position and the survey that finds it.
//
// A survey takes the mean of all positions of fixes, and ends when both its minimum duration and
// its accuracy are reached. The mean's accuracy follows from that of its positions: their errors
// persist for a minute, so the mean of a time T is better by sqrt(1 + T / 60 s); the position is no
// better than the signals allow. With the position known the receiver reports it and time only (fix
// type 5).
//
// Sources: ZED-F9P integration manual UBX-18010802, section 3.1.5.4 "Base station"; interface
// description HPG 1.32 UBX-22008968, UBX-CFG-TMODE3, UBX-NAV-SVIN, CFG-TMODE. How the mean's
// accuracy falls is chosen here.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "emulators/ublox/solution.h"
#include "protocols/ubx/configuration.h"

namespace rigwire::emulators {

class UbloxBaseStation {
 public:
  /// A navigation epoch, before its messages. A change of settings begins anew.
  void update(SimTime now, const protocols::ubx::CfgTmode3& settings,
              const UbloxSolution& solution);
  /// The receiver starts anew: a survey does, too.
  void restart() { settings_.reset(); }

  /// Earth-fixed; nothing unless it is known.
  [[nodiscard]] const std::optional<std::array<double, 3>>& place_E_m() const { return place_E_m_; }
  [[nodiscard]] const UbloxSurvey& survey() const { return survey_; }
  /// Returns whether its own fix is more than 50 m away; true once for each place.
  [[nodiscard]] bool seems_wrong(const UbloxSolution& solution);

 private:
  void begin(SimTime now, const protocols::ubx::CfgTmode3& settings);

  std::optional<protocols::ubx::CfgTmode3> settings_;
  std::optional<std::array<double, 3>> place_E_m_;
  UbloxSurvey survey_;
  SimTime begun_ = kNever;
  double squares_m2_ = 0.0;  ///< Mean square of the positions' accuracies.
  bool warned_ = false;
};

}  // namespace rigwire::emulators
