// Modbus data units in words, for a person: "read holding registers 0 .. 9".
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rigwire::conform {

[[nodiscard]] std::string request_words(std::span<const std::uint8_t> pdu);
[[nodiscard]] std::string answer_words(std::span<const std::uint8_t> pdu);
/// "2 (illegal data address)".
[[nodiscard]] std::string exception_words(std::uint8_t code);

}  // namespace rigwire::conform
