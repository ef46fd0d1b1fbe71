// Engine configuration (EC1): an engine's torque curve and limits in forty bytes, by transport.
//
// Source: SAE J1939 digital annex, October 2020 (positions, SLOTs). Point 1 is at idle, point 2
// where full load ends, points 3 .. 5 lie between, point 6 is governed out without load; that order
// is general knowledge of J1939-71.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocols/result.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

inline constexpr std::uint32_t kEngineConfigurationPgn = 65251;  ///< FEE3, EC1.
inline constexpr std::chrono::milliseconds kEngineConfigurationPeriod{5000};
inline constexpr std::size_t kEngineConfigurationBytes = 40;

/// Speeds in rad/s, torques as shares of the reference torque, the engine's own friction included.
struct EngineConfiguration {
  static constexpr std::size_t kPoints = 5;
  std::array<double, kPoints> speed_radps{};  ///< Points 1 .. 5.
  std::array<double, kPoints> torque_share{};
  double high_idle_radps = kNotAvailable;
  double governor_gain_prad = kNotAvailable;  ///< Torque share per missing rad/s.
  double reference_torque_nm = kNotAvailable;
  double least_speed_radps = kNotAvailable;  ///< Min of requested speeds.
  double greatest_speed_radps = kNotAvailable;
  double least_torque_share = kNotAvailable;  ///< Min of requested torques.
  double greatest_torque_share = kNotAvailable;
  double inertia_kgm2 = kNotAvailable;

  friend bool operator==(const EngineConfiguration&, const EngineConfiguration&) = default;
};

/// Clamped to the signals; NaN is not available, an infinity an error.
[[nodiscard]] std::array<std::uint8_t, kEngineConfigurationBytes> encode_engine_configuration(
    const EngineConfiguration& configuration);
[[nodiscard]] Decoded<EngineConfiguration> decode_engine_configuration(
    std::span<const std::uint8_t> payload);

}  // namespace rigwire::protocols::vehicle
