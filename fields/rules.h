// What may be said of a member beside its unit: ranges of whole numbers and of spans of time, and
// names. Numbers with a unit have their rule in units.h.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include "fields/units.h"

namespace rigwire::fields {

/// What a visit function is given (fields/visitor.h); headers of structures need no more of it.
class Visitor;

/// Range of a whole number, both ends allowed. With a unit the file may write every unit of the
/// dimension that makes it whole: IntegerRule{0, 65535, unit("ms")} reads 10, "10 ms", "0.01 s".
struct IntegerRule {
  std::int64_t lower = std::numeric_limits<std::int64_t>::min();
  std::int64_t upper = std::numeric_limits<std::int64_t>::max();
  const Unit* unit = nullptr;  ///< Unit of a bare number and of the member; null: none.

  [[nodiscard]] bool contains(std::int64_t value) const { return value >= lower && value <= upper; }
  [[nodiscard]] std::string range_text() const;
};

/// Range of a span of time, both ends allowed.
struct DurationRule {
  std::int64_t lower_ns = 0;
  std::int64_t upper_ns = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] bool contains(std::int64_t nanoseconds) const {
    return nanoseconds >= lower_ns && nanoseconds <= upper_ns;
  }
  [[nodiscard]] std::string range_text() const;
};

/// A year, more than any run lasts: the upper end of instants counted from the start of a run.
inline constexpr std::int64_t kYear_ns = 31'536'000'000'000'000;

/// A name that a file may write, and what it means. An alternative of a std::variant carries its
/// own as `static constexpr fields::Named kNamed`.
struct Named {
  std::string_view name;
  std::string_view text;
};

/// One name of an enumeration.
template <class Enumeration>
struct Choice {
  Enumeration value;
  std::string_view name;
  std::string_view text;  ///< What choosing it means.
};

/// "1.5 s", "20 ms": the largest unit that keeps the number short and reads back exactly.
[[nodiscard]] std::string print_duration(std::int64_t nanoseconds);

}  // namespace rigwire::fields
