// The suites modbus-tcp and modbus-rtu: all cases that fit the line, in the order of the documents.
#pragma once

#include <vector>

#include "conform/modbus/modbus_trial.h"
#include "conform/suite_options.h"

namespace rigwire::conform {

[[nodiscard]] std::vector<ModbusCase> modbus_cases();

/// Asks the device. A case that cannot be tried is in the result with why. Throws Unreachable when
/// the device cannot be reached at all.
[[nodiscard]] SuiteResult run_modbus_suite(ModbusDevice& device, const SuiteOptions& options);

/// What the device answers to: its functions, tables and unit as far as requests that change
/// nothing show them; of addresses those below `addresses`. Nothing is writable. Throws
/// Unreachable.
[[nodiscard]] ModbusClaims survey_modbus(ModbusDevice& device, unsigned addresses);

}  // namespace rigwire::conform
