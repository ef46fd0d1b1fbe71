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
#include "fields/visitor.h"

namespace rigwire::hil {

/// Which requests a fault concerns by what they touch.
enum class ModbusFaultTable : std::uint8_t { any, coils, discrete_inputs, holding, input };
inline constexpr std::array<fields::Choice<ModbusFaultTable>, 5> kModbusFaultTables{
    {{ModbusFaultTable::any, "any", "Every request."},
     {ModbusFaultTable::coils, "coils", "Those that touch these coils."},
     {ModbusFaultTable::discrete_inputs, "discrete", "Those that read these discrete inputs."},
     {ModbusFaultTable::holding, "holding", "Those that touch these holding registers."},
     {ModbusFaultTable::input, "input", "Those that read these input registers."}}};

using ModbusException = protocols::modbus::ExceptionCode;
inline constexpr std::array<fields::Choice<ModbusException>, 9> kModbusExceptions{
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
  static constexpr fields::Named kNamed{"delay", "Answers come later."};

  Duration delay = std::chrono::milliseconds(100);
};
struct ModbusExceptionFault {
  static constexpr fields::Named kNamed{"exception", "An exception instead of the answer."};

  ModbusException code = ModbusException::server_device_failure;
};
struct ModbusSilenceFault {
  static constexpr fields::Named kNamed{"silence", "The unit hears nothing."};
};
struct ModbusLostAnswerFault {
  static constexpr fields::Named kNamed{"lost_answer", "The unit acts, its answer is lost."};
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
  static constexpr fields::Named kNamed{"stuck", "Registers read the same, whatever happens."};

  int value = -1;  ///< -1: what was read first.
};
struct ModbusWrongCheckFault {
  static constexpr fields::Named kNamed{"wrong_check", "rtu: the answer's CRC is wrong."};
};
struct ModbusWrongTransactionFault {
  static constexpr fields::Named kNamed{"wrong_transaction",
                                        "tcp: the answer carries another transaction identifier."};
};
struct ModbusDisconnectFault {
  static constexpr fields::Named kNamed{"disconnect",
                                        "tcp: the connection is closed instead of an answer."};
};
struct ModbusNoiseFault {
  static constexpr fields::Named kNamed{"noise",
                                        "rtu, whole line: bits are turned over, both ways."};

  double bit_error_rate = 1e-4;
};
struct ModbusParityFault {
  static constexpr fields::Named kNamed{"parity_mismatch",
                                        "rtu, whole line: the masters use another parity."};
};

using ModbusFaultSettings =
    std::variant<ModbusDelayFault, ModbusExceptionFault, ModbusSilenceFault, ModbusLostAnswerFault,
                 ModbusJunkFault, ModbusSplitFault, ModbusTruncatedFault, ModbusStuckFault,
                 ModbusWrongCheckFault, ModbusWrongTransactionFault, ModbusDisconnectFault,
                 ModbusNoiseFault, ModbusParityFault>;

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

inline void visit(fields::Visitor& v, ModbusDelayFault& p) {
  v.duration("delay", p.delay, {1, 60'000'000'000}, "Delay on top of the line's response delay.");
}
inline void visit(fields::Visitor& v, ModbusExceptionFault& p) {
  v.choice("code", p.code, kModbusExceptions, "Exception that is answered.");
}
inline void visit(fields::Visitor&, ModbusSilenceFault&) {}
inline void visit(fields::Visitor&, ModbusLostAnswerFault&) {}
inline void visit(fields::Visitor& v, ModbusJunkFault& p) {
  v.integer("bytes", p.bytes, fields::IntegerRule{1, 64}, "How many random bytes there are.");
}
inline void visit(fields::Visitor& v, ModbusSplitFault& p) {
  v.integer("pieces", p.pieces, fields::IntegerRule{2, 16}, "Parts that the answer comes in.");
  v.duration("pause", p.pause, {1, 60'000'000'000}, "Pause between two parts of the answer.");
}
inline void visit(fields::Visitor& v, ModbusTruncatedFault& p) {
  v.integer("bytes", p.bytes, fields::IntegerRule{1, 260},
            "Bytes that are missing at the answer's end.");
}
inline void visit(fields::Visitor& v, ModbusStuckFault& p) {
  v.integer("value", p.value, fields::IntegerRule{-1, 65535},
            "What the registers read as; -1 = what was read first.");
}
inline void visit(fields::Visitor&, ModbusWrongCheckFault&) {}
inline void visit(fields::Visitor&, ModbusWrongTransactionFault&) {}
inline void visit(fields::Visitor&, ModbusDisconnectFault&) {}
inline void visit(fields::Visitor& v, ModbusNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, fields::in("1").above(0).at_most(0.5),
           "Probability with which each bit is turned over.");
}
inline void visit(fields::Visitor&, ModbusParityFault&) {}

inline void visit(fields::Visitor& v, ModbusFaultConfiguration& p) {
  v.required("at");
  v.duration("at", p.at, {0, fields::kYear_ns}, "When it begins, from the start of the run.");
  v.duration("for", p.length, {1'000'000, fields::kYear_ns}, "How long the fault lasts.");
  v.integer("unit", p.unit, fields::IntegerRule{0, 247},
            "Unit that it concerns; 0 = every unit of the line.");
  v.choice("table", p.table, kModbusFaultTables, "Which requests it concerns.");
  v.integer("first", p.first, fields::IntegerRule{0, 65535},
            "First address that it concerns, from 0, with a table.");
  v.integer("last", p.last, fields::IntegerRule{0, 65535},
            "Last address that it concerns, included.");
  v.number("probability", p.probability, fields::in("%").above(0).at_most(100),
           "Probability with which each request is concerned.");
  v.required("type");
  v.variant("type", p.settings, "Which fault it is.");
}

}  // namespace rigwire::hil
