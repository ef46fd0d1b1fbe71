// Defects of a Modbus line and of what hangs on it, each for a stretch of the run.
//
// A fault concerns the requests to one unit (or all), and if it names registers only the requests
// that touch one of them. Where several of a kind hold at once, the first counts. Faults of
// different kinds add up: an answer may come late, in parts, and with a wrong check.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "protocols/modbus/constants.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class ModbusWire : std::uint8_t { tcp, rtu };
inline constexpr std::array<fields::Choice<ModbusWire>, 2> kModbusWires{
    {{ModbusWire::tcp, "tcp", "A TCP server."},
     {ModbusWire::rtu, "rtu", "A serial line on a pty, RTU."}}};

enum class ModbusFaultKind : std::uint8_t {
  delay,              ///< Answers come `delay` later.
  exception,          ///< `code` instead of the answer; the device does nothing, but for code 05.
  silence,            ///< The unit hears nothing.
  lost_answer,        ///< The unit acts, its answer is lost.
  junk,               ///< `bytes` random bytes right before the answer.
  split,              ///< The answer in `pieces` parts with `delay` between them.
  truncated,          ///< The last `bytes` bytes of the answer are missing.
  stuck,              ///< Registers read as `value`, or as what they were when first read.
  wrong_check,        ///< RTU: the answer's CRC is wrong.
  wrong_transaction,  ///< TCP: the answer carries the next transaction identifier.
  disconnect,         ///< TCP: the connection is closed instead of an answer.
  noise,              ///< RTU, whole line: bits are turned over, both ways.
  parity_mismatch,    ///< RTU, whole line: the masters' parity is another; nothing is understood.
};

struct ModbusRegisters {
  protocols::modbus::Table table = protocols::modbus::Table::holding_registers;
  std::uint16_t first = 0;
  std::uint16_t last = 0;  ///< Included.
};

struct ModbusFault {
  ModbusFaultKind kind = ModbusFaultKind::silence;
  Duration begin{0};                         ///< Since the start of the run.
  Duration end{0};                           ///< Later than begin; the fault holds in [begin, end).
  std::uint8_t unit = 0;                     ///< 1 .. 247; 0: every unit of the line.
  std::optional<ModbusRegisters> registers;  ///< Without: every request.
  double probability = 1.0;                  ///< Of each request, (0, 1].
  Duration delay = std::chrono::milliseconds(100);  ///< delay, split: above 0 .. 60 s.
  protocols::modbus::ExceptionCode code = protocols::modbus::ExceptionCode::server_device_failure;
  std::size_t bytes = 1;               ///< junk: 1 .. 64; truncated: 1 .. 260.
  std::size_t pieces = 2;              ///< 2 .. 16.
  std::optional<std::uint16_t> value;  ///< stuck.
  double bit_error_rate = 0.0;         ///< noise: above 0 .. 0.5.

  [[nodiscard]] bool holds(SimTime instant) const {
    const Duration since_start = instant - kStart;
    return since_start >= begin && since_start < end;
  }
};

/// The word for it in messages and configurations, for example "lost_answer".
[[nodiscard]] std::string_view name(ModbusFaultKind kind);

/// Throws std::invalid_argument when a value is out of range or the fault has no meaning on that
/// wire.
void validate(const ModbusFault& fault, ModbusWire wire);

/// What the faults of the moment do to one transaction.
struct ModbusFaultEffects {
  Duration delay{0};
  std::optional<protocols::modbus::ExceptionCode> code;
  bool silence = false;
  bool lost_answer = false;
  std::size_t junk_bytes = 0;
  std::size_t pieces = 1;
  Duration pause{0};
  std::size_t missing_bytes = 0;
  bool wrong_check = false;
  bool wrong_transaction = false;
  bool disconnect = false;
};

class ModbusFaultSchedule {
 public:
  static constexpr std::size_t kJunkMaximum = 64;
  static constexpr std::size_t kStuckMaximum = 125;

  /// Throws std::invalid_argument.
  ModbusFaultSchedule(std::vector<ModbusFault> faults, ModbusWire wire, std::uint64_t seed);

  [[nodiscard]] bool empty() const { return faults_.empty(); }
  /// `request` is null when the PDU was not understood: faults with registers do not concern it.
  [[nodiscard]] ModbusFaultEffects effects(SimTime now, std::uint8_t unit,
                                           const protocols::modbus::Request* request);
  /// Lays stuck values over what was read of `table` from `address` on.
  void hold_stuck(SimTime now, std::uint8_t unit, protocols::modbus::Table table,
                  std::uint16_t address, std::span<std::uint16_t> values);
  /// Of the whole line.
  [[nodiscard]] bool parity_mismatch(SimTime now) const;
  /// Turns bits over in place, when a noise fault holds.
  void disturb(SimTime now, std::span<std::uint8_t> bytes);
  void fill_junk(std::span<std::uint8_t> bytes);

 private:
  /// What a stuck register read when it was first read in its fault.
  struct Memory {
    std::vector<std::optional<std::uint16_t>> values;
  };

  [[nodiscard]] const ModbusFault* of_line(ModbusFaultKind kind, SimTime now) const;

  std::vector<ModbusFault> faults_;
  std::vector<Memory> memories_;  ///< One per fault.
  RandomBits random_;
};

}  // namespace rigwire::emulators
