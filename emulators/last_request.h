// What a client asked of a device last, for people who look on: when, and the bytes by which its
// protocol names the request.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim/samples/time.h"

namespace rigwire::emulators {

struct LastRequest {
  static constexpr std::size_t kHeadBytes = 16;

  SimTime at = kNever;  ///< kNever: nobody has asked yet.
  std::array<std::uint8_t, kHeadBytes> head{};
  std::size_t size = 0;  ///< Bytes of `head`; what is longer is cut off.

  void note(SimTime now, std::span<const std::uint8_t> bytes) {
    at = now;
    size = std::min(bytes.size(), kHeadBytes);
    std::copy_n(bytes.begin(), size, head.begin());
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return std::span(head).first(size); }
};

}  // namespace rigwire::emulators
