// Bytes as text, RFC 4648, section 4.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace rigwire::hil {

/// With padding, without lines.
void append_base64(std::string& text, std::span<const std::uint8_t> bytes);

}  // namespace rigwire::hil
