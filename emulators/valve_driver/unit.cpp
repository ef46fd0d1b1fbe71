// The wire's view of the valve driver: which registers can be read and written.
#include <algorithm>
#include <cmath>

#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {

using namespace valve_registers;
using protocols::modbus::ExceptionCode;
using protocols::modbus::find_register;
using protocols::modbus::Table;

namespace {

/// Holding registers that a driver with so many sections has, reserved ones included.
std::size_t holding_end(std::size_t sections) {
  return kSectionParameters + kParameterStride * sections;
}

bool within(std::size_t address, std::size_t count, std::size_t begin, std::size_t end) {
  return address >= begin && address + count <= end;
}

}  // namespace

ValveDriver::Unit::Unit(ValveDriver& driver)
    : driver_(driver),
      objects_{IdentificationObject{0, driver.settings_.vendor},
               IdentificationObject{1, driver.settings_.product_code},
               IdentificationObject{2, driver.settings_.revision},
               IdentificationObject{4, driver.settings_.product_name}},
      server_id_(driver.settings_.vendor + " " + driver.settings_.product_code + " " +
                 driver.settings_.revision) {}

ModbusUnit::Outcome ValveDriver::Unit::read_registers(RegisterTable table, std::uint16_t address,
                                                      std::span<std::uint16_t> values) const {
  const bool inputs = table == RegisterTable::input;
  const std::size_t count = values.size();
  const bool known =
      inputs ? within(address, count, 0, kInputEnd)
             : within(address, count, 0, holding_end(driver_.settings_.sections.size())) ||
                   within(address, count, kInputMirror, kInputMirror + kInputEnd);
  if (!known) {
    return ExceptionCode::illegal_data_address;
  }
  const bool mirror = !inputs && address >= kInputMirror;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::uint16_t>(address + i - (mirror ? kInputMirror : 0U));
    values[i] = inputs || mirror ? driver_.input(at) : driver_.holding_[at];
  }
  return std::nullopt;
}

ModbusUnit::Outcome ValveDriver::Unit::write_registers(SimTime now, std::uint16_t address,
                                                       std::span<const std::uint16_t> values) {
  if (const auto exception = driver_.check_write(address, values)) {
    return exception;
  }
  driver_.apply_write(now, address, values);
  return std::nullopt;
}

std::string_view ValveDriver::Unit::server_id() const {
  return server_id_;
}

std::span<const ModbusUnit::IdentificationObject> ValveDriver::Unit::identification() const {
  return objects_;
}

void ValveDriver::Unit::served(SimTime now) {
  if (static_cast<WatchdogSource>(driver_.holding_[kWatchdogSource]) ==
      WatchdogSource::any_request) {
    driver_.fed_ = now;
  }
}

ModbusUnit::Outcome ValveDriver::check_write(std::uint16_t address,
                                             std::span<const std::uint16_t> values) const {
  const auto place = [&](std::size_t i) {
    return find_register(map(), Table::holding_registers, static_cast<std::uint16_t>(address + i));
  };
  if (!within(address, values.size(), 0, holding_end(settings_.sections.size()))) {
    return ExceptionCode::illegal_data_address;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!place(i)) {
      return ExceptionCode::illegal_data_address;
    }
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto found = place(i);
    const bool command = found->entry->address == kSpoolCommand;
    const bool fitted = found->index < settings_.sections.size();
    if (!allowed(*found->entry, values[i]) || (command && !fitted && values[i] != 0)) {
      return ExceptionCode::illegal_data_value;
    }
  }
  return std::nullopt;
}

std::uint16_t ValveDriver::input(std::uint16_t address) const {
  if (address >= kCoilCurrent && address < kCoilCurrent + kValveSections) {
    return static_cast<std::uint16_t>(std::lround(coil_current_ma(address - kCoilCurrent)));
  }
  switch (address) {
    case kStatus:
      return status();
    case kFaultCode:
      return static_cast<std::uint16_t>(fault_);
    case kHeartbeatEcho:
      return holding_[kHeartbeat];
    case kMissedCycles:
      return missed_cycles_;
    default:
      return measured_[address];
  }
}

std::uint16_t ValveDriver::status() const {
  const bool at_limit = std::ranges::any_of(
      command_.opening, [](double opening) { return std::abs(opening) >= 1.0; });
  unsigned bits = 0;
  bits |= fault_ == FaultCode::none ? kStatusReady : 0U;
  bits |= enabled_ ? kStatusEnabled : 0U;
  bits |= fault_ != FaultCode::none ? kStatusFault : 0U;
  bits |= watchdog_tripped_ ? kStatusWatchdogTripped : 0U;
  bits |= at_limit ? kStatusAtLimit : 0U;
  return static_cast<std::uint16_t>(bits);
}

double ValveDriver::coil_current_ma(std::size_t section) const {
  const double opening = std::abs(command_.opening[section]);
  if (opening == 0.0) {
    return 0.0;
  }
  return settings_.coil_current_start_ma +
         (settings_.coil_current_full_ma - settings_.coil_current_start_ma) * opening;
}

}  // namespace rigwire::emulators
