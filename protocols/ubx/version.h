// MON-VER as text: the one message whose repeated part is text, read by every client at start.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.16.14 "UBX-MON-VER".
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/ubx/frame.h"

namespace rigwire::protocols::ubx {

struct Version {
  std::string software;                 ///< At most 30 characters.
  std::string hardware;                 ///< At most 10 characters.
  std::vector<std::string> extensions;  ///< At most 30 characters each.

  friend bool operator==(const Version&, const Version&) = default;
};

/// Payload of MON-VER: 40 + 30 n bytes. Longer texts are cut. Allocates; for set-up.
[[nodiscard]] std::vector<std::uint8_t> version_payload(const Version& version);

/// Malformed when the frame is not MON-VER or its length is not 40 + 30 n.
[[nodiscard]] Decoded<Version> decode_version(const FrameView& frame);

}  // namespace rigwire::protocols::ubx
