// Faults of a satellite receiver: a list in its device's section, each fault with its own keys.
//
//   faults:
//     - {type: jamming, at: 30 s, for: 10 s, loss: 15 dB}
//     - {type: jump, at: 60 s, for: 5 s, offset: [20 m, 0 m, 0 m]}
//
// Those of the surroundings act on the signals (sim/gnss/gnss_fault.h), so that position,
// satellites and everything else that the receiver reports follow; those of the device act in its
// emulator.
#pragma once

#include <array>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/ublox/settings.h"
#include "fields/visitor.h"
#include "sim/gnss/gnss_fault.h"
#include "sim/samples/vector3.h"

namespace rigwire::hil {

struct OutageFault {
  static constexpr fields::Named kNamed{"outage", "No signal arrives; the antenna is well."};
};
struct JammingFault {
  static constexpr fields::Named kNamed{"jamming",
                                        "Carrier-to-noise density falls, the noise floor rises."};

  double loss_db = 20.0;
};
struct SpoofDriftFault {
  static constexpr fields::Named kNamed{
      "spoof_drift", "Strong false signals, consistent with each other, drift away."};

  Vector3 velocity_mps{1.0, 0.0, 0.0};  ///< [east, north, up].
  double clock_rate_mps = 0.0;
};
struct JumpFault {
  static constexpr fields::Named kNamed{"jump", "The signals of a place beside the true one."};

  Vector3 offset_m{10.0, 0.0, 0.0};  ///< [east, north, up].
};
struct AntennaShortFault {
  static constexpr fields::Named kNamed{"antenna_short", "Short circuit of the antenna's supply."};
};
struct AntennaOpenFault {
  static constexpr fields::Named kNamed{"antenna_open", "Nothing on the antenna's plug."};
};
struct CorrectionOutageFault {
  static constexpr fields::Named kNamed{"correction_outage",
                                        "Corrections (SBAS, service, RTK) no longer arrive."};
};
struct FrozenFixFault {
  static constexpr fields::Named kNamed{"frozen_fix",
                                        "The device repeats its last fix; time goes on."};
};
struct WrongLeapSecondFault {
  static constexpr fields::Named kNamed{"wrong_leap_second", "The device's leap seconds are off."};

  int seconds = 1;
};
struct UartNoiseFault {
  static constexpr fields::Named kNamed{"uart_noise",
                                        "Bits of the serial line are turned over, both ways."};

  double bit_error_rate = 1e-4;
};

using GnssFaultSettings = std::variant<OutageFault, JammingFault, SpoofDriftFault, JumpFault,
                                       AntennaShortFault, AntennaOpenFault, CorrectionOutageFault,
                                       FrozenFixFault, WrongLeapSecondFault, UartNoiseFault>;

struct GnssFaultConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
  GnssFaultSettings settings;

  [[nodiscard]] std::string_view type() const { return fields::chosen_name(settings); }
};

/// What of the list happens to the signals, and what in a u-blox receiver.
[[nodiscard]] std::vector<sim::GnssFault> signal_faults(
    const std::vector<GnssFaultConfiguration>& faults);
[[nodiscard]] std::vector<emulators::UbloxFault> ublox_faults(
    const std::vector<GnssFaultConfiguration>& faults);

inline void visit(fields::Visitor&, OutageFault&) {}
inline void visit(fields::Visitor& v, JammingFault& p) {
  v.number("loss", p.loss_db, fields::in("dB").stored_as("dB").between(0, 80),
           "How far the carrier-to-noise density falls.");
}
inline void visit(fields::Visitor& v, SpoofDriftFault& p) {
  v.vector3("velocity", p.velocity_mps, fields::in("m/s").between(-1e4, 1e4),
            "Velocity of the false place, [east, north, up].");
  v.number("clock_rate", p.clock_rate_mps, fields::in("m/s").between(-1e4, 1e4),
           "How fast all ranges grow alike, as of a clock that drifts.");
}
inline void visit(fields::Visitor& v, JumpFault& p) {
  v.vector3("offset", p.offset_m, fields::in("m").between(-1e6, 1e6),
            "From the true place to the false one, [east, north, up].");
}
inline void visit(fields::Visitor&, AntennaShortFault&) {}
inline void visit(fields::Visitor&, AntennaOpenFault&) {}
inline void visit(fields::Visitor&, CorrectionOutageFault&) {}
inline void visit(fields::Visitor&, FrozenFixFault&) {}
inline void visit(fields::Visitor& v, WrongLeapSecondFault& p) {
  v.integer("seconds", p.seconds, fields::IntegerRule{-10, 10, fields::unit("s")},
            "Leap seconds that are too many; not 0.");
  v.check(p.seconds != 0, "seconds", "0 is the right number of leap seconds", "0",
          "-10 .. -1, 1 .. 10");
}
inline void visit(fields::Visitor& v, UartNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, fields::in("1").above(0).at_most(0.5),
           "Probability with which each bit is turned over.");
}

inline void visit(fields::Visitor& v, GnssFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
  v.duration("for", p.length, {1'000'000, fields::kYear_ns}, "How long the fault lasts.");
  v.required("type");
  v.variant("type", p.settings, "Which fault it is.");
}

}  // namespace rigwire::hil
