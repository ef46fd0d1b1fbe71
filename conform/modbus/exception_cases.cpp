// Function codes that a device does not have: MODBUS Application Protocol Specification V1.1b3,
// sections 4.1, 5 and 7.
#include <array>
#include <string>

#include "conform/modbus/modbus_trial.h"
#include "conform/modbus/modbus_words.h"

namespace rigwire::conform {

namespace modbus = protocols::modbus;
using modbus::ExceptionCode;

namespace {

struct Row {
  std::uint8_t code;
  const char* title;
  Strength strength;
};

// Those of serial lines alone (7, 8, 11, 12), files and queues (20, 21, 24), user defined ones at
// the ends of their ranges (65, 72, 100, 110), reserved ones, and what is none.
constexpr std::array<Row, 15> kRows{
    {{0, "Function code 0, which is not valid, is refused", Strength::must},
     {7, "Read exception status, where it is not claimed, is refused", Strength::must},
     {8, "Diagnostics, where it is not claimed, is refused", Strength::must},
     {11, "Get communication event counter, where it is not claimed, is refused", Strength::must},
     {12, "Get communication event log, where it is not claimed, is refused", Strength::must},
     {20, "Read file record, where it is not claimed, is refused", Strength::must},
     {21, "Write file record, where it is not claimed, is refused", Strength::must},
     {24, "Read queue, where it is not claimed, is refused", Strength::must},
     {9, "A reserved function code is refused", Strength::must},
     {65, "User defined function 65, where it is not claimed, is refused", Strength::must},
     {72, "User defined function 72, where it is not claimed, is refused", Strength::must},
     {100, "User defined function 100, where it is not claimed, is refused", Strength::must},
     {110, "User defined function 110, where it is not claimed, is refused", Strength::must},
     {127, "The highest function code is refused", Strength::must},
     {0x83, "What is answered to a request with the exception flag", Strength::observed}}};

}  // namespace

std::vector<ModbusCase> modbus_exception_cases() {
  std::vector<ModbusCase> all;
  Citations citations("modbus", kApplicationProtocol);
  for (const Row& row : kRows) {
    ModbusCase& made = all.emplace_back();
    made.identity = citations.next_in(
        "5.1", row.title, std::string(kApplicationProtocol) + ", 5.1 and 7", row.strength);
    made.needs.without = row.code;
    made.run = [code = row.code](ModbusTrial& trial) {
      trial.refuses({code, 0, 0, 0, 1}, ExceptionCode::illegal_function);
    };
  }
  ModbusCase& longest = all.emplace_back();
  longest.identity = citations.next("4.1", "A data unit of the greatest length is answered");
  longest.needs.without = 65;
  longest.run = [](ModbusTrial& trial) {
    Pdu request{65};
    request.resize(modbus::kPduMaximum);
    trial.refuses(request, ExceptionCode::illegal_function);
  };
  return all;
}

}  // namespace rigwire::conform
