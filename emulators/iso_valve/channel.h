// One section of an ISO 11783 valve block: whose command counts, and for how long.
//
//   - A command counts only when state and value agree: extend or retract with a flow of 0 .. 100
//   %,
//     neutral and float with a flow of 0 or none. Anything else is ignored and feeds nothing.
//   - The node that commands first has the valve until it is silent for the time-out; commands of
//     others are ignored meanwhile.
//   - Without a command for `timeout` the valve goes to the fail-safe mode of the last one (block:
//     neutral, or float), says "command time-out", and moves again only after a command of neutral.
//     A fault asks for neutral in the same way.
//   - The operator's lever beats the bus from the moment it leaves neutral until it is back; then
//     the bus must begin with neutral, too. A lever that is silent for `timeout` is in neutral; one
//     that comes to life off neutral does nothing until it was there.
//
// Sources: docs/devices/iso-valves.md. Time-outs and the return through neutral are this project's
// choice after the handshake that steering valves document; ISO 11783-7 leaves them to the maker.
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/iso11783/auxiliary_valve.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

class IsoValveChannel {
 public:
  explicit IsoValveChannel(Duration timeout = std::chrono::milliseconds(300)) : timeout_(timeout) {}

  /// A command from node `source`. False when it was ignored.
  bool command(SimTime now, std::uint8_t source,
               const protocols::iso11783::ValveCommandMembers& command);
  /// The lever, -1 .. 1; NaN: it says nothing of use, as if it was silent.
  void lever(SimTime now, double share);
  /// Refuses a command: goes to neutral, as if there had been none, with the reason "error
  /// indication".
  void refuse(SimTime now);
  /// Goes to neutral; the next command that is obeyed must be neutral.
  void require_neutral();
  void note(protocols::iso11783::ValveExit reason) { exit_ = reason; }

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// What the outputs are asked for: -1 .. 1.
  [[nodiscard]] double opening() const;
  [[nodiscard]] bool floating() const;
  [[nodiscard]] bool by_operator() const { return lever_share_ != 0.0; }
  [[nodiscard]] bool timed_out() const { return timed_out_; }
  [[nodiscard]] protocols::iso11783::FailSafeMode fail_safe() const { return fail_safe_; }
  [[nodiscard]] protocols::iso11783::ValveExit exit_reason() const { return exit_; }

 private:
  Duration timeout_;
  SimTime command_expires_ = kNever;
  SimTime lever_expires_ = kNever;
  std::optional<std::uint8_t> commander_;
  double commanded_ = 0.0;
  bool float_commanded_ = false;
  bool neutral_required_ = false;
  bool timed_out_ = false;
  double lever_share_ = 0.0;
  bool lever_was_neutral_ = false;
  protocols::iso11783::FailSafeMode fail_safe_ = protocols::iso11783::FailSafeMode::block;
  protocols::iso11783::ValveExit exit_ = protocols::iso11783::ValveExit::none;
};

}  // namespace rigwire::emulators
