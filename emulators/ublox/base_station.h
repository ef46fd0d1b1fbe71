// Where a u-blox receiver stands when it is a base station: CFG-TMODE, the mode that is fixed and
// the survey that finds the place.
//
// A survey takes the mean of all positions of fixes, and ends when both its least duration and its
// accuracy are reached. The mean's accuracy follows from that of its positions: their errors keep
// for a minute, so the mean of a time T is better by sqrt(1 + T / 60 s); the place is as good as
// the signals let it be, no better. With the place known the receiver reports time only (fix type
// 5) and that place.
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
  /// Its own fix says that it stands elsewhere, by more than 50 m; once for each place.
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
