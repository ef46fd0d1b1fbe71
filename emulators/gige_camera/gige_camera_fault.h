// Defects of the camera's electronics and of its cable. What is wrong with the sensor's pixels is
// the sensor's (sim/).
//
//   faults:
//     - {type: lost_packets, at: 10 s, for: 5 s, probability: 1 %}
//     - {type: frozen_frame, at: 20 s, for: 2 s}
//
// Where several of a type hold at once, the first counts.
#pragma once

#include <variant>

#include "fields/rules.h"
#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct LostStreamPacketsFault {
  static constexpr fields::Named kNamed{"lost_packets", "Packets of the stream are lost."};

  double probability = 0.01;  ///< Of each packet, resent ones too.
};
struct SwappedStreamPacketsFault {
  static constexpr fields::Named kNamed{"swapped_packets",
                                        "Packets of the stream change places with the next."};

  double probability = 0.01;  ///< Of each packet.
};
struct DuplicatedStreamPacketsFault {
  static constexpr fields::Named kNamed{"duplicated_packets",
                                        "Packets of the stream arrive twice."};

  double probability = 0.01;  ///< Of each packet.
};
struct LinkDownFault {
  static constexpr fields::Named kNamed{"link_down", "Nothing comes in and nothing goes out."};
};
struct LostTriggerFault {
  static constexpr fields::Named kNamed{"lost_trigger", "Triggers make no exposure."};

  double probability = 1.0;  ///< Of each trigger, by software or by the line.
};
struct FrozenFrameFault {
  static constexpr fields::Named kNamed{"frozen_frame",
                                        "The last picture is sent again, with new time stamps."};
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
void visit(fields::Visitor& v, OverTemperatureFault& p);

struct GigeCameraFault {
  FaultPeriod when;
  std::variant<LostStreamPacketsFault, SwappedStreamPacketsFault, DuplicatedStreamPacketsFault,
               LinkDownFault, LostTriggerFault, FrozenFrameFault, ExposureStuckFault,
               OverTemperatureFault>
      what;
};
void visit(fields::Visitor& v, GigeCameraFault& p);

using GigeCameraFaults = FaultBook<GigeCameraFault>;

}  // namespace rigwire::emulators
