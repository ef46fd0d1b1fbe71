// What can be made to go wrong on a CAN bus, and when.
//
// The bit-level consequences are not scripted: a fault changes levels, rates or who is connected,
// and the nodes' own error handling does the rest (can_bit_level.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocols/can/frame.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class CanBusFaultKind : std::uint8_t {
  bit_errors,     ///< Bits of frames are inverted for all nodes, each with `probability`.
  disturbance,    ///< One bit of every frame is inverted: `bit`, or one drawn for each frame.
  short_circuit,  ///< CAN_H on CAN_L: whatever is sent, every node reads recessive.
  wrong_rate,     ///< `node` works at `bit_rate_bps`.
  disconnected,   ///< `node` is alone on its stub. It hears itself, nobody acknowledges.
  intruder,       ///< One node more sends `frame` every `period`: a babbling one, or a duplicate of
                  ///< an identifier that is in use.
};

struct CanBusFault {
  CanBusFaultKind kind = CanBusFaultKind::disturbance;
  Duration begin{0};                  ///< Since the start of the run.
  Duration end{0};                    ///< Later than begin; the fault holds in [begin, end).
  double probability = 0.0;           ///< bit_errors: (0, 0.1], of each bit.
  std::optional<std::uint8_t> bit{};  ///< disturbance: from start of frame 0, stuff bits counted.
  std::string node{};                 ///< wrong_rate, disconnected: CanNodeSettings::name.
  std::uint32_t bit_rate_bps = 0;     ///< wrong_rate: 10 000 .. 1 000 000.
  protocols::can::Frame frame{};      ///< intruder.
  Duration period{0};                 ///< intruder: 10 us .. 1 h.
};

struct CanBusFaults {
  std::vector<CanBusFault> list;
  std::uint64_t seed = 1;  ///< Of everything that is drawn.
};

/// Throws std::invalid_argument with the quantity, the value found and what is allowed. Whether
/// `node` exists is the bus's to say (CanBusModel::set_faults).
void validate(const CanBusFaults& faults);

}  // namespace rigwire::emulators
