// Defects of the camera's electronics and of its cable. What is wrong with the sensor's pixels is
// the sensor's (sim/).
//
//   faults:
//     - {type: lost, at: 10 s, for: 5 s, share: 1 %}
//     - {type: frozen, at: 20 s, for: 2 s}
//
// Where several of a type hold at once, the first counts.
#pragma once

#include <variant>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct LostStreamPacketsFault {
  static constexpr fields::Named kNamed{"lost", "Packets of the stream are lost."};

  double share = 0.01;  ///< Probability per packet, resent ones too.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct SwappedStreamPacketsFault {
  static constexpr fields::Named kNamed{"swapped",
                                        "Packets of the stream change places with the next."};

  double share = 0.01;  ///< Probability per packet.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct DuplicatedStreamPacketsFault {
  static constexpr fields::Named kNamed{"repeated", "Packets of the stream arrive twice."};

  double share = 0.01;  ///< Probability per packet.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct LinkDownFault {
  static constexpr fields::Named kNamed{"unplugged", "Nothing comes in and nothing goes out."};
};
struct LostTriggerFault {
  static constexpr fields::Named kNamed{"lost_trigger", "Triggers make no exposure."};

  double share = 1.0;  ///< Probability per trigger, by software or by the line.
  Duration ramp{0};

  void grow(double of_it) { share *= of_it; }
};
struct FrozenFrameFault {
  static constexpr fields::Named kNamed{"frozen",
                                        "The last picture is sent again, with new time stamps."};
};
/// Only of pictures that the camera takes by itself: a trigger is one.
struct SlowPicturesFault {
  static constexpr fields::Named kNamed{"slow", "Pictures come at a share of their rate."};

  double share = 0.5;
};
struct RefusedWritesFault {
  static constexpr fields::Named kNamed{
      "refuses", "Whatever a client would change is refused: access denied."};
};
struct ExposureStuckFault {
  static constexpr fields::Named kNamed{"exposure_stuck",
                                        "The exposure stays what it was, whatever is asked."};
};
struct OverTemperatureFault {
  static constexpr fields::Named kNamed{"over_temperature",
                                        "The camera is hot; above its limit it stops."};

  double temperature_degc = 95.0;
};

void visit(fields::Visitor& v, LostStreamPacketsFault& p);
void visit(fields::Visitor& v, SwappedStreamPacketsFault& p);
void visit(fields::Visitor& v, DuplicatedStreamPacketsFault& p);
inline void visit(fields::Visitor&, LinkDownFault&) {}
void visit(fields::Visitor& v, LostTriggerFault& p);
inline void visit(fields::Visitor&, FrozenFrameFault&) {}
inline void visit(fields::Visitor&, ExposureStuckFault&) {}
inline void visit(fields::Visitor&, RefusedWritesFault&) {}
void visit(fields::Visitor& v, SlowPicturesFault& p);
void visit(fields::Visitor& v, OverTemperatureFault& p);

struct GigeCameraFault {
  FaultPeriod when;
  std::variant<LostStreamPacketsFault, SwappedStreamPacketsFault, DuplicatedStreamPacketsFault,
               LinkDownFault, LostTriggerFault, FrozenFrameFault, SlowPicturesFault,
               RefusedWritesFault, ExposureStuckFault, OverTemperatureFault>
      what;
};
void visit(fields::Visitor& v, GigeCameraFault& p);

using GigeCameraFaults = FaultBook<GigeCameraFault>;

}  // namespace rigwire::emulators
