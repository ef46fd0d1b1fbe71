#include "emulators/modbus/modbus_faults.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "protocols/modbus/rtu.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

namespace {

constexpr std::array<std::string_view, 13> kNames{
    "delay",      "exception", "silence",        "lost_answer", "junk",
    "split",      "truncated", "stuck",          "wrong_check", "wrong_transaction",
    "disconnect", "noise",     "parity_mismatch"};

[[noreturn]] void refuse(const ModbusFault& fault, const std::string& quantity,
                         const std::string& found, const std::string& allowed) {
  throw std::invalid_argument("modbus fault " + std::string(name(fault.kind)) + ", " + quantity +
                              ": found " + found + ", allowed " + allowed);
}

void check_size(const ModbusFault& fault, const char* quantity, std::size_t value,
                std::size_t lower, std::size_t upper) {
  if (value < lower || value > upper) {
    refuse(fault, quantity, std::to_string(value),
           std::to_string(lower) + " .. " + std::to_string(upper));
  }
}

bool of_whole_line(ModbusFaultKind kind) {
  return kind == ModbusFaultKind::noise || kind == ModbusFaultKind::parity_mismatch;
}

void check_wire(const ModbusFault& fault, ModbusWire wire) {
  const bool tcp_only =
      fault.kind == ModbusFaultKind::wrong_transaction || fault.kind == ModbusFaultKind::disconnect;
  const bool rtu_only = fault.kind == ModbusFaultKind::wrong_check || of_whole_line(fault.kind);
  if ((tcp_only && wire == ModbusWire::rtu) || (rtu_only && wire == ModbusWire::tcp)) {
    refuse(fault, "wire", wire == ModbusWire::tcp ? "tcp" : "rtu", tcp_only ? "tcp" : "rtu");
  }
}

void check_registers(const ModbusFault& fault) {
  if (fault.registers && fault.registers->last < fault.registers->first) {
    refuse(fault, "last register", std::to_string(fault.registers->last),
           std::to_string(fault.registers->first) + " .. 65535");
  }
  if (fault.kind != ModbusFaultKind::stuck) {
    return;
  }
  if (!fault.registers || fault.registers->table == Table::coils ||
      fault.registers->table == Table::discrete_inputs) {
    refuse(fault, "registers", fault.registers ? "bits" : "none", "holding or input registers");
  }
  check_size(fault, "number of registers",
             std::size_t{fault.registers->last} - fault.registers->first + 1, 1,
             ModbusFaultSchedule::kStuckMaximum);
}

bool overlaps(std::uint16_t address, std::size_t count, const ModbusRegisters& range) {
  return address <= range.last && address + count > range.first;
}

/// Whether a request reads or writes one of `range`.
struct Touches {
  const ModbusRegisters& range;

  bool operator()(const ReadBits& r) const {
    const Table table = r.table == BitTable::coils ? Table::coils : Table::discrete_inputs;
    return table == range.table && overlaps(r.address, r.quantity, range);
  }
  bool operator()(const ReadRegisters& r) const {
    const Table table =
        r.table == RegisterTable::holding ? Table::holding_registers : Table::input_registers;
    return table == range.table && overlaps(r.address, r.quantity, range);
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
    return range.table == Table::coils && overlaps(address, count, range);
  }
  bool holding(std::uint16_t address, std::size_t count) const {
    return range.table == Table::holding_registers && overlaps(address, count, range);
  }
};

void add(const ModbusFault& fault, ModbusFaultEffects& effects) {
  switch (fault.kind) {
    case ModbusFaultKind::delay:
      effects.delay = fault.delay;
      break;
    case ModbusFaultKind::exception:
      effects.code = fault.code;
      break;
    case ModbusFaultKind::silence:
      effects.silence = true;
      break;
    case ModbusFaultKind::lost_answer:
      effects.lost_answer = true;
      break;
    case ModbusFaultKind::junk:
      effects.junk_bytes = fault.bytes;
      break;
    case ModbusFaultKind::split:
      effects.pieces = fault.pieces;
      effects.pause = fault.delay;
      break;
    case ModbusFaultKind::truncated:
      effects.missing_bytes = fault.bytes;
      break;
    case ModbusFaultKind::wrong_check:
      effects.wrong_check = true;
      break;
    case ModbusFaultKind::wrong_transaction:
      effects.wrong_transaction = true;
      break;
    case ModbusFaultKind::disconnect:
      effects.disconnect = true;
      break;
    case ModbusFaultKind::stuck:
    case ModbusFaultKind::noise:
    case ModbusFaultKind::parity_mismatch:
      break;
  }
}

}  // namespace

std::string_view name(ModbusFaultKind kind) {
  return kNames[static_cast<std::size_t>(kind)];
}

void validate(const ModbusFault& fault, ModbusWire wire) {
  check_wire(fault, wire);
  if (fault.begin < Duration{0} || fault.end <= fault.begin) {
    refuse(fault, "end", std::to_string(to_seconds(fault.end)) + " s",
           "later than its begin, " + std::to_string(to_seconds(fault.begin)) + " s");
  }
  check_size(fault, "unit", fault.unit, 0, kUnitMaximum);
  if (of_whole_line(fault.kind) && (fault.unit != 0 || fault.registers)) {
    refuse(fault, "scope", "a unit or registers", "the whole line");
  }
  check_registers(fault);
  if (!(fault.probability > 0.0 && fault.probability <= 1.0)) {
    refuse(fault, "probability", std::to_string(fault.probability), "above 0 .. 1");
  }
  if (fault.delay <= Duration{0} || fault.delay > std::chrono::minutes(1)) {
    refuse(fault, "delay", std::to_string(to_seconds(fault.delay)) + " s", "above 0 .. 60 s");
  }
  if (fault.kind == ModbusFaultKind::junk) {
    check_size(fault, "bytes", fault.bytes, 1, ModbusFaultSchedule::kJunkMaximum);
  }
  if (fault.kind == ModbusFaultKind::truncated) {
    check_size(fault, "bytes", fault.bytes, 1, kTcpAduMaximum);
  }
  if (fault.kind == ModbusFaultKind::split) {
    check_size(fault, "pieces", fault.pieces, 2, 16);
  }
  if (fault.kind == ModbusFaultKind::noise &&
      !(fault.bit_error_rate > 0.0 && fault.bit_error_rate <= 0.5)) {
    refuse(fault, "bit_error_rate", std::to_string(fault.bit_error_rate), "above 0 .. 0.5");
  }
}

ModbusFaultSchedule::ModbusFaultSchedule(std::vector<ModbusFault> faults, ModbusWire wire,
                                         std::uint64_t seed)
    : faults_(std::move(faults)), memories_(faults_.size()), random_(seed) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const ModbusFault& fault = faults_[i];
    validate(fault, wire);
    if (fault.kind == ModbusFaultKind::stuck) {
      memories_[i].values.resize(std::size_t{fault.registers->last} - fault.registers->first + 1,
                                 fault.value);
    }
  }
}

ModbusFaultEffects ModbusFaultSchedule::effects(SimTime now, std::uint8_t unit,
                                                const Request* request) {
  ModbusFaultEffects effects;
  std::array<bool, kNames.size()> decided{};
  for (const ModbusFault& fault : faults_) {
    bool& seen = decided[static_cast<std::size_t>(fault.kind)];
    const bool concerned = !seen && fault.holds(now) && (fault.unit == 0 || fault.unit == unit) &&
                           (!fault.registers || (request != nullptr &&
                                                 std::visit(Touches{*fault.registers}, *request)));
    if (concerned) {
      seen = true;
      if (fault.probability >= 1.0 || random_.uniform() < fault.probability) {
        add(fault, effects);
      }
    }
  }
  return effects;
}

void ModbusFaultSchedule::hold_stuck(SimTime now, std::uint8_t unit, Table table,
                                     std::uint16_t address, std::span<std::uint16_t> values) {
  for (std::size_t i = 0; i < faults_.size(); ++i) {
    const ModbusFault& fault = faults_[i];
    if (fault.kind != ModbusFaultKind::stuck || !fault.holds(now) ||
        (fault.unit != 0 && fault.unit != unit) || fault.registers->table != table) {
      continue;
    }
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::size_t at = address + k;
      if (at >= fault.registers->first && at <= fault.registers->last) {
        auto& held = memories_[i].values[at - fault.registers->first];
        held = held.value_or(values[k]);
        values[k] = *held;
      }
    }
  }
}

const ModbusFault* ModbusFaultSchedule::of_line(ModbusFaultKind kind, SimTime now) const {
  const auto found = std::ranges::find_if(
      faults_, [&](const ModbusFault& fault) { return fault.kind == kind && fault.holds(now); });
  return found == faults_.end() ? nullptr : &*found;
}

bool ModbusFaultSchedule::parity_mismatch(SimTime now) const {
  return of_line(ModbusFaultKind::parity_mismatch, now) != nullptr;
}

void ModbusFaultSchedule::disturb(SimTime now, std::span<std::uint8_t> bytes) {
  const ModbusFault* noise = of_line(ModbusFaultKind::noise, now);
  if (noise == nullptr) {
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
