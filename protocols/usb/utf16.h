// UTF-8 to UTF-16 and back: USB strings are UTF-16, everything else here is UTF-8.
//
// Source: RFC 3629, section 3 and 4; RFC 2781, section 2.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rigwire::protocols::usb {

/// Nothing when the text is not well-formed UTF-8 (overlong, surrogate, cut, beyond 10FFFF).
[[nodiscard]] std::optional<std::u16string> utf16_from_utf8(std::string_view text);

/// Unpaired surrogates become U+FFFD.
[[nodiscard]] std::string utf8_from_utf16(std::u16string_view text);

}  // namespace rigwire::protocols::usb
