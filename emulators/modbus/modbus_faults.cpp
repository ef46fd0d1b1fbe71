#include "emulators/modbus/modbus_faults.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "fields/check.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::emulators {

using namespace protocols::modbus;
using fields::in;
using fields::IntegerRule;

namespace {

constexpr std::array<fields::Choice<ModbusFaultTable>, 5> kTables{
    {{ModbusFaultTable::any, "any", "Every request."},
     {ModbusFaultTable::coils, "coils", "Those that touch these coils."},
     {ModbusFaultTable::discrete_inputs, "discrete", "Those that read these discrete inputs."},
     {ModbusFaultTable::holding, "holding", "Those that touch these holding registers."},
     {ModbusFaultTable::input, "input", "Those that read these input registers."}}};

constexpr std::array<fields::Choice<ModbusException>, 9> kExceptions{
    {{ModbusException::illegal_function, "illegal_function", "01"},
     {ModbusException::illegal_data_address, "illegal_address", "02"},
     {ModbusException::illegal_data_value, "illegal_value", "03"},
     {ModbusException::server_device_failure, "device_failure", "04"},
     {ModbusException::acknowledge, "acknowledge", "05; the request is carried out all the same."},
     {ModbusException::server_device_busy, "busy", "06"},
     {ModbusException::memory_parity_error, "memory_parity", "08"},
     {ModbusException::gateway_path_unavailable, "path_unavailable", "0A"},
     {ModbusException::gateway_target_failed, "target_failed", "0B"}}};

[[noreturn]] void refuse(const ModbusFault& fault, const std::string& quantity,
                         const std::string& found, const std::string& allowed) {
  throw std::invalid_argument("modbus fault " + std::string(fields::chosen_name(fault.what)) +
                              ", " + quantity + ": found " + found + ", allowed " + allowed);
}

bool is_register_table(ModbusFaultTable table) {
  return table == ModbusFaultTable::holding || table == ModbusFaultTable::input;
}

ModbusFaultTable fault_table(Table table) {
  switch (table) {
    case Table::coils:
      return ModbusFaultTable::coils;
    case Table::discrete_inputs:
      return ModbusFaultTable::discrete_inputs;
    case Table::input_registers:
      return ModbusFaultTable::input;
    case Table::holding_registers:
      break;
  }
  return ModbusFaultTable::holding;
}

void check_scope(const ModbusFault& fault) {
  const ModbusFaultScope& scope = fault.scope;
  const bool whole_line = std::visit(
      []<class What>(const What&) {
        return requires {
          What::kWholeLine;
        };
      },
      fault.what);
  if (whole_line && (scope.unit != 0 || scope.table != ModbusFaultTable::any)) {
    refuse(fault, "scope", "a unit or registers", "the whole line");
  }
  if (scope.table == ModbusFaultTable::any && (scope.first != 0 || scope.last != 65535)) {
    refuse(fault, "first and last", "no table", "with table: coils, discrete, holding, input");
  }
  if (scope.last < scope.first) {
    refuse(fault, "last", std::to_string(scope.last), std::to_string(scope.first) + " .. 65535");
  }
  if (std::holds_alternative<ModbusStuckFault>(fault.what)) {
    if (!is_register_table(scope.table)) {
      refuse(fault, "table", scope.table == ModbusFaultTable::any ? "none" : "bits",
             "holding, input");
    }
    if (scope.last - scope.first >= static_cast<int>(ModbusFaultSchedule::kStuckMaximum)) {
      refuse(fault, "last", std::to_string(scope.last),
             "at most " + std::to_string(ModbusFaultSchedule::kStuckMaximum) + " registers");
    }
  }
}

/// The only wire that such a fault is of; nullopt: any.
template <class What>
constexpr std::optional<ModbusWire> only_wire() {
  if constexpr (requires { What::kWire; }) {
    return What::kWire;
  } else {
    return std::nullopt;
  }
}

void check_wire(const ModbusFault& fault, ModbusWire wire) {
  const auto only =
      std::visit([]<class What>(const What&) { return only_wire<What>(); }, fault.what);
  if (only && *only != wire) {
    refuse(fault, "wire", wire == ModbusWire::tcp ? "tcp" : "rtu",
           *only == ModbusWire::tcp ? "tcp" : "rtu");
  }
}

bool overlaps(std::uint16_t address, std::size_t count, const ModbusFaultScope& range) {
  return address <= range.last && address + count > range.first;
}

/// Whether a request reads or writes one of `range`.
struct Touches {
  const ModbusFaultScope& range;

  bool operator()(const ReadBits& r) const {
    const Table table = r.table == BitTable::coils ? Table::coils : Table::discrete_inputs;
    return fault_table(table) == range.table && overlaps(r.address, r.quantity, range);
  }
  bool operator()(const ReadRegisters& r) const {
    const Table table =
        r.table == RegisterTable::holding ? Table::holding_registers : Table::input_registers;
    return fault_table(table) == range.table && overlaps(r.address, r.quantity, range);
  }
  bool operator()(const WriteCoil& r) const { return coils(r.address, 1); }
  bool operator()(const WriteCoils& r) const { return coils(r.address, r.coils.count); }
  bool operator()(const WriteRegister& r) const { return holding(r.address, 1); }
  bool operator()(const MaskWriteRegister& r) const { return holding(r.address, 1); }
  bool operator()(const WriteRegisters& r) const { return holding(r.address, r.registers.count); }
  bool operator()(const ReadWriteRegisters& r) const {
    return holding(r.read_address, r.read_quantity) || holding(r.write_address, r.registers.count);
  }
  bool operator()(const ReportServerId&) const { return false; }
  bool operator()(const ReadDeviceIdentification&) const { return false; }

 private:
  bool coils(std::uint16_t address, std::size_t count) const {
    return range.table == ModbusFaultTable::coils && overlaps(address, count, range);
  }
  bool holding(std::uint16_t address, std::size_t count) const {
    return range.table == ModbusFaultTable::holding && overlaps(address, count, range);
  }
};

/// What a fault does to one transaction; those of registers and of the line act elsewhere.
struct Add {
  ModbusFaultEffects& effects;
  const FaultPeriod& when;
  SimTime now;

  void operator()(const ModbusDelayFault& p) const { effects.delay = grown(p, when, now).delay; }
  void operator()(const ModbusExceptionFault& p) const { effects.code = p.code; }
  void operator()(const ModbusSilenceFault&) const { effects.silence = true; }
  void operator()(const ModbusLostAnswerFault&) const { effects.lost_answer = true; }
  void operator()(const ModbusJunkFault& p) const {
    effects.junk_bytes = static_cast<std::size_t>(p.bytes);
  }
  void operator()(const ModbusSplitFault& p) const {
    effects.pieces = static_cast<std::size_t>(p.pieces);
    effects.pause = p.pause;
  }
  void operator()(const ModbusTruncatedFault& p) const {
    effects.missing_bytes = static_cast<std::size_t>(p.bytes);
  }
  void operator()(const ModbusWrongCheckFault&) const { effects.wrong_check = true; }
  void operator()(const ModbusWrongTransactionFault&) const { effects.wrong_transaction = true; }
  void operator()(const ModbusDisconnectFault&) const { effects.disconnect = true; }
  void operator()(const ModbusStuckFault&) const {}
  void operator()(const ModbusNoiseFault&) const {}
  void operator()(const ModbusParityFault&) const {}
};

}  // namespace

void visit(fields::Visitor& v, ModbusDelayFault& p) {
  v.duration("delay", p.delay, {1, 60'000'000'000}, "Delay on top of the line's response delay.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, ModbusExceptionFault& p) {
  v.choice("code", p.code, kExceptions, "Exception that is answered.");
}

void visit(fields::Visitor& v, ModbusJunkFault& p) {
  v.integer("bytes", p.bytes, fields::IntegerRule{1, 64}, "How many random bytes there are.");
}

void visit(fields::Visitor& v, ModbusSplitFault& p) {
  v.integer("pieces", p.pieces, fields::IntegerRule{2, 16}, "Parts that the answer comes in.");
  v.duration("pause", p.pause, {1, 60'000'000'000}, "Pause between two parts of the answer.");
}

void visit(fields::Visitor& v, ModbusTruncatedFault& p) {
  v.integer("bytes", p.bytes, fields::IntegerRule{1, 260},
            "Bytes that are missing at the answer's end.");
}

void visit(fields::Visitor& v, ModbusStuckFault& p) {
  v.integer("value", p.value, fields::IntegerRule{-1, 65535},
            "What the registers read as; -1 = what was read first.");
}

void visit(fields::Visitor& v, ModbusNoiseFault& p) {
  v.number("bit_error_rate", p.bit_error_rate, fields::in("1").above(0).at_most(0.5),
           "Probability with which each bit is turned over.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, ModbusFaultScope& p) {
  v.integer("unit", p.unit, IntegerRule{0, kUnitMaximum},
            "Unit that it concerns; 0 = every unit of the line.");
  v.choice("table", p.table, kTables, "Table of the requests that it concerns.");
  v.integer("first", p.first, IntegerRule{0, 65535},
            "First address that it concerns, from 0, with a table.");
  v.integer("last", p.last, IntegerRule{0, 65535}, "Last address that it concerns, included.");
  v.number("share", p.share, in("%").above(0).at_most(100),
           "Share of the requests that are affected, drawn for each request.");
}

void visit(fields::Visitor& v, ModbusFault& p) {
  visit(v, p.when);
  visit(v, p.scope);
  v.required("type");
  v.variant("type", p.what, "Kind of the fault.");
}

void validate(const ModbusFault& fault, ModbusWire wire) {
  fields::check(fault);
  check_wire(fault, wire);
  check_scope(fault);
}

std::vector<fields::Named> modbus_fault_kinds(ModbusWire wire) {
  std::vector<fields::Named> kinds;
  const auto add = [&]<class What>(std::type_identity<What>) {
    if (only_wire<What>().value_or(wire) == wire) {
      kinds.push_back(What::kNamed);
    }
  };
  [&]<class... What>(std::type_identity<std::variant<What...>>) {
    (add(std::type_identity<What>{}), ...);
  }(std::type_identity<decltype(ModbusFault::what)>{});
  return kinds;
}

ModbusFaultSchedule::ModbusFaultSchedule(const std::vector<ModbusFault>& faults, ModbusWire wire,
                                         std::uint64_t seed)
    : wire_(wire), random_(seed) {
  for (const ModbusFault& fault : faults) {
    begin(fault);
  }
}

FaultBook<ModbusFault>::Id ModbusFaultSchedule::begin(const ModbusFault& fault) {
  validate(fault, wire_);
  const auto* stuck = std::get_if<ModbusStuckFault>(&fault.what);
  const auto id = book_.add(fault);
  std::erase_if(stuck_, [this](const auto& kept) { return !book_.has(kept.first); });
  if (stuck != nullptr) {
    stuck_[id].values.resize(std::size_t{fault.scope.last} - fault.scope.first + 1);
  }
  return id;
}

ModbusFaultEffects ModbusFaultSchedule::effects(SimTime now, std::uint8_t unit,
                                                const Request* request) {
  ModbusFaultEffects effects;
  std::array<bool, std::variant_size_v<decltype(ModbusFault::what)>> decided{};
  book_.each(now, [&](const ModbusFault& fault) {
    const ModbusFaultScope& scope = fault.scope;
    bool& seen = decided[fault.what.index()];
    if (seen || (scope.unit != 0 && scope.unit != unit) ||
        (scope.table != ModbusFaultTable::any &&
         (request == nullptr || !std::visit(Touches{scope}, *request)))) {
      return;
    }
    seen = true;
    if (scope.share >= 1.0 || random_.uniform() < scope.share) {
      std::visit(Add{effects, fault.when, now}, fault.what);
    }
  });
  return effects;
}

void ModbusFaultSchedule::hold_stuck(SimTime now, std::uint8_t unit, Table table,
                                     std::uint16_t address, std::span<std::uint16_t> values) {
  for (auto& [id, stuck] : stuck_) {
    const ModbusFault& fault = book_.find(id);
    const ModbusFaultScope& scope = fault.scope;
    if (!fault.when.holds(now) || (scope.unit != 0 && scope.unit != unit) ||
        scope.table != fault_table(table)) {
      continue;
    }
    const int told = std::get<ModbusStuckFault>(fault.what).value;
    if (const SimTime since = fault.when.began(now); stuck.since != since) {
      stuck.since = since;
      std::ranges::fill(stuck.values, std::nullopt);
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t at = address + k;
      if (at >= scope.first && at <= scope.last) {
        auto& held = stuck.values[at - scope.first];
        held = told >= 0 ? static_cast<std::uint16_t>(told) : held.value_or(values[k]);
        values[k] = *held;
      }
    }
  }
}

bool ModbusFaultSchedule::parity_mismatch(SimTime now) const {
  return book_.first<ModbusParityFault>(now) != nullptr;
}

void ModbusFaultSchedule::disturb(SimTime now, std::span<std::uint8_t> bytes) {
  const auto noise = book_.first_grown<ModbusNoiseFault>(now);
  if (!noise) {
    return;
  }
  for (std::uint8_t& byte : bytes) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      if (random_.uniform() < noise->bit_error_rate) {
        byte = static_cast<std::uint8_t>(byte ^ 1U << bit);
      }
    }
  }
}

void ModbusFaultSchedule::fill_junk(std::span<std::uint8_t> bytes) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random_.bits());
  }
}

}  // namespace rigwire::emulators
