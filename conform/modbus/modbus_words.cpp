#include "conform/modbus/modbus_words.h"

#include <array>
#include <string_view>
#include <vector>

#include "conform/conformance_case.h"
#include "protocols/modbus/constants.h"

namespace rigwire::conform {

namespace {

struct FunctionWords {
  std::uint8_t code;
  std::string_view words;
};
constexpr std::array<FunctionWords, 19> kFunctions{{{1, "read coils"},
                                                    {2, "read discrete inputs"},
                                                    {3, "read holding registers"},
                                                    {4, "read input registers"},
                                                    {5, "write coil"},
                                                    {6, "write register"},
                                                    {7, "read exception status"},
                                                    {8, "diagnostics"},
                                                    {11, "get communication event counter"},
                                                    {12, "get communication event log"},
                                                    {15, "write coils"},
                                                    {16, "write registers"},
                                                    {17, "report server identifier"},
                                                    {20, "read file record"},
                                                    {21, "write file record"},
                                                    {22, "mask write register"},
                                                    {23, "read and write registers"},
                                                    {24, "read queue"},
                                                    {43, "encapsulated interface"}}};

std::string name_of(std::uint8_t code) {
  for (const FunctionWords& function : kFunctions) {
    if (function.code == code) {
      return std::string(function.words);
    }
  }
  return "function " + std::to_string(code);
}

/// The two bytes at `at`; "?" where they are not there.
std::string word_at(std::span<const std::uint8_t> pdu, std::size_t at) {
  return at + 1 < pdu.size() ? std::to_string(pdu[at] * 256 + pdu[at + 1]) : "?";
}

std::string rest_of(std::span<const std::uint8_t> pdu, std::size_t from) {
  return from < pdu.size()
             ? ", " + hex_text({pdu.begin() + static_cast<std::ptrdiff_t>(from), pdu.end()})
             : "";
}

}  // namespace

std::string exception_words(std::uint8_t code) {
  return std::to_string(code) + " (" +
         protocols::modbus::exception_text(static_cast<protocols::modbus::ExceptionCode>(code)) +
         ")";
}

std::string request_words(std::span<const std::uint8_t> pdu) {
  if (pdu.empty()) {
    return "nothing";
  }
  const std::string name = name_of(pdu[0]);
  switch (pdu[0]) {
    case 1:
    case 2:
    case 3:
    case 4:
      return name + ": " + word_at(pdu, 3) + " from " + word_at(pdu, 1) + rest_of(pdu, 5);
    case 5:
    case 6:
      return name + " " + word_at(pdu, 1) + " = " + word_at(pdu, 3) + rest_of(pdu, 5);
    case 15:
    case 16:
      return name + ": " + word_at(pdu, 3) + " from " + word_at(pdu, 1) + rest_of(pdu, 5);
    case 22:
      return name + " " + word_at(pdu, 1) + rest_of(pdu, 3);
    case 23:
      return name + ": read " + word_at(pdu, 3) + " from " + word_at(pdu, 1) + ", write " +
             word_at(pdu, 7) + " from " + word_at(pdu, 5) + rest_of(pdu, 9);
    default:
      return name + rest_of(pdu, 1);
  }
}

std::string answer_words(std::span<const std::uint8_t> pdu) {
  if (pdu.empty()) {
    return "nothing";
  }
  const auto code = static_cast<std::uint8_t>(pdu[0] & ~protocols::modbus::kExceptionFlag);
  if (code != pdu[0]) {
    return name_of(code) + ": exception " +
           (pdu.size() > 1 ? exception_words(pdu[1]) : std::string("without a code")) +
           rest_of(pdu, 2);
  }
  return name_of(code) + ", answered" + rest_of(pdu, 1);
}

}  // namespace rigwire::conform
