// Numbers of mathematics and physics that every folder above uses, each once.
#pragma once

#include <cstdint>
#include <numbers>

namespace rigwire {

/// Radians in a degree and in a full turn, and degrees in a radian.
inline constexpr double kDegree = std::numbers::pi / 180.0;
inline constexpr double kTurn = 2.0 * std::numbers::pi;
inline constexpr double kDegreesPerRadian = 57.295779513082320877;

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;
inline constexpr std::int64_t kHour_ns = 3600 * kSecond_ns;
/// A day and a week without a leap second.
inline constexpr std::int64_t kDay_s = 86'400;
inline constexpr std::int64_t kWeek_s = 7 * kDay_s;

/// Standard gravity (3rd General Conference on Weights and Measures, 1901).
inline constexpr double kGravity_mps2 = 9.80665;

/// Speed of light in a vacuum (International System of Units, 9th edition, section 2.2).
inline constexpr double kSpeedOfLight_mps = 299792458.0;

}  // namespace rigwire
