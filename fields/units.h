// Units that a configuration may write, and the rule that a number field carries.
//
// Each unit belongs to a dimension; a field accepts every unit of its dimension. The factor to the
// SI unit is a fraction, so that 9 mm is the double nearest to 0.009, not 9 * 0.001.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rigwire::fields {

enum class Dimension {
  none,
  ratio,
  length,
  area,
  volume,
  angle,
  time,
  frequency,
  angular_rate,
  angular_acceleration,
  speed,
  acceleration,
  mass,
  inertia,
  force,
  torque,
  pressure,
  flow,
  power,
  stiffness,
  damping,
  angular_damping,
  density,
  temperature,
  bit_rate,
  angle_random_walk,
  velocity_random_walk,
  signal_density,
  level,
  level_density,
  temperature_difference,
  thermal_resistance,
  voltage,
  current,
  resistance,
  inductance,
  magnetic_field,
  area_density,
  angular_stiffness,
  angular_displacement,
  angular_rate_walk,
  acceleration_walk,
  rate_per_acceleration,
  inverse_temperature,
  magnetic_noise_density,
  length_per_distance,
  length_per_level,
  areal_count,
  solid_angle,
  mass_extinction,
  diffusivity,
  cornering_stiffness,
  flow_conductance,
  mass_flow,
  angle_per_length
};

struct Unit {
  std::string_view symbol;  ///< Spelling in a file.
  Dimension dimension;
  double numerator;    ///< SI value = value * numerator / denominator.
  double denominator;  ///< Never zero.
};

/// All units, the SI unit of each dimension first within the dimension.
[[nodiscard]] std::span<const Unit> all_units();

namespace detail {
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kGravity = 9.80665;  ///< Standard gravity, m/s2.

// clang-format off
inline constexpr Unit kUnits[] = {
    {"", Dimension::none, 1, 1},
    {"1", Dimension::ratio, 1, 1}, {"%", Dimension::ratio, 1, 100},
    {"ppm", Dimension::ratio, 1, 1e6},
    {"m", Dimension::length, 1, 1}, {"km", Dimension::length, 1000, 1},
    {"cm", Dimension::length, 1, 100}, {"mm", Dimension::length, 1, 1000},
    {"um", Dimension::length, 1, 1e6},
    {"m2", Dimension::area, 1, 1}, {"cm2", Dimension::area, 1, 1e4},
    {"mm2", Dimension::area, 1, 1e6},
    {"m3", Dimension::volume, 1, 1}, {"l", Dimension::volume, 1, 1000},
    {"cm3", Dimension::volume, 1, 1e6},
    {"rad", Dimension::angle, 1, 1}, {"mrad", Dimension::angle, 1, 1000},
    {"deg", Dimension::angle, kPi, 180},
    {"s", Dimension::time, 1, 1}, {"ms", Dimension::time, 1, 1000},
    {"us", Dimension::time, 1, 1e6}, {"ns", Dimension::time, 1, 1e9},
    {"min", Dimension::time, 60, 1}, {"h", Dimension::time, 3600, 1},
    {"Hz", Dimension::frequency, 1, 1}, {"kHz", Dimension::frequency, 1000, 1},
    {"MHz", Dimension::frequency, 1e6, 1},
    {"rad/s", Dimension::angular_rate, 1, 1}, {"deg/s", Dimension::angular_rate, kPi, 180},
    {"deg/h", Dimension::angular_rate, kPi, 648000},
    {"rpm", Dimension::angular_rate, kPi, 30},
    {"rad/s2", Dimension::angular_acceleration, 1, 1},
    {"deg/s2", Dimension::angular_acceleration, kPi, 180},
    {"m/s", Dimension::speed, 1, 1}, {"mm/s", Dimension::speed, 1, 1000},
    {"km/h", Dimension::speed, 1, 3.6}, {"mm/h", Dimension::speed, 1, 3.6e6},
    {"m/s2", Dimension::acceleration, 1, 1}, {"mm/s2", Dimension::acceleration, 1, 1000},
    {"g", Dimension::acceleration, kGravity, 1}, {"mg", Dimension::acceleration, kGravity, 1000},
    {"ug", Dimension::acceleration, kGravity, 1e6},
    {"kg", Dimension::mass, 1, 1}, {"t", Dimension::mass, 1000, 1},
    {"g", Dimension::mass, 1, 1000},
    {"kg m2", Dimension::inertia, 1, 1},
    {"N", Dimension::force, 1, 1}, {"kN", Dimension::force, 1000, 1},
    {"MN", Dimension::force, 1e6, 1},
    {"N m", Dimension::torque, 1, 1}, {"kN m", Dimension::torque, 1000, 1},
    {"Pa", Dimension::pressure, 1, 1}, {"kPa", Dimension::pressure, 1000, 1},
    {"MPa", Dimension::pressure, 1e6, 1}, {"bar", Dimension::pressure, 1e5, 1},
    {"m3/s", Dimension::flow, 1, 1}, {"l/min", Dimension::flow, 1, 60000},
    {"l/s", Dimension::flow, 1, 1000},
    {"W", Dimension::power, 1, 1}, {"kW", Dimension::power, 1000, 1},
    {"N/m", Dimension::stiffness, 1, 1}, {"kN/m", Dimension::stiffness, 1000, 1},
    {"MN/m", Dimension::stiffness, 1e6, 1},
    {"N s/m", Dimension::damping, 1, 1}, {"kN s/m", Dimension::damping, 1000, 1},
    {"N m s/rad", Dimension::angular_damping, 1, 1},
    {"kN m s/rad", Dimension::angular_damping, 1000, 1},
    {"kg/m3", Dimension::density, 1, 1}, {"t/m3", Dimension::density, 1000, 1},
    {"degC", Dimension::temperature, 1, 1},
    {"bit/s", Dimension::bit_rate, 1, 1}, {"kbit/s", Dimension::bit_rate, 1000, 1},
    {"Mbit/s", Dimension::bit_rate, 1e6, 1},
    {"rad/sqrt(s)", Dimension::angle_random_walk, 1, 1},
    {"deg/sqrt(h)", Dimension::angle_random_walk, kPi, 10800},
    {"deg/s/sqrt(Hz)", Dimension::angle_random_walk, kPi, 180},
    {"m/s/sqrt(s)", Dimension::velocity_random_walk, 1, 1},
    {"m/s/sqrt(h)", Dimension::velocity_random_walk, 1, 60},
    {"ug/sqrt(Hz)", Dimension::velocity_random_walk, kGravity, 1e6},
    {"dBHz", Dimension::signal_density, 1, 1},
    {"dB", Dimension::level, 1, 1},
    {"dB/m", Dimension::level_density, 1, 1},
    {"K", Dimension::temperature_difference, 1, 1},
    {"K/W", Dimension::thermal_resistance, 1, 1},
    {"V", Dimension::voltage, 1, 1}, {"mV", Dimension::voltage, 1, 1000},
    {"A", Dimension::current, 1, 1}, {"mA", Dimension::current, 1, 1000},
    {"ohm", Dimension::resistance, 1, 1}, {"mohm", Dimension::resistance, 1, 1000},
    {"H", Dimension::inductance, 1, 1}, {"mH", Dimension::inductance, 1, 1000},
    {"T", Dimension::magnetic_field, 1, 1}, {"mT", Dimension::magnetic_field, 1, 1000},
    {"uT", Dimension::magnetic_field, 1, 1e6}, {"nT", Dimension::magnetic_field, 1, 1e9},
    {"kg/m2", Dimension::area_density, 1, 1},
    {"N m/rad", Dimension::angular_stiffness, 1, 1},
    {"kN m/rad", Dimension::angular_stiffness, 1000, 1},
    {"MN m/rad", Dimension::angular_stiffness, 1e6, 1},
    {"m3/rad", Dimension::angular_displacement, 1, 1},
    {"l/rad", Dimension::angular_displacement, 1, 1000},
    {"rad/s/sqrt(s)", Dimension::angular_rate_walk, 1, 1},
    {"deg/s/sqrt(s)", Dimension::angular_rate_walk, kPi, 180},
    {"m/s2/sqrt(s)", Dimension::acceleration_walk, 1, 1},
    {"rad/s/(m/s2)", Dimension::rate_per_acceleration, 1, 1},
    {"deg/s/g", Dimension::rate_per_acceleration, kPi, 180 * kGravity},
    {"1/K", Dimension::inverse_temperature, 1, 1},
    {"ppm/K", Dimension::inverse_temperature, 1, 1e6},
    {"T/sqrt(Hz)", Dimension::magnetic_noise_density, 1, 1},
    {"nT/sqrt(Hz)", Dimension::magnetic_noise_density, 1, 1e9},
    {"m/km", Dimension::length_per_distance, 1, 1},
    {"mm/km", Dimension::length_per_distance, 1, 1000},
    {"m/dB", Dimension::length_per_level, 1, 1},
    {"1/m2", Dimension::areal_count, 1, 1}, {"1/ha", Dimension::areal_count, 1, 1e4},
    {"sr", Dimension::solid_angle, 1, 1},
    {"m2/kg", Dimension::mass_extinction, 1, 1},
    {"m2/s", Dimension::diffusivity, 1, 1},
    {"N/rad", Dimension::cornering_stiffness, 1, 1},
    {"kN/rad", Dimension::cornering_stiffness, 1000, 1},
    {"m3/s/Pa", Dimension::flow_conductance, 1, 1},
    {"kg/s", Dimension::mass_flow, 1, 1},
    {"rad/m", Dimension::angle_per_length, 1, 1},
    {"deg/m", Dimension::angle_per_length, kPi, 180},
};
// clang-format on
}  // namespace detail

/// What a number field holds: the unit a bare number is in, the unit of the struct's member (the SI
/// unit unless said otherwise), and the range. Built in a visit function:
///
///   v.number("stroke", p.stroke_m, in("mm").above(0), "Full travel of the rod.");
///
/// An unknown symbol does not compile.
class NumberRule {
 public:
  constexpr NumberRule(const Unit& written, const Unit& stored)
      : written_(&written), stored_(&stored) {}

  /// Bounds in the written unit; `above` and `below` exclude the bound itself.
  [[nodiscard]] constexpr NumberRule at_least(double bound) const {
    NumberRule rule = *this;
    rule.lower_ = bound;
    return rule;
  }
  [[nodiscard]] constexpr NumberRule above(double bound) const {
    NumberRule rule = at_least(bound);
    rule.lower_open_ = true;
    return rule;
  }
  [[nodiscard]] constexpr NumberRule at_most(double bound) const {
    NumberRule rule = *this;
    rule.upper_ = bound;
    return rule;
  }
  [[nodiscard]] constexpr NumberRule between(double lower, double upper) const {
    return at_least(lower).at_most(upper);
  }
  [[nodiscard]] constexpr NumberRule stored_as(std::string_view symbol) const;

  [[nodiscard]] constexpr const Unit& written() const { return *written_; }
  [[nodiscard]] constexpr const Unit& stored() const { return *stored_; }
  /// Whether the member's value is within the range. A bound that was written and converted is.
  [[nodiscard]] bool contains(double stored_value) const;
  [[nodiscard]] double lower() const { return lower_; }
  [[nodiscard]] double upper() const { return upper_; }
  [[nodiscard]] bool lower_is_open() const { return lower_open_; }
  /// "> 0 mm", "0 .. 90 deg", empty without bounds.
  [[nodiscard]] std::string range_text() const;
  /// Converts a value given in `unit` (of the same dimension) to the member's unit.
  [[nodiscard]] double to_stored(double value, const Unit& unit) const;
  /// Converts the member's value to the written unit, for the range check and for printing.
  [[nodiscard]] double to_written(double stored_value) const;
  /// Text that reads back as exactly this member value, in the written unit where a double of it
  /// exists, else in the member's own unit.
  [[nodiscard]] std::string print(double stored_value) const;

 private:
  const Unit* written_;
  const Unit* stored_;
  double lower_ = -std::numeric_limits<double>::infinity();
  double upper_ = std::numeric_limits<double>::infinity();
  bool lower_open_ = false;
};

namespace detail {

/// The unit of that symbol within a dimension, or within all (the first match). Throws, which is a
/// compile error where the call must be constant.
constexpr const Unit& unit_named(std::string_view symbol,
                                 std::optional<Dimension> dimension = std::nullopt) {
  for (const Unit& unit : kUnits) {
    if (unit.symbol == symbol && (!dimension || unit.dimension == *dimension)) {
      return unit;
    }
  }
  throw "no such unit: add it to the table in fields/units.h";
}

constexpr const Unit& si_unit(Dimension dimension) {
  for (const Unit& unit : kUnits) {
    if (unit.dimension == dimension) {
      return unit;
    }
  }
  throw "no such dimension";
}

}  // namespace detail

constexpr NumberRule NumberRule::stored_as(std::string_view symbol) const {
  NumberRule rule = *this;
  rule.stored_ = &detail::unit_named(symbol, written_->dimension);
  return rule;
}

/// A field whose bare numbers are in `symbol` and whose member holds the SI unit.
consteval NumberRule in(std::string_view symbol) {
  const Unit& unit = detail::unit_named(symbol);
  return NumberRule(unit, detail::si_unit(unit.dimension));
}

/// Rule of in() for a symbol that two dimensions share ("g").
consteval NumberRule in(std::string_view symbol, Dimension dimension) {
  return NumberRule(detail::unit_named(symbol, dimension), detail::si_unit(dimension));
}

/// A count or coefficient without unit.
consteval NumberRule plain() {
  return in("");
}

/// For the unit of a whole number's rule. An unknown symbol does not compile.
consteval const Unit* unit(std::string_view symbol) {
  return &detail::unit_named(symbol);
}

/// A written quantity, taken apart.
struct Quantity {
  double value = 0.0;
  std::string_view unit;  ///< Empty for a bare number.
};

/// Splits "1050 mm", "5Hz", "-3.5e2". Empty when it does not begin with a number; "nan" and "inf"
/// in YAML's and C's spellings are numbers here, so that they can be refused by name.
[[nodiscard]] std::optional<Quantity> split_quantity(std::string_view text);

/// The unit with that symbol that belongs to `dimension`; null when there is none.
[[nodiscard]] const Unit* find_unit(std::string_view symbol, Dimension dimension);

/// "mm, cm, m" for messages; "a bare number" for a dimension without units, and for the unit 1.
[[nodiscard]] std::string allowed_units(Dimension dimension);

/// Shortest decimal text that reads back as the same double.
[[nodiscard]] std::string shortest(double value);

}  // namespace rigwire::fields
