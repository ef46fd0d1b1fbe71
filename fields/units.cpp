#include "fields/units.h"

#include <array>
#include <charconv>
#include <string>

namespace rigwire::fields {

std::span<const Unit> all_units() {
  return detail::kUnits;
}

namespace {

double convert(double value, const Unit& from, const Unit& to) {
  if (&from == &to) {
    return value;
  }
  // Multiplications by one are exact, so that the common cases stay one rounding.
  const double numerator = from.numerator * to.denominator;
  const double denominator = from.denominator * to.numerator;
  return value * numerator / denominator;
}

/// Writes a finite number as the shortest text that reads back, or with the given `precision`.
template <class... Precision>
std::string digits(double value, std::chars_format format, Precision... precision) {
  std::array<char, 400> text{};
  const auto result =
      std::to_chars(text.data(), text.data() + text.size(), value, format, precision...);
  return {text.data(), result.ptr};
}

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_space(text.back())) {
    text.remove_suffix(1);
  }
  return text;
}

}  // namespace

bool NumberRule::contains(double stored_value) const {
  // Bounds are converted as a written value is, so that both round alike.
  const double lower = to_stored(lower_, *written_);
  const double upper = to_stored(upper_, *written_);
  const bool above_lower = lower_open_ ? stored_value > lower : stored_value >= lower;
  return above_lower && stored_value <= upper;
}

std::string NumberRule::range_text() const {
  const std::string unit = written_->symbol.empty() || written_->dimension == Dimension::ratio
                               ? std::string(written_->symbol == "%" ? " %" : "")
                               : " " + std::string(written_->symbol);
  const bool has_lower = std::isfinite(lower_);
  const bool has_upper = std::isfinite(upper_);
  if (has_lower && has_upper) {
    return (lower_open_ ? "above " : "") + shortest(lower_) + " .. " + shortest(upper_) + unit;
  }
  if (has_lower) {
    return (lower_open_ ? "> " : ">= ") + shortest(lower_) + unit;
  }
  return has_upper ? "<= " + shortest(upper_) + unit : std::string();
}

double NumberRule::to_stored(double value, const Unit& unit) const {
  return convert(value, unit, *stored_);
}

double NumberRule::to_written(double stored_value) const {
  return convert(stored_value, *stored_, *written_);
}

std::string NumberRule::print(double stored_value) const {
  const auto with_unit = [](const std::string& number, const Unit& unit) {
    const bool bare = unit.symbol.empty() || unit.symbol == "1";
    return bare ? number : number + " " + std::string(unit.symbol);
  };
  if (!std::isfinite(stored_value)) {
    return with_unit(shortest(stored_value), *written_);
  }
  const double written = to_written(stored_value);
  const std::string rounded = digits(written, std::chars_format::general, 15);
  double reread = 0.0;
  std::from_chars(rounded.data(), rounded.data() + rounded.size(), reread);
  if (to_stored(reread, *written_) == stored_value) {
    return with_unit(rounded, *written_);
  }
  double up = written;
  double down = written;
  for (int step = 0; step < 4; ++step) {
    for (const double candidate : {up, down}) {
      if (to_stored(candidate, *written_) == stored_value) {
        return with_unit(shortest(candidate), *written_);
      }
    }
    up = std::nextafter(up, std::numeric_limits<double>::infinity());
    down = std::nextafter(down, -std::numeric_limits<double>::infinity());
  }
  return with_unit(shortest(stored_value), *stored_);
}

std::optional<Quantity> split_quantity(std::string_view text) {
  text = trim(text);
  bool negative = false;
  std::string_view number = text;
  if (!number.empty() && (number.front() == '+' || number.front() == '-')) {
    negative = number.front() == '-';
    number.remove_prefix(1);
  }
  // YAML spells them .nan and .inf.
  if (number.size() > 1 && number.front() == '.' && !(number[1] >= '0' && number[1] <= '9')) {
    number.remove_prefix(1);
  }
  if (number.empty() || number.front() == '-' || number.front() == '+') {
    return std::nullopt;
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error == std::errc::result_out_of_range) {
    value = std::numeric_limits<double>::infinity();
  } else if (error != std::errc{}) {
    return std::nullopt;
  }
  const std::string_view unit = trim(number.substr(static_cast<std::size_t>(end - number.data())));
  if (!std::isfinite(value) && !unit.empty() && unit.front() >= 'a' && unit.front() <= 'z' &&
      !is_space(*end)) {
    return std::nullopt;  // "infinite", "nano": words, not numbers
  }
  return Quantity{negative ? -value : value, unit};
}

const Unit* find_unit(std::string_view symbol, Dimension dimension) {
  for (const Unit& unit : detail::kUnits) {
    if (unit.dimension == dimension && unit.symbol == symbol) {
      return &unit;
    }
  }
  return nullptr;
}

std::string allowed_units(Dimension dimension) {
  std::string text;
  for (const Unit& unit : detail::kUnits) {
    if (unit.dimension == dimension && !unit.symbol.empty()) {
      text += (text.empty() ? "" : ", ") +
              std::string(unit.symbol == "1" ? "a bare number" : unit.symbol);
    }
  }
  return text.empty() ? "a bare number" : text;
}

std::string shortest(double value) {
  if (!std::isfinite(value)) {
    return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
  }
  const std::string scientific = digits(value, std::chars_format::scientific);
  const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
  return exponent >= -4 && exponent < 16 ? digits(value, std::chars_format::fixed) : scientific;
}

}  // namespace rigwire::fields
