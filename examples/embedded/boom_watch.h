// The software under test: knows the boom's inclination from the inertial unit on the boom, and
// when it does not know it any more. It does not depend on Rigwire; on the machine a CAN driver
// feeds it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>

/// Reads slope sensor information 2 (SSI2, PGN 61481, SAE J1939DA) of the unit at address 0x81.
class BoomWatch {
 public:
  /// Time without a message after which the inclination is unknown: five messages at 100 Hz.
  static constexpr std::chrono::milliseconds kSilence{50};

  /// Reads a frame with a 29-bit identifier; ignores all but the unit's.
  void receive(std::chrono::nanoseconds at, std::uint32_t id,
               const std::array<std::uint8_t, 8>& data) {
    constexpr std::uint32_t kPgnAndSource = 0x03FFFFFF;  // J1939-21: less the priority
    constexpr std::uint32_t kSlopeOfBoom = 0x00F02981;
    if ((id & kPgnAndSource) != kSlopeOfBoom) {
      return;
    }
    const std::uint32_t raw =
        data[0] | std::uint32_t{data[1]} << 8U | std::uint32_t{data[2]} << 16U;
    constexpr std::uint32_t kErrorOrMore = 0xFE0000;  // J1939-71: indicators of 3 bytes
    heard_ = at;
    pitch_deg_ = raw < kErrorOrMore ? std::optional(raw / 32768.0 - 250.0)  // SPN 3318
                                    : std::nullopt;
  }
  /// Inclination of the boom above the horizon; empty when it is not known.
  [[nodiscard]] std::optional<double> inclination_deg(std::chrono::nanoseconds now) const {
    return pitch_deg_ && now - heard_ < kSilence ? pitch_deg_ : std::nullopt;
  }

 private:
  std::chrono::nanoseconds heard_{};
  std::optional<double> pitch_deg_;
};
