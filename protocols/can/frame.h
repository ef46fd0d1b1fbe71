// One classic CAN frame, as every bus device and CAN driver exchanges it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace rigwire::protocols::can {

/// ISO 11898-1 classic data or remote frame. CAN FD is not modelled.
struct Frame {
  std::uint32_t id = 0;     ///< 11 bits, or 29 bits when `extended`.
  bool extended = false;    ///< 29-bit identifier.
  bool remote = false;      ///< Remote request: no data, `length` is the requested length.
  std::uint8_t length = 0;  ///< 0..8.
  std::array<std::uint8_t, 8> data{};

  [[nodiscard]] std::span<const std::uint8_t> payload() const {
    return std::span(data).first(remote ? 0U : length);
  }
  friend bool operator==(const Frame&, const Frame&) = default;
};

}  // namespace rigwire::protocols::can
