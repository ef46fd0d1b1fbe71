// What is done to a receiver's signals: a book of faults, and what they amount to at an instant.
//
//   faults:
//     - {type: jamming, at: 30 s, for: 10 s, loss: 15 dB}
//     - {type: jamming, at: 50 s, for: 10 s, loss: 15 dB, band: l2}
//     - {type: jump, at: 60 s, for: 5 s, offset: [20 m, 0 m, 0 m]}
//
// Overlaps: antenna faults and an outage leave no signal, whatever else goes on (a short-circuited
// antenna is reported before an open one); jamming adds up in dB, band by band; jumps and spoof
// drifts add up in metres. Faults are of simulated time, so that a run repeats.
#pragma once

#include <Eigen/Core>
#include <variant>

#include "fields/rules.h"
#include "sim/samples/fault_book.h"
#include "sim/samples/gnss_sample.h"

namespace rigwire::sim {

/// Jammed part of the spectrum: L1, E1, B1 (1559 to 1610 MHz) or L2, E5b, B2 (1191 to 1254 MHz).
/// Receivers of two bands have a radio part for each.
enum class JammedBand : unsigned char { all, l1, l2 };

struct OutageFault {
  static constexpr fields::Named kNamed{"outage", "No signal arrives; the antenna is well."};
};
struct JammingFault {
  static constexpr fields::Named kNamed{"jamming",
                                        "Carrier-to-noise density falls, the noise floor rises."};

  double loss_db = 20.0;
  Duration ramp{0};
  JammedBand band = JammedBand::all;

  void grow(double share) { loss_db *= share; }
};
struct SpoofDriftFault {
  static constexpr fields::Named kNamed{
      "spoofing", "Strong false signals, consistent with each other, drift away."};

  Eigen::Vector3d velocity_mps = Eigen::Vector3d::UnitX();  ///< East, north, up.
  double clock_rate_mps = 0.0;                              ///< Rate common to all ranges.
};
struct JumpFault {
  static constexpr fields::Named kNamed{"jump", "The signals of a place beside the true one."};

  Eigen::Vector3d offset_m{10.0, 0.0, 0.0};  ///< East, north, up.
  Duration ramp{0};

  void grow(double share) { offset_m *= share; }
};
struct AntennaShortFault {
  static constexpr fields::Named kNamed{"short", "Short circuit of the antenna's supply."};
};
struct AntennaOpenFault {
  static constexpr fields::Named kNamed{"open", "Nothing on the antenna's plug."};
};
struct CorrectionOutageFault {
  static constexpr fields::Named kNamed{"correction_outage",
                                        "Corrections (SBAS, service, RTK) no longer arrive."};
};

inline void visit(fields::Visitor&, OutageFault&) {}
void visit(fields::Visitor& v, JammingFault& p);
void visit(fields::Visitor& v, SpoofDriftFault& p);
void visit(fields::Visitor& v, JumpFault& p);
inline void visit(fields::Visitor&, AntennaShortFault&) {}
inline void visit(fields::Visitor&, AntennaOpenFault&) {}
inline void visit(fields::Visitor&, CorrectionOutageFault&) {}

struct GnssFault {
  FaultPeriod when;
  std::variant<OutageFault, JammingFault, SpoofDriftFault, JumpFault, AntennaShortFault,
               AntennaOpenFault, CorrectionOutageFault>
      what;
};
void visit(fields::Visitor& v, GnssFault& p);

/// Whether it disturbs one band and not the other, which means nothing to a receiver of one band.
[[nodiscard]] bool tells_bands_apart(const GnssFault& fault);

/// What all faults amount to.
struct GnssFaultState {
  bool no_signal = false;
  AntennaState antenna = AntennaState::ok;
  double jamming_db = 0.0;         ///< Loss of C/N0 in the first band.
  double second_jamming_db = 0.0;  ///< Loss of C/N0 in the second band.
  bool spoofed = false;
  bool corrections_lost = false;
  /// East, north, up; from the true to the received place.
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset_rate_mps = Eigen::Vector3d::Zero();
  double clock_offset_m = 0.0;  ///< Common to all ranges.
  double clock_offset_rate_mps = 0.0;
};

[[nodiscard]] GnssFaultState fault_state(const FaultBook<GnssFault>& faults, SimTime time);

}  // namespace rigwire::sim
