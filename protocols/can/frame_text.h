// A frame as can-utils write it: "18EAFFFE#00EE00", "123#R4".
//
// Source: can-utils, lib.c, parse_canframe. Three hexadecimal digits are an 11-bit identifier,
// eight a 29-bit one; after # come 0..8 bytes, dots between them allowed, or R and the length of a
// remote frame. Eight bytes may be followed by the length code that was on the wire, "_9" to "_F",
// which a frame does not keep. CAN FD (##) is not taken.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocols/can/frame.h"

namespace rigwire::protocols::can {

/// Nothing when the text is not a frame.
[[nodiscard]] std::optional<Frame> parse_frame_text(std::string_view text);

[[nodiscard]] std::string frame_text(const Frame& frame);

}  // namespace rigwire::protocols::can
