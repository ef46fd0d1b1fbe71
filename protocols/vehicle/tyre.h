// Tyres: their state (TIRE1, TIRE2, TPRI), the inflation set point (TPRS), one message for each
// tyre; and the channels of central tyre inflation (TP1, TP2, TP3). Pressures are above ambient.
#pragma once

#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// Places of the tyres: axle in the high four bits, front to rear; position in the low four, left
/// to right. Order: front left, front right, rear left, rear right.
inline constexpr std::array<std::uint8_t, 4> kTyreLocations{0x00, 0x01, 0x10, 0x11};

/// The place in kTyreLocations; nothing for others.
[[nodiscard]] constexpr std::optional<std::size_t> tyre_of(std::uint8_t location) {
  for (std::size_t tyre = 0; tyre < kTyreLocations.size(); ++tyre) {
    if (kTyreLocations[tyre] == location) {
      return tyre;
    }
  }
  return std::nullopt;
}

/// Tire Condition 1.
struct Tire1 {
  static constexpr Group kGroup{"TIRE1", 65268, 6, std::chrono::seconds{10}};

  std::uint8_t location = 0xFF;
  double pressure_pa = kNotAvailable;
  double temperature_c = kNotAvailable;
  Switch sensor_enabled = Switch::not_available;
  Switch leak_detected = Switch::not_available;
  Switch sensor_fault = Switch::not_available;
  Switch extended_support = Switch::not_available;  ///< TIRE2 is sent.
  double leakage_paps = kNotAvailable;
  std::uint8_t pressure_threshold = 7;  ///< 3 bits.

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 929, {1}, 8, &Tire1::location),
        number("tyre pressure", 241, {2}, 8, {4000.0, 0.0, "Pa", kInKilopascal},
               &Tire1::pressure_pa),
        number("tyre temperature", 242, {3}, 16, {1.0 / 32.0, -273.0, "degC"},
               &Tire1::temperature_c),
        state("sensor enabled", 1699, {5, 1}, &Tire1::sensor_enabled),
        state("tyre status", 1698, {5, 3}, &Tire1::leak_detected),
        state("sensor electrical fault", 1697, {5, 5}, &Tire1::sensor_fault),
        state("extended pressure support", 6990, {5, 7}, &Tire1::extended_support),
        number("air leakage rate", 2586, {6}, 16, {0.1, 0.0, "Pa/s"}, &Tire1::leakage_paps),
        code("pressure threshold", 2587, {8, 6}, 3, &Tire1::pressure_threshold),
    };
  }
};

/// Tire Condition 2.
struct Tire2 {
  static constexpr Group kGroup{"TIRE2", 64578, 6, std::chrono::seconds{10}};

  std::uint8_t location = 0xFF;
  double pressure_pa = kNotAvailable;
  double required_pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 6987, {1}, 8, &Tire2::location),
        number("tyre pressure, extended range", 6988, {2}, 16, {1000.0, 0.0, "Pa", kInKilopascal},
               &Tire2::pressure_pa),
        number("required tyre pressure", 6989, {4}, 16, {1000.0, 0.0, "Pa", kInKilopascal},
               &Tire2::required_pressure_pa),
    };
  }
};

inline constexpr Group kTpri{"TPRI", 64953, 6, std::chrono::milliseconds{0}};
inline constexpr Group kTprs{"TPRS", 44544, 6, std::chrono::milliseconds{0}};

/// A tyre's reference pressure; `first` and the next are its SPN.
template <const Group& group, std::uint32_t first>
struct TyreReference {
  static constexpr Group kGroup = group;

  std::uint8_t location = 0xFF;
  double reference_pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    using M = TyreReference;
    return std::array{
        code("tyre location", first, {1}, 8, &M::location),
        number("reference tyre pressure", first + 1, {2}, 8, {8000.0, 0.0, "Pa", kInKilopascal},
               &M::reference_pressure_pa),
    };
  }
};
/// Tire Pressure Reference Information.
using Tpri = TyreReference<kTpri, 3190>;
/// Tire Pressure Reference Setting, addressed: the set point of central tyre inflation.
using Tprs = TyreReference<kTprs, 3192>;

/// What a channel of central tyre inflation does. Source of the codes: general knowledge of
/// J1939-71 (maintain, inflate, deflate, confirm).
enum class TyreChannelMode : std::uint8_t {
  maintain = 0,
  inflate = 1,
  deflate = 2,
  not_available = 0xF,
};

/// Tire Pressure Control Unit Mode and Status.
struct Tp1 {
  static constexpr Group kGroup{"TP1", 65144, 6, std::chrono::milliseconds{0}};

  double check_interval_s = kNotAvailable;
  std::uint8_t steer_mode = 0xF;  ///< TyreChannelMode, this and the next two.
  std::uint8_t trailer_mode = 0xF;
  std::uint8_t drive_mode = 0xF;
  Switch drive_solenoid = Switch::not_available;
  Switch steer_solenoid = Switch::not_available;
  Switch supply_switch = Switch::not_available;
  Switch deflate_solenoid = Switch::not_available;
  Switch control_solenoid = Switch::not_available;
  Switch supply_solenoid = Switch::not_available;
  Switch trailer_solenoid = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        number("check interval", 39, {1}, 8, {60.0, 0.0, "s", kInMinute}, &Tp1::check_interval_s),
        code("steer channel mode", 1466, {2, 1}, 4, &Tp1::steer_mode),
        code("trailer channel mode", 1467, {3, 1}, 4, &Tp1::trailer_mode),
        code("drive channel mode", 1468, {3, 5}, 4, &Tp1::drive_mode),
        state("drive solenoid", 1469, {4, 1}, &Tp1::drive_solenoid),
        state("steer solenoid", 1470, {4, 3}, &Tp1::steer_solenoid),
        state("supply switch", 1471, {4, 5}, &Tp1::supply_switch),
        state("deflate solenoid", 1472, {5, 1}, &Tp1::deflate_solenoid),
        state("control solenoid", 1473, {5, 3}, &Tp1::control_solenoid),
        state("supply solenoid", 1474, {5, 5}, &Tp1::supply_solenoid),
        state("trailer solenoid", 1475, {5, 7}, &Tp1::trailer_solenoid),
    };
  }
};

/// The pressures of the channels. Steer: front axle; drive: rear axle.
struct ChannelNumbers {
  Group group;
  std::array<std::string_view, 3> names;
  std::uint32_t first_spn;
};
inline constexpr ChannelNumbers kTp2{
    {"TP2", 65145, 6, std::chrono::milliseconds{0}},
    {"trailer channel target", "drive channel target", "steer channel target"},
    141};
inline constexpr ChannelNumbers kTp3{
    {"TP3", 65146, 6, std::chrono::milliseconds{0}},
    {"trailer channel pressure", "drive channel pressure", "steer channel pressure"},
    144};
template <const ChannelNumbers& numbers>
struct ChannelPressures {
  static constexpr Group kGroup = numbers.group;

  double trailer_pa = kNotAvailable;
  double drive_pa = kNotAvailable;
  double steer_pa = kNotAvailable;

  static constexpr auto parameters() {
    using M = ChannelPressures;
    constexpr Scale kPressure{500.0, 0.0, "Pa", kInKilopascal};
    constexpr std::uint32_t kFirst = numbers.first_spn;
    return std::array{
        number(numbers.names[0], kFirst, {1}, 16, kPressure, &M::trailer_pa),
        number(numbers.names[1], kFirst + 1, {3}, 16, kPressure, &M::drive_pa),
        number(numbers.names[2], kFirst + 2, {5}, 16, kPressure, &M::steer_pa),
    };
  }
};
/// Tire Pressure Control Unit Target Pressures, and Current Pressures.
using Tp2 = ChannelPressures<kTp2>;
using Tp3 = ChannelPressures<kTp3>;

}  // namespace rigwire::protocols::vehicle
