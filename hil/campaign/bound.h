// Values of criteria and the units of what they are compared with.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "hil/campaign/campaign_file.h"
#include "hil/executive/truth_source.h"

namespace rigwire::hil {

/// Returns the unit that a key of the truth or of a report names at its end: "rad" of
/// "joint_rad.1", "us" of "lateness_us.p99". Empty when it names none.
[[nodiscard]] std::string_view unit_of_key(std::string_view path);

/// Returns the unit of a quantity of criteria: of a word its own, "state.boom" included, of a key
/// what it names.
[[nodiscard]] std::string_view unit_of_quantity(std::string_view name,
                                                std::span<const StateQuantity> quantities);

/// The value of a criterion beside a quantity.
class Bound {
 public:
  /// `own_unit`: the quantity's unit as fields/units.h spells it; empty: it has none. Throws
  /// std::invalid_argument, "wrong unit, found ..., allowed ...", for a unit of another dimension.
  Bound(const WrittenValue& value, std::string_view own_unit);

  /// Returns the bound in the quantity's own unit.
  [[nodiscard]] double own() const { return own_; }
  /// Returns the bound as the user wrote it, a bare number with the quantity's own unit: "55 deg".
  [[nodiscard]] std::string text() const;
  /// Returns a value of the quantity in text()'s unit, six significant digits: "47.2803 deg".
  [[nodiscard]] std::string shown(double own_value) const;

 private:
  double written_ = 0.0;
  double own_ = 0.0;
  std::string unit_;      ///< Unit of `written_`.
  double to_unit_ = 1.0;  ///< Factor from the quantity's own unit to `unit_`.
};

}  // namespace rigwire::hil
