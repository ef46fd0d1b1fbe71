#include "hil/configuration/modbus_fault.h"

namespace rigwire::hil {
namespace {

using emulators::ModbusFault;
using emulators::ModbusFaultKind;

/// What the fault's own keys say.
struct OwnKeys {
  ModbusFault& fault;

  void operator()(const ModbusDelayFault& p) const { fault.delay = p.delay; }
  void operator()(const ModbusExceptionFault& p) const { fault.code = p.code; }
  void operator()(const ModbusJunkFault& p) const {
    fault.bytes = static_cast<std::size_t>(p.bytes);
  }
  void operator()(const ModbusSplitFault& p) const {
    fault.pieces = static_cast<std::size_t>(p.pieces);
    fault.delay = p.pause;
  }
  void operator()(const ModbusTruncatedFault& p) const {
    fault.bytes = static_cast<std::size_t>(p.bytes);
  }
  void operator()(const ModbusStuckFault& p) const {
    if (p.value >= 0) {
      fault.value = static_cast<std::uint16_t>(p.value);
    }
  }
  void operator()(const ModbusNoiseFault& p) const { fault.bit_error_rate = p.bit_error_rate; }
  template <class WithoutKeys>
  void operator()(const WithoutKeys&) const {}
};

/// In the order of ModbusFaultSettings.
constexpr std::array<ModbusFaultKind, 13> kKinds{
    ModbusFaultKind::delay,          ModbusFaultKind::exception,
    ModbusFaultKind::silence,        ModbusFaultKind::lost_answer,
    ModbusFaultKind::junk,           ModbusFaultKind::split,
    ModbusFaultKind::truncated,      ModbusFaultKind::stuck,
    ModbusFaultKind::wrong_check,    ModbusFaultKind::wrong_transaction,
    ModbusFaultKind::disconnect,     ModbusFaultKind::noise,
    ModbusFaultKind::parity_mismatch};
static_assert(kKinds.size() == std::variant_size_v<ModbusFaultSettings>);

protocols::modbus::Table table_of(ModbusFaultTable table) {
  using protocols::modbus::Table;
  switch (table) {
    case ModbusFaultTable::coils:
      return Table::coils;
    case ModbusFaultTable::discrete_inputs:
      return Table::discrete_inputs;
    case ModbusFaultTable::input:
      return Table::input_registers;
    case ModbusFaultTable::any:
    case ModbusFaultTable::holding:
      break;
  }
  return Table::holding_registers;
}

}  // namespace

ModbusFault modbus_fault(const ModbusFaultConfiguration& configured) {
  ModbusFault fault;
  fault.kind = kKinds[configured.settings.index()];
  fault.begin = configured.at;
  fault.end = configured.at + configured.length;
  fault.unit = configured.unit;
  if (configured.table != ModbusFaultTable::any) {
    fault.registers = {table_of(configured.table), configured.first, configured.last};
  }
  fault.probability = configured.probability;
  std::visit(OwnKeys{fault}, configured.settings);
  return fault;
}

std::vector<ModbusFault> modbus_faults(const std::vector<ModbusFaultConfiguration>& faults) {
  std::vector<ModbusFault> result;
  result.reserve(faults.size());
  for (const ModbusFaultConfiguration& configured : faults) {
    result.push_back(modbus_fault(configured));
  }
  return result;
}

}  // namespace rigwire::hil
