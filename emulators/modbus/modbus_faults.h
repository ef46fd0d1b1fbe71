// Defects of a Modbus line and of what hangs on it, each for a stretch of the run.
//
//   faults:
//     - {type: delayed, at: 10 s, for: 5 s, unit: 1, delay: 300 ms}
//     - {type: exception, at: 20 s, code: busy, table: holding, first: 0, last: 9}
//     - {type: frozen, at: 30 s, table: input, first: 2, last: 2}
//
// A fault concerns the requests to one unit (or all), and if it names registers only the requests
// that touch one of them. Where several of a kind hold at once, the first counts. Faults of
// different kinds add up: an answer may come late, in parts, and with a wrong check.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "emulators/random_bits.h"
#include "fields/rules.h"
#include "fields/visitor.h"
#include "protocols/modbus/constants.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

enum class ModbusWire : std::uint8_t { tcp, rtu };
inline constexpr std::array<fields::Choice<ModbusWire>, 2> kModbusWires{
    {{ModbusWire::tcp, "tcp", "A TCP server."},
     {ModbusWire::rtu, "rtu", "A serial line on a pty, RTU."}}};

/// Table that a request must access for a fault to affect it.
enum class ModbusFaultTable : std::uint8_t { any, coils, discrete_inputs, holding, input };

struct ModbusFaultScope {
  std::uint8_t unit = 0;  ///< 1 .. 247; 0: every unit of the line.
  ModbusFaultTable table = ModbusFaultTable::any;
  std::uint16_t first = 0;
  std::uint16_t last = 65535;  ///< Included.
  double share = 1.0;          ///< Share of the requests, drawn independently, (0, 1].

  friend bool operator==(const ModbusFaultScope&, const ModbusFaultScope&) = default;
};

using ModbusException = protocols::modbus::ExceptionCode;

struct ModbusDelayFault {
  static constexpr fields::Named kNamed{"delayed", "Answers come later."};

  Duration delay = std::chrono::milliseconds(100);
  Duration ramp{0};

  void grow(double share) { delay = from_seconds(share * to_seconds(delay)); }
};
struct ModbusExceptionFault {
  static constexpr fields::Named kNamed{"exception", "An exception instead of the answer."};

  ModbusException code = ModbusException::server_device_failure;
};
struct ModbusSilenceFault {
  static constexpr fields::Named kNamed{"silent", "The unit receives nothing."};
};
struct ModbusLostAnswerFault {
  static constexpr fields::Named kNamed{"lost", "The unit acts, its answer is lost."};
};
struct ModbusJunkFault {
  static constexpr fields::Named kNamed{"junk", "Random bytes right before the answer."};

  int bytes = 4;
};
struct ModbusSplitFault {
  static constexpr fields::Named kNamed{"split", "The answer in parts with pauses between."};

  int pieces = 2;
  Duration pause = std::chrono::milliseconds(20);
};
struct ModbusTruncatedFault {
  static constexpr fields::Named kNamed{"truncated", "The end of the answer is missing."};

  int bytes = 1;
};
struct ModbusStuckFault {
  static constexpr fields::Named kNamed{"frozen", "Registers read the same, whatever happens."};

  int value = -1;  ///< -1: what was read first.
};
struct ModbusWrongCheckFault {
  static constexpr ModbusWire kWire = ModbusWire::rtu;
  static constexpr fields::Named kNamed{"wrong_check", "rtu: the answer's CRC is wrong."};
};
struct ModbusWrongTransactionFault {
  static constexpr ModbusWire kWire = ModbusWire::tcp;
  static constexpr fields::Named kNamed{"wrong_transaction",
                                        "tcp: the answer carries another transaction identifier."};
};
struct ModbusDisconnectFault {
  static constexpr ModbusWire kWire = ModbusWire::tcp;
  static constexpr fields::Named kNamed{"disconnect",
                                        "tcp: the connection is closed instead of an answer."};
};
struct ModbusNoiseFault {
  static constexpr ModbusWire kWire = ModbusWire::rtu;
  static constexpr bool kWholeLine = true;
  static constexpr fields::Named kNamed{"noise",
                                        "rtu, whole line: bits are turned over, both ways."};

  double bit_error_rate = 1e-4;
  Duration ramp{0};

  void grow(double share) { bit_error_rate *= share; }
};
struct ModbusParityFault {
  static constexpr ModbusWire kWire = ModbusWire::rtu;
  static constexpr bool kWholeLine = true;
  static constexpr fields::Named kNamed{"parity_mismatch",
                                        "rtu, whole line: the masters use another parity."};
};

void visit(fields::Visitor& v, ModbusDelayFault& p);
void visit(fields::Visitor& v, ModbusExceptionFault& p);
inline void visit(fields::Visitor&, ModbusSilenceFault&) {}
inline void visit(fields::Visitor&, ModbusLostAnswerFault&) {}
void visit(fields::Visitor& v, ModbusJunkFault& p);
void visit(fields::Visitor& v, ModbusSplitFault& p);
void visit(fields::Visitor& v, ModbusTruncatedFault& p);
void visit(fields::Visitor& v, ModbusStuckFault& p);
inline void visit(fields::Visitor&, ModbusWrongCheckFault&) {}
inline void visit(fields::Visitor&, ModbusWrongTransactionFault&) {}
inline void visit(fields::Visitor&, ModbusDisconnectFault&) {}
void visit(fields::Visitor& v, ModbusNoiseFault& p);
inline void visit(fields::Visitor&, ModbusParityFault&) {}

struct ModbusFault {
  FaultPeriod when;
  ModbusFaultScope scope;
  std::variant<ModbusDelayFault, ModbusExceptionFault, ModbusSilenceFault, ModbusLostAnswerFault,
               ModbusJunkFault, ModbusSplitFault, ModbusTruncatedFault, ModbusStuckFault,
               ModbusWrongCheckFault, ModbusWrongTransactionFault, ModbusDisconnectFault,
               ModbusNoiseFault, ModbusParityFault>
      what;
};
/// The keys of the scope.
void visit(fields::Visitor& v, ModbusFaultScope& p);
void visit(fields::Visitor& v, ModbusFault& p);
/// Throws std::invalid_argument when a value is out of range or the fault has no meaning on that
/// wire.
void validate(const ModbusFault& fault, ModbusWire wire);
/// The kinds that have a meaning on that wire.
[[nodiscard]] std::vector<fields::Named> modbus_fault_kinds(ModbusWire wire);

/// What the faults of the moment do to one transaction.
struct ModbusFaultEffects {
  Duration delay{0};
  std::optional<ModbusException> code;
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
  ModbusFaultSchedule(const std::vector<ModbusFault>& faults, ModbusWire wire, std::uint64_t seed);

  [[nodiscard]] bool empty() const { return book_.empty(); }
  [[nodiscard]] const FaultBook<ModbusFault>& book() const { return book_; }
  /// Throws as the constructor does.
  FaultBook<ModbusFault>::Id begin(const ModbusFault& fault);
  bool end(FaultBook<ModbusFault>::Id id, SimTime now) { return book_.end(id, now); }

  /// `request` is null when the PDU was not understood: faults with registers do not concern it.
  [[nodiscard]] ModbusFaultEffects effects(SimTime now, std::uint8_t unit,
                                           const protocols::modbus::Request* request);
  /// Replaces stuck values among those that were read of `table` from `address` on.
  void hold_stuck(SimTime now, std::uint8_t unit, protocols::modbus::Table table,
                  std::uint16_t address, std::span<std::uint16_t> values);
  /// Returns whether a parity mismatch holds; it affects the whole line.
  [[nodiscard]] bool parity_mismatch(SimTime now) const;
  /// Inverts bits in place while a noise fault holds.
  void disturb(SimTime now, std::span<std::uint8_t> bytes);
  void fill_junk(std::span<std::uint8_t> bytes);

 private:
  ModbusWire wire_;
  FaultBook<ModbusFault> book_;
  /// What stuck registers read when they were first read since they stick.
  struct Stuck {
    SimTime since{};
    std::vector<std::optional<std::uint16_t>> values;
  };
  std::map<FaultBook<ModbusFault>::Id, Stuck> stuck_;
  RandomBits random_;
};

}  // namespace rigwire::emulators
