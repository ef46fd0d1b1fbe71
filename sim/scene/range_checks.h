// Refusals of what several members of a scene's part make together, in the form of fields::check().
#pragma once

#include <string>

#include "fields/check.h"
#include "fields/units.h"

namespace rigwire::sim {

/// Throws fields::Refused "key: what, found value unit, allowed lower .. upper unit" for a value
/// outside of them, or that is no number.
inline void require_within(double value, double lower, double upper, const std::string& unit,
                           const std::string& key, const std::string& what = {}) {
  if (!(value >= lower && value <= upper)) {
    const std::string space = unit.empty() ? "" : " ";
    throw fields::Refused(key, (what.empty() ? "" : what + ", ") + "found " +
                                   fields::shortest(value) + space + unit + ", allowed " +
                                   fields::shortest(lower) + " .. " + fields::shortest(upper) +
                                   space + unit);
  }
}

/// Throws as require_within() unless a terrain has 10 to 8192 cells along a side.
inline void require_grid(double size_m, double cell_m) {
  require_within(size_m / cell_m, 10.0, 8192.0, "", "cell", "cells along a side");
}

}  // namespace rigwire::sim
