// Defects of the sensor itself, of its window, of its time input and of the cable behind it. What
// the air does to the beams is the weather's (sim/weather/weather.h).
//
//   faults:
//     - {type: lost, at: 10 s, for: 5 s, share: 1 %}
//     - {type: dirt, at: 20 s, for: 60 s, from: 40 deg, to: 60 deg, transmission: 20 %}
//
// Where several of a type hold at once, the first counts; of dead lasers and dirt all.
#pragma once

#include <cstdint>
#include <variant>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct LostPacketsFault {
  static constexpr fields::Named kNamed{"lost", "Packets are lost on the way."};

  double share = 0.01;  ///< Probability per packet, either port.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct SwappedPacketsFault {
  static constexpr fields::Named kNamed{"swapped",
                                        "Data packets change places with their successors."};

  double share = 0.01;  ///< Probability per data packet.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct DuplicatedPacketsFault {
  static constexpr fields::Named kNamed{"repeated", "Packets arrive twice."};

  double share = 0.01;  ///< Probability per packet, either port.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct DeadLaserFault {
  static constexpr fields::Named kNamed{"dead_laser", "Some lasers see nothing."};

  int first = 0;  ///< By the model's numbers, which count from 0.
  int last = 0;   ///< Included.
};
struct DirtyWindowFault {
  static constexpr fields::Named kNamed{"dirt", "Dirt on a sector of the window."};

  double from_deg = 0.0;      ///< Azimuth, clockwise; the sector may contain 0.
  double to_deg = 10.0;       ///< Not `from_deg`; 0 and 360 are all round.
  double transmission = 0.5;  ///< Transmission of light, one way.
  Duration ramp{0};

  void grow(double share) { transmission = 1.0 - share * (1.0 - transmission); }
};
struct MotorStallFault {
  static constexpr fields::Named kNamed{"motor_stall", "The rotor runs down."};
};
struct PulseLossFault {
  static constexpr fields::Named kNamed{"pulse_loss", "No pulse per second arrives."};
};
/// The input reports an error.
struct PulseNoiseFault {
  static constexpr fields::Named kNamed{"pulse_noise",
                                        "Pulses at wrong times between the right ones."};
};
struct SentenceLossFault {
  static constexpr fields::Named kNamed{"sentence_loss", "No sentence arrives."};
};
struct ClockOffsetFault {
  static constexpr fields::Named kNamed{"wrong_time", "Timestamps are off."};

  double offset_s = 1.0;
  Duration ramp{0};

  void grow(double share) { offset_s *= share; }
};
struct HourOverrunFault {
  static constexpr fields::Named kNamed{"hour_overrun",
                                        "The timestamp passes 3600 s before it wraps."};

  double overrun_s = 0.05;
};
struct FactoryBytesFault {
  static constexpr fields::Named kNamed{"factory_bytes",
                                        "The last two bytes of data packets are wrong."};

  std::uint8_t return_mode = 0;
  std::uint8_t product = 0;
};

void visit(fields::Visitor& v, LostPacketsFault& p);
void visit(fields::Visitor& v, SwappedPacketsFault& p);
void visit(fields::Visitor& v, DuplicatedPacketsFault& p);
void visit(fields::Visitor& v, DeadLaserFault& p);
void visit(fields::Visitor& v, DirtyWindowFault& p);
inline void visit(fields::Visitor&, MotorStallFault&) {}
inline void visit(fields::Visitor&, PulseLossFault&) {}
inline void visit(fields::Visitor&, PulseNoiseFault&) {}
inline void visit(fields::Visitor&, SentenceLossFault&) {}
void visit(fields::Visitor& v, ClockOffsetFault& p);
void visit(fields::Visitor& v, HourOverrunFault& p);
void visit(fields::Visitor& v, FactoryBytesFault& p);

struct VelodyneFault {
  FaultPeriod when;
  std::variant<LostPacketsFault, SwappedPacketsFault, DuplicatedPacketsFault, DeadLaserFault,
               DirtyWindowFault, MotorStallFault, PulseLossFault, PulseNoiseFault,
               SentenceLossFault, ClockOffsetFault, HourOverrunFault, FactoryBytesFault>
      what;
};
void visit(fields::Visitor& v, VelodyneFault& p);

using VelodyneFaults = FaultBook<VelodyneFault>;

}  // namespace rigwire::emulators
