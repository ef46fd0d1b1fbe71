// What can be made to go wrong on a CAN bus, and when.
//
//   faults:
//     - {type: noise, at: 10 s, for: 5 s, bit_error_rate: 0.001}
//     - {type: wrong_rate, at: 20 s, for: 5 s, device: imu_boom, bitrate: 500000}
//     - {type: masquerade, at: 30 s, for: 5 s, address: 0x81}
//
// The bit-level consequences are not scripted: a fault changes levels, rates or who is connected,
// and the nodes' own error handling does the rest (can_bit_level.h).
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "fields/rules.h"
#include "protocols/can/frame.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct BitErrorsFault {
  static constexpr fields::Named kNamed{"noise", "Bits are turned over for all nodes."};

  double bit_error_rate = 1e-3;
};
struct DisturbanceFault {
  static constexpr fields::Named kNamed{"disturbance", "One bit of every frame is turned over."};

  int bit = -1;
};
struct ShortCircuitFault {
  static constexpr fields::Named kNamed{
      "short", "CAN_H on CAN_L: whatever is sent, every node reads recessive."};
};
struct WrongRateFault {
  static constexpr fields::Named kNamed{"wrong_rate", "One node works at another bit rate."};

  std::string device;
  std::uint32_t bit_rate_bps = 500'000;
};
struct DisconnectedFault {
  static constexpr fields::Named kNamed{"unplugged", "One node is alone on its stub."};

  std::string device;
};
struct IntruderFault {
  static constexpr fields::Named kNamed{"inserted", "Somebody sends a frame again and again."};

  std::string frame = "000#";  ///< Frame in candump's notation.
  Duration period = std::chrono::milliseconds{10};
};
struct DuplicateAddressFault {
  static constexpr fields::Named kNamed{"masquerade",
                                        "Somebody claims a J1939 address that is taken."};

  unsigned address = 0x80;
  std::uint64_t name = 1;
  Duration period = std::chrono::milliseconds{250};
};

void visit(fields::Visitor& v, BitErrorsFault& p);
void visit(fields::Visitor& v, DisturbanceFault& p);
inline void visit(fields::Visitor&, ShortCircuitFault&) {}
void visit(fields::Visitor& v, WrongRateFault& p);
void visit(fields::Visitor& v, DisconnectedFault& p);
void visit(fields::Visitor& v, IntruderFault& p);
void visit(fields::Visitor& v, DuplicateAddressFault& p);

struct CanFault {
  FaultPeriod when;
  std::variant<BitErrorsFault, DisturbanceFault, ShortCircuitFault, WrongRateFault,
               DisconnectedFault, IntruderFault, DuplicateAddressFault>
      what;
};
void visit(fields::Visitor& v, CanFault& p);

/// Returns the node that the fault concerns (CanNodeSettings::name); empty if the whole bus.
[[nodiscard]] std::string node_of(const CanFault& fault);

/// Returns whether the fault inverts bits on the wire, from any sender.
[[nodiscard]] bool is_of_wire(const CanFault& fault);

/// Returns the frame that an intruder sends. Precondition: validate() accepts the fault.
[[nodiscard]] protocols::can::Frame frame_of(const IntruderFault& fault);
/// Address claimed (SAE J1939-81, 4.2.2), to everybody.
[[nodiscard]] protocols::can::Frame frame_of(const DuplicateAddressFault& fault);

struct CanBusFaults {
  std::vector<CanFault> list;
  std::uint64_t seed = 1;  ///< Seed of all random draws of the faults.
};

/// Throws std::invalid_argument with the quantity, the value found and what is allowed. Does not
/// check whether the node exists; CanFaultSchedule::begin() does.
void validate(const CanFault& fault);
void validate(const CanBusFaults& faults);

}  // namespace rigwire::emulators
