// Names of the functions, for viewers of requests and answers.
//
// Source: MODBUS Application Protocol Specification V1.1b3, section 6 (names, and what follows the
// function code).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "protocols/modbus/constants.h"

namespace rigwire::protocols::modbus {

/// What follows the function code of a request.
enum class Addressed : std::uint8_t {
  nothing,
  one,   ///< An address.
  many,  ///< An address and a quantity.
};

struct FunctionName {
  Function function;
  std::string_view verb;
  std::string_view items;  ///< Empty: the verb says all.
  Addressed addressed;
};

inline constexpr std::array<FunctionName, 12> kFunctionNames{
    {{Function::read_coils, "read", "coils", Addressed::many},
     {Function::read_discrete_inputs, "read", "discrete inputs", Addressed::many},
     {Function::read_holding_registers, "read", "holding registers", Addressed::many},
     {Function::read_input_registers, "read", "input registers", Addressed::many},
     {Function::write_coil, "write", "coil", Addressed::one},
     {Function::write_register, "write", "register", Addressed::one},
     {Function::write_coils, "write", "coils", Addressed::many},
     {Function::write_registers, "write", "registers", Addressed::many},
     {Function::report_server_id, "report server id", "", Addressed::nothing},
     {Function::mask_write_register, "mask write", "register", Addressed::one},
     {Function::read_write_registers, "read and write", "registers", Addressed::many},
     {Function::encapsulated_interface, "read device identification", "", Addressed::nothing}}};

/// Null: none of this family's. `code` without the exception flag.
[[nodiscard]] constexpr const FunctionName* find_function_name(std::uint8_t code) {
  const auto* const found =
      std::ranges::find(kFunctionNames, static_cast<Function>(code), &FunctionName::function);
  return found == kFunctionNames.end() ? nullptr : found;
}

}  // namespace rigwire::protocols::modbus
