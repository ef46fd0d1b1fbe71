// Body axis and sign of each value on the wire, defined in one place.
//
// The device uses x forward, y right, z down (aerospace). Its user-behaviour word changes what it
// sends (openIMU300-lib, default 0xC248):
//   swap_pitch_roll  angles and rates in the order pitch, roll, yaw and accelerations in the order
//                    lateral, longitudinal, vertical, as the J1939 annex names them; otherwise in
//                    the order x, y, z.
//   north_west_up    accelerations with y left and z up (at rest and level: vertical +9.81 m/s2).
// Angles and rates always stay aerospace: pitch positive nose up, roll positive right side down,
// yaw rate positive clockwise seen from above. This is how the tcan driver of ETH's excavator group
// reads the device.
//
// The orientation word turns the housing first: 24 codes, one per right-handed choice of axes.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace rigwire::protocols::openimu {

/// Bits of the user-behaviour word (parameter group FF59).
struct Behaviour {
  static constexpr std::uint16_t kSwapPitchRoll = 0x0008;
  static constexpr std::uint16_t kNorthWestUp = 0x0040;
  static constexpr std::uint16_t kSwapRequestPgn = 0x0200;  ///< Requests carry the low byte first.
  static constexpr std::uint16_t kUseMagnetometers = 0x4000;
  static constexpr std::uint16_t kRunAlgorithm = 0x8000;
  static constexpr std::uint16_t kDefault =
      kSwapPitchRoll | kNorthWestUp | kSwapRequestPgn | kUseMagnetometers | kRunAlgorithm;
};
static_assert(Behaviour::kDefault == 0xC248);

/// `sign` times component `axis` (0 x, 1 y, 2 z).
struct SignedAxis {
  std::uint8_t axis = 0;
  double sign = 1.0;

  friend bool operator==(const SignedAxis&, const SignedAxis&) = default;
};
using AxisMap = std::array<SignedAxis, 3>;

/// Body axes x forward, y left, z up (the samples) to the device's x forward, y right, z down.
inline constexpr AxisMap kForwardLeftUpToDevice{{{0, 1.0}, {1, -1.0}, {2, -1.0}}};

/// Device axes to the three rate fields.
[[nodiscard]] constexpr AxisMap rate_axes(std::uint16_t behaviour) {
  if ((behaviour & Behaviour::kSwapPitchRoll) != 0) {
    return {{{1, 1.0}, {0, 1.0}, {2, 1.0}}};
  }
  return {{{0, 1.0}, {1, 1.0}, {2, 1.0}}};
}

/// Device axes to the three acceleration fields.
[[nodiscard]] constexpr AxisMap acceleration_axes(std::uint16_t behaviour) {
  const double sign = (behaviour & Behaviour::kNorthWestUp) != 0 ? -1.0 : 1.0;
  if ((behaviour & Behaviour::kSwapPitchRoll) != 0) {
    return {{{1, sign}, {0, 1.0}, {2, sign}}};
  }
  return {{{0, 1.0}, {1, sign}, {2, sign}}};
}

/// Whether the slope message carries pitch first (otherwise roll, the x axis, first).
[[nodiscard]] constexpr bool pitch_first(std::uint16_t behaviour) {
  return (behaviour & Behaviour::kSwapPitchRoll) != 0;
}

[[nodiscard]] constexpr std::array<double, 3> map_axes(const AxisMap& map,
                                                       const std::array<double, 3>& in) {
  return {map[0].sign * in[map[0].axis], map[1].sign * in[map[1].axis],
          map[2].sign * in[map[2].axis]};
}

/// The housing axes that serve as x, y, z for an orientation word; nothing for the words that are
/// not among the 24 right-handed ones. Layout: bit 0 sign of x, 1-2 axis of x (x, y, z), 3 sign of
/// y, 4-5 axis of y (y, z, x), 6 sign of z, 7-8 axis of z (z, x, y).
[[nodiscard]] inline std::optional<AxisMap> orientation_axes(std::uint16_t word) {
  if (word > 0x1FF) {
    return std::nullopt;
  }
  AxisMap map;
  for (unsigned i = 0; i < 3; ++i) {
    const unsigned code = word >> (3 * i);
    const unsigned choice = (code >> 1U) & 3U;
    if (choice == 3) {
      return std::nullopt;
    }
    map[i] = {static_cast<std::uint8_t>((i + choice) % 3), (code & 1U) != 0 ? -1.0 : 1.0};
  }
  if (map[0].axis == map[1].axis || map[1].axis == map[2].axis || map[0].axis == map[2].axis) {
    return std::nullopt;
  }
  // Right-handed: an even permutation with an even number of minus signs, or both odd.
  const bool even = map[1].axis == (map[0].axis + 1) % 3;
  const double signs = map[0].sign * map[1].sign * map[2].sign;
  if ((even ? 1.0 : -1.0) * signs < 0.0) {
    return std::nullopt;
  }
  return map;
}

}  // namespace rigwire::protocols::openimu
