// Faults of a Modbus line: a list in the line's section, each fault with its own keys.
//
//   faults:
//     - {type: delay, at: 10 s, for: 5 s, unit: 1, delay: 300 ms}
//     - {type: exception, at: 20 s, code: busy, table: holding, first: 0, last: 9, probability: 10
//     %}
//     - {type: stuck, at: 30 s, table: input, first: 2, last: 2}
//
// What each does: emulators/modbus/modbus_faults.h.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <variant>
#include <vector>

#include "emulators/modbus/modbus_faults.h"
#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"

namespace rigwire::hil {

/// Which requests a fault concerns by what they touch.
enum class ModbusFaultTable : std::uint8_t { any, coils, discrete_inputs, holding, input };
inline constexpr std::array<Choice<ModbusFaultTable>, 5> kModbusFaultTables{
    {{ModbusFaultTable::any, "any", "Every request."},
     {ModbusFaultTable::coils, "coils", "Those that touch these coils."},
     {ModbusFaultTable::discrete_inputs, "discrete", "Those that read these discrete inputs."},
     {ModbusFaultTable::holding, "holding", "Those that touch these holding registers."},
     {ModbusFaultTable::input, "input", "Those that read these input registers."}}};

using ModbusException = protocols::modbus::ExceptionCode;
inline constexpr std::array<Choice<ModbusException>, 9> kModbusExceptions{
    {{ModbusException::illegal_function, "illegal_function", "01"},
     {ModbusException::illegal_data_address, "illegal_address", "02"},
     {ModbusException::illegal_data_value, "illegal_value", "03"},
     {ModbusException::server_device_failure, "device_failure", "04"},
     {ModbusException::acknowledge, "acknowledge", "05; the request is carried out all the same."},
     {ModbusException::server_device_busy, "busy", "06"},
     {ModbusException::memory_parity_error, "memory_parity", "08"},
     {ModbusException::gateway_path_unavailable, "path_unavailable", "0A"},
     {ModbusException::gateway_target_failed, "target_failed", "0B"}}};

struct ModbusDelayFault {
  Duration delay = std::chrono::milliseconds(100);
};
struct ModbusExceptionFault {
  ModbusException code = ModbusException::server_device_failure;
};
struct ModbusSilenceFault {};
struct ModbusLostAnswerFault {};
struct ModbusJunkFault {
  int bytes = 4;
};
struct ModbusSplitFault {
  int pieces = 2;
  Duration pause = std::chrono::milliseconds(20);
};
struct ModbusTruncatedFault {
  int bytes = 1;
};
struct ModbusStuckFault {
  int value = -1;  ///< -1: what was read first.
};
struct ModbusWrongCheckFault {};
struct ModbusWrongTransactionFault {};
struct ModbusDisconnectFault {};
struct ModbusNoiseFault {
  double bit_error_rate = 1e-4;
};
struct ModbusParityFault {};

using ModbusFaultSettings =
    std::variant<ModbusDelayFault, ModbusExceptionFault, ModbusSilenceFault, ModbusLostAnswerFault,
                 ModbusJunkFault, ModbusSplitFault, ModbusTruncatedFault, ModbusStuckFault,
                 ModbusWrongCheckFault, ModbusWrongTransactionFault, ModbusDisconnectFault,
                 ModbusNoiseFault, ModbusParityFault>;

/// The names of the `type` key, in the order of ModbusFaultSettings.
inline constexpr std::array<Alternative, 13> kModbusFaultTypes{
    {{"delay", "Answers come later."},
     {"exception", "An exception instead of the answer."},
     {"silence", "The unit hears nothing."},
     {"lost_answer", "The unit acts, its answer is lost."},
     {"junk", "Random bytes right before the answer."},
     {"split", "The answer in parts with pauses between."},
     {"truncated", "The end of the answer is missing."},
     {"stuck", "Registers read the same, whatever happens."},
     {"wrong_check", "rtu: the answer's CRC is wrong."},
     {"wrong_transaction", "tcp: the answer carries another transaction identifier."},
     {"disconnect", "tcp: the connection is closed instead of an answer."},
     {"noise", "rtu, whole line: bits are turned over, both ways."},
     {"parity_mismatch", "rtu, whole line: the masters use another parity."}}};

struct ModbusFaultConfiguration {
  Duration at{0};  ///< From the start of the run.
  Duration length = std::chrono::seconds{10};
  std::uint8_t unit = 0;  ///< 0: every unit of the line.
  ModbusFaultTable table = ModbusFaultTable::any;
  std::uint16_t first = 0;
  std::uint16_t last = 65535;
  double probability = 1.0;
  ModbusFaultSettings settings;
};

[[nodiscard]] emulators::ModbusFault modbus_fault(const ModbusFaultConfiguration& fault);
[[nodiscard]] std::vector<emulators::ModbusFault> modbus_faults(
    const std::vector<ModbusFaultConfiguration>& faults);

template <class Visitor>
void visit(Visitor& v, ModbusDelayFault& p) {
  v.duration("delay", p.delay, {1, 60'000'000'000}, "On top of the line's response delay.");
}
template <class Visitor>
void visit(Visitor& v, ModbusExceptionFault& p) {
  v.choice("code", p.code, kModbusExceptions, "The exception.");
}
template <class Visitor>
void visit(Visitor&, ModbusSilenceFault&) {}
template <class Visitor>
void visit(Visitor&, ModbusLostAnswerFault&) {}
template <class Visitor>
void visit(Visitor& v, ModbusJunkFault& p) {
  v.integer("bytes", p.bytes, IntegerRule{1, 64}, "How many.");
}
template <class Visitor>
void visit(Visitor& v, ModbusSplitFault& p) {
  v.integer("pieces", p.pieces, IntegerRule{2, 16}, "How many.");
  v.duration("pause", p.pause, {1, 60'000'000'000}, "Between them.");
}
template <class Visitor>
void visit(Visitor& v, ModbusTruncatedFault& p) {
  v.integer("bytes", p.bytes, IntegerRule{1, 260}, "How many are missing.");
}
template <class Visitor>
void visit(Visitor& v, ModbusStuckFault& p) {
  v.integer("value", p.value, IntegerRule{-1, 65535}, "As read; -1 = what was read first.");
}
template <class Visitor>
void visit(Visitor&, ModbusWrongCheckFault&) {}
template <class Visitor>
void visit(Visitor&, ModbusWrongTransactionFault&) {}
template <class Visitor>
void visit(Visitor&, ModbusDisconnectFault&) {}
template <class Visitor>
void visit(Visitor& v, ModbusNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, plain().above(0).at_most(0.5), "Of each bit.");
}
template <class Visitor>
void visit(Visitor&, ModbusParityFault&) {}

template <class Visitor>
void visit(Visitor& v, ModbusFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, 31'536'000'000'000'000}, "From the start of the run.");
  v.duration("for", p.length, {1'000'000, 31'536'000'000'000'000}, "How long it lasts.");
  v.integer("unit", p.unit, IntegerRule{0, 247}, "0 = every unit of the line.");
  v.choice("table", p.table, kModbusFaultTables, "Which requests it concerns.");
  v.integer("first", p.first, IntegerRule{0, 65535}, "Address, from 0, with a table.");
  v.integer("last", p.last, IntegerRule{0, 65535}, "Included.");
  v.number("probability", p.probability, in("%").above(0).at_most(100), "Of each request.");
  v.required("type");
  v.variant("type", p.settings, kModbusFaultTypes, "What happens.");
}

}  // namespace rigwire::hil
