// GLONASS' navigation message of L1OF and L2OF: strings of 85 bits, 2 s each, fifteen to a frame.
//
// Source: GLONASS ICD, edition 5.1 (2008), section 4.4 (structure, words of strings 1 to 5, table
// 4.5), 4.7 (Hamming code with an overall parity bit). Bits are numbered 85 (sent first, 0) to 1.
// Times are those of GLONASS: UTC and three hours. Numbers are a sign and a magnitude.
//
// Strings 6 to 15, the almanac, are not here.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/result.h"

namespace rigwire::protocols::glonass {

inline constexpr std::int32_t kStringSeconds = 2;
inline constexpr std::int32_t kFrameSeconds = 30;
inline constexpr std::int32_t kFramesOfSuperframe = 5;
inline constexpr std::int32_t kTimeStep_s = 900;  ///< Step of Ephemeris::time_of_day_s.

/// 85 bits, bit 85 highest in the first word; the last eleven bits are 0.
using String = std::array<std::uint32_t, 3>;

/// Position and motion in PZ-90, earth-fixed, and clock.
struct Ephemeris {
  std::uint8_t slot = 0;           ///< 1..24.
  std::int32_t time_of_day_s = 0;  ///< tb, a multiple of 900 s.
  std::array<double, 3> position_m{};
  std::array<double, 3> velocity_mps{};
  std::array<double, 3> acceleration_mps2{};  ///< By sun and moon.
  double clock_correction_s = 0.0;            ///< tau: system time less the satellite's.
  double frequency_offset = 0.0;              ///< gamma.
  double second_delay_s = 0.0;                ///< Delta tau: of L2 beyond L1.
  bool healthy = true;
  std::uint8_t accuracy = 2;  ///< F_T, table 4.4: 2 is 2.5 m.

  friend bool operator==(const Ephemeris&, const Ephemeris&) = default;
};

/// The frame in which a string is sent, by GLONASS' time.
struct FrameTime {
  std::uint32_t second_of_day = 0;  ///< At which the frame begins, a multiple of 30.
  std::uint16_t day = 1;            ///< 1..1461 of the four years that begin with a leap year.
  std::uint8_t four_years = 1;      ///< 1: 1996 to 1999.
};

/// String `number` 1 to 5 (precondition).
[[nodiscard]] String string(std::uint8_t number, const Ephemeris& ephemeris, const FrameTime& time);

/// Whether the code holds.
[[nodiscard]] bool is_sound(const String& string);

/// What strings 1 to 4 say. Malformed: an unsound string or another number (offset: which of them).
[[nodiscard]] Decoded<Ephemeris> decode_ephemeris(const std::array<String, 4>& strings);

}  // namespace rigwire::protocols::glonass
