#include "hil/campaign/bound.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "fields/units.h"
#include "hil/configuration/plain_text.h"
#include "hil/world/quantities.h"

namespace rigwire::hil {

namespace {

/// How keys spell units, beside fields/units.h. Joules are in no file, so that nothing converts
/// them.
constexpr std::array<std::pair<std::string_view, std::string_view>, 19> kUnitsOfKeys{
    {{"m", "m"},
     {"m3", "m3"},
     {"rad", "rad"},
     {"deg", "deg"},
     {"mps", "m/s"},
     {"radps", "rad/s"},
     {"mps2", "m/s2"},
     {"m3ps", "m3/s"},
     {"n", "N"},
     {"nm", "N m"},
     {"pa", "Pa"},
     {"w", "W"},
     {"kg", "kg"},
     {"kgps", "kg/s"},
     {"s", "s"},
     {"ms", "ms"},
     {"us", "us"},
     {"radps2", "rad/s2"},
     {"j", "J"}}};

std::string with_unit(const std::string& number, std::string_view unit) {
  return unit.empty() || unit == "1" ? number : fmt::format("{} {}", number, unit);
}

}  // namespace

std::string_view unit_of_key(std::string_view path) {
  // The last word that names a unit: "p99" of "lateness_us.p99" does not, nor an element's number.
  while (!path.empty()) {
    const std::size_t dot = path.rfind('.');
    const std::string_view word = dot == std::string_view::npos ? path : path.substr(dot + 1);
    if (const std::size_t line = word.rfind('_'); line != std::string_view::npos) {
      const auto found = std::ranges::find(kUnitsOfKeys, word.substr(line + 1),
                                           &std::pair<std::string_view, std::string_view>::first);
      return found != kUnitsOfKeys.end() ? found->second : std::string_view();
    }
    path = dot == std::string_view::npos ? std::string_view() : path.substr(0, dot);
  }
  return {};
}

std::string_view unit_of_quantity(std::string_view name,
                                  std::span<const StateQuantity> quantities) {
  constexpr std::string_view kUnderState = "state.";
  const std::string_view word =
      name.starts_with(kUnderState) ? name.substr(kUnderState.size()) : name;
  const auto place = find_quantity(quantities, word);
  return place ? std::string_view(quantities[*place].unit) : unit_of_key(name);
}

Bound::Bound(const WrittenValue& value, std::string_view own_unit) : unit_(own_unit) {
  const auto number = fields::split_quantity(value.text);
  if (!number) {
    throw std::invalid_argument(
        fmt::format("not a number, found \"{}\", allowed a number, alone or with its unit",
                    printable(value.text)));
  }
  written_ = own_ = number->value;
  if (number->unit.empty() || number->unit == own_unit) {
    return;
  }
  std::string allowed = own_unit.empty() ? "a bare number" : std::string(own_unit);
  for (const fields::Unit& own : fields::all_units()) {
    if (own.symbol != own_unit) {
      continue;
    }
    allowed = fields::allowed_units(own.dimension);
    if (const fields::Unit* unit = fields::find_unit(number->unit, own.dimension)) {
      unit_ = unit->symbol;
      own_ = fields::NumberRule(*unit, own).to_stored(written_, *unit);
      to_unit_ = fields::NumberRule(own, *unit).to_stored(1.0, own);
      return;
    }
  }
  throw std::invalid_argument(
      fmt::format("wrong unit, found \"{}\", allowed {}", printable(value.text), allowed));
}

std::string Bound::text() const {
  return with_unit(fields::shortest(written_), unit_);
}

std::string Bound::shown(double own_value) const {
  return with_unit(fmt::format("{:.6g}", to_unit_ * own_value), unit_);
}

}  // namespace rigwire::hil
