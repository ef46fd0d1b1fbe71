// What a visit function may say about a field, shared by every visitor.
//
// Each plain configuration struct has one free function template
//
//   template <class Visitor>
//   void visit(Visitor& v, CylinderParameters& p) {
//     v.number("stroke", p.stroke_m, in("mm").above(0), "Full travel of the rod.");
//     v.section("port_a", p.port_a, "Bottom side.");
//   }
//
// which serves reading (reader.h), and printing, hashing and describing (outline.h). The member's
// value at construction is the field's default. A struct that can `validate()` itself (member or
// free function, throwing std::invalid_argument) is asked to after it was read without findings.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "hil/configuration/problems.h"

namespace rigwire::hil {

/// Range of a whole number, both ends allowed.
struct IntegerRule {
  std::int64_t lower = std::numeric_limits<std::int64_t>::min();
  std::int64_t upper = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] std::string range_text() const;
};

/// Range of a span of time, both ends allowed.
struct DurationRule {
  std::int64_t lower_ns = 0;
  std::int64_t upper_ns = std::numeric_limits<std::int64_t>::max();

  [[nodiscard]] std::string range_text() const;
};

/// One name of an enumeration.
template <class Enumeration>
struct Choice {
  Enumeration value;
  std::string_view name;
  std::string_view text;  ///< What choosing it means.
};

/// One alternative of a std::variant, in the order of its template arguments.
struct Alternative {
  std::string_view name;
  std::string_view text;
};

/// Where each value that somebody wrote stands, by key path.
class Origins {
 public:
  void set(const std::string& path, const Location& where) { places_[path] = where; }
  /// The place of that very key; a default location when nobody wrote it.
  [[nodiscard]] Location of(const std::string& path) const;
  /// The place of the key, or of the nearest key above it that somebody wrote.
  [[nodiscard]] Location nearest(std::string path) const;

 private:
  std::map<std::string, Location> places_;
};

/// "1.5 s", "20 ms": the largest unit that keeps the number short and reads back exactly.
[[nodiscard]] std::string print_duration(std::int64_t nanoseconds);

}  // namespace rigwire::hil
