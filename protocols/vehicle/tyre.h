// Tyres: their state (TIRE1, TIRE2, TPRI) and the inflation set point (TPRS). One message for each
// tyre; pressures are above ambient.
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

/// One count of 8 kPa.
inline constexpr Scale kReferencePressure{8000.0, 0.0, "Pa"};

/// Tire Condition 1.
struct Tire1 {
  static constexpr Group kGroup{"TIRE1", 65268, 6, std::chrono::seconds{10}};

  std::uint8_t location = 0xFF;
  double pressure_pa = kNotAvailable;
  double temperature_c = kNotAvailable;
  double leakage_paps = kNotAvailable;
  std::uint8_t pressure_threshold = 7;  ///< 3 bits.

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 929, {1}, 8, &Tire1::location),
        number("tyre pressure", 241, {2}, 8, {4000.0, 0.0, "Pa"}, &Tire1::pressure_pa),
        number("tyre temperature", 242, {3}, 16, {1.0 / 32.0, -273.0, "degC"},
               &Tire1::temperature_c),
        number("air leakage rate", 2586, {6}, 16, {0.1, 0.0, "Pa/s"}, &Tire1::leakage_paps),
        code("pressure threshold", 2587, {8, 6}, 3, &Tire1::pressure_threshold),
    };
  }
};
static_assert(is_well_formed<Tire1>());

/// Tire Condition 2.
struct Tire2 {
  static constexpr Group kGroup{"TIRE2", 64578, 6, std::chrono::seconds{10}};

  std::uint8_t location = 0xFF;
  double pressure_pa = kNotAvailable;
  double required_pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 929, {1}, 8, &Tire2::location),
        number("tyre pressure, extended range", 6988, {2}, 16, {1000.0, 0.0, "Pa"},
               &Tire2::pressure_pa),
        number("required tyre pressure", 6989, {4}, 16, {1000.0, 0.0, "Pa"},
               &Tire2::required_pressure_pa),
    };
  }
};
static_assert(is_well_formed<Tire2>());

/// Tire Pressure Reference Information.
struct Tpri {
  static constexpr Group kGroup{"TPRI", 64953, 6, std::chrono::milliseconds{0}};

  std::uint8_t location = 0xFF;
  double reference_pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 0, {1}, 8, &Tpri::location),
        number("reference tyre pressure", 0, {2}, 8, kReferencePressure,
               &Tpri::reference_pressure_pa),
    };
  }
};
static_assert(is_well_formed<Tpri>());

/// Tire Pressure Reference Setting, addressed: the set point of central tyre inflation.
struct Tprs {
  static constexpr Group kGroup{"TPRS", 44544, 6, std::chrono::milliseconds{0}};

  std::uint8_t location = 0xFF;
  double reference_pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        code("tyre location", 0, {1}, 8, &Tprs::location),
        number("reference tyre pressure", 0, {2}, 8, kReferencePressure,
               &Tprs::reference_pressure_pa),
    };
  }
};
static_assert(is_well_formed<Tprs>());

}  // namespace rigwire::protocols::vehicle
