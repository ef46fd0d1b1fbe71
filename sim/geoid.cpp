#include "sim/geoid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace rigwire::sim {
namespace {

/// Tolerance of angles that grids give in decimal or binary fractions of a degree.
constexpr double kAngleTolerance_deg = 1e-9;
constexpr double kGreatestHeight_m = 200.0;
constexpr std::size_t kMostLines = 65536;

[[noreturn]] void refuse(const std::string& quantity, double value, const std::string& allowed) {
  throw std::invalid_argument("geoid grid: " + quantity + " is " + std::to_string(value) +
                              ", allowed are " + allowed);
}

void check(const std::string& quantity, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    refuse(quantity, value, std::to_string(lower) + " .. " + std::to_string(upper));
  }
}

/// Cubic through four values at -1, 0, 1, 2.
double keys(double before, double at_0, double at_1, double after, double t) {
  // Keys 1981 with a = -1/2: slopes by central differences.
  const double slope_0 = 0.5 * (at_1 - before);
  const double slope_1 = 0.5 * (after - at_0);
  const double rise = at_1 - at_0;
  return at_0 + t * (slope_0 + t * (3.0 * rise - 2.0 * slope_0 - slope_1 +
                                    t * (slope_0 + slope_1 - 2.0 * rise)));
}

}  // namespace

void validate(const GeoidGridLayout& layout) {
  check("rows", static_cast<double>(layout.rows), 2.0, static_cast<double>(kMostLines));
  check("columns", static_cast<double>(layout.columns), 2.0, static_cast<double>(kMostLines));
  for (const auto& [name, step] : {std::pair{"latitude step, deg", layout.latitude_step_deg},
                                   std::pair{"longitude step, deg", layout.longitude_step_deg}}) {
    if (!(step > 0.0 && step <= 90.0)) {
      refuse(name, step, "above 0 .. 90");
    }
  }
  check("southern edge, deg", layout.south_deg, -90.0, 90.0);
  check("western edge, deg", layout.west_deg, -180.0, 360.0);
  const auto last = [](std::size_t lines) { return static_cast<double>(lines - 1); };
  check("northern edge, deg", layout.south_deg + last(layout.rows) * layout.latitude_step_deg,
        -90.0, 90.0 + kAngleTolerance_deg);
  check("width, deg", last(layout.columns) * layout.longitude_step_deg, 0.0,
        360.0 + kAngleTolerance_deg);
}

GeoidGrid::GeoidGrid(const GeoidGridLayout& layout, std::vector<float> heights_m,
                     GeoidInterpolation interpolation)
    : layout_(layout), heights_m_(std::move(heights_m)), interpolation_(interpolation) {
  validate(layout_);
  if (heights_m_.size() != layout_.rows * layout_.columns) {
    throw std::invalid_argument("geoid grid: " + std::to_string(heights_m_.size()) +
                                " heights, needed are " + std::to_string(layout_.rows) +
                                " rows of " + std::to_string(layout_.columns));
  }
  for (std::size_t i = 0; i < heights_m_.size(); ++i) {
    if (!(std::abs(heights_m_[i]) <= kGreatestHeight_m)) {
      refuse("height in row " + std::to_string(i / layout_.columns) + ", column " +
                 std::to_string(i % layout_.columns) + ", m",
             static_cast<double>(heights_m_[i]), "-200 .. 200");
    }
  }
  const double width_deg = static_cast<double>(layout_.columns) * layout_.longitude_step_deg;
  const double north_deg =
      layout_.south_deg + static_cast<double>(layout_.rows - 1) * layout_.latitude_step_deg;
  full_turn_ = std::abs(width_deg - 360.0) < kAngleTolerance_deg;
  const bool across = full_turn_ && layout_.columns % 2 == 0;
  south_pole_ = across && std::abs(layout_.south_deg + 90.0) < kAngleTolerance_deg;
  north_pole_ = across && std::abs(north_deg - 90.0) < kAngleTolerance_deg;
}

GeoidGrid::Place GeoidGrid::place(double latitude_deg, double longitude_deg) const {
  const auto columns = static_cast<double>(layout_.columns);
  double east_deg = longitude_deg - layout_.west_deg;
  east_deg -= 360.0 * std::floor(east_deg / 360.0);
  double column = east_deg / layout_.longitude_step_deg;
  if (full_turn_) {
    column = column >= columns ? column - columns : column;
  } else if (column > columns - 1.0) {
    // Beyond the eastern edge: whichever edge is nearer.
    const double turn = 360.0 / layout_.longitude_step_deg;
    column = column - (columns - 1.0) <= turn - column ? columns - 1.0 : 0.0;
  }
  const double row = (latitude_deg - layout_.south_deg) / layout_.latitude_step_deg;
  return {std::clamp(row, 0.0, static_cast<double>(layout_.rows - 1)), column};
}

bool GeoidGrid::covers(double latitude_deg, double longitude_deg) const {
  const double row = (latitude_deg - layout_.south_deg) / layout_.latitude_step_deg;
  double east_deg = longitude_deg - layout_.west_deg;
  east_deg -= 360.0 * std::floor(east_deg / 360.0);
  const double width_deg = static_cast<double>(layout_.columns - 1) * layout_.longitude_step_deg;
  return row >= 0.0 && row <= static_cast<double>(layout_.rows - 1) &&
         (full_turn_ || east_deg <= width_deg + kAngleTolerance_deg);
}

double GeoidGrid::height_m(std::ptrdiff_t row, std::ptrdiff_t column) const {
  const auto rows = static_cast<std::ptrdiff_t>(layout_.rows);
  const auto columns = static_cast<std::ptrdiff_t>(layout_.columns);
  // Across a pole along the opposite meridian.
  if (row < 0 && south_pole_) {
    row = -row;
    column += columns / 2;
  } else if (row >= rows && north_pole_) {
    row = 2 * (rows - 1) - row;
    column += columns / 2;
  }
  row = std::clamp<std::ptrdiff_t>(row, 0, rows - 1);
  if (full_turn_) {
    column = ((column % columns) + columns) % columns;
  } else {
    column = std::clamp<std::ptrdiff_t>(column, 0, columns - 1);
  }
  return static_cast<double>(heights_m_[static_cast<std::size_t>(row * columns + column)]);
}

double GeoidGrid::linear(std::ptrdiff_t row, double column) const {
  const double west = std::floor(column);
  const auto first = static_cast<std::ptrdiff_t>(west);
  return std::lerp(height_m(row, first), height_m(row, first + 1), column - west);
}

double GeoidGrid::cubic(std::ptrdiff_t row, double column) const {
  const double west = std::floor(column);
  const auto first = static_cast<std::ptrdiff_t>(west);
  return keys(height_m(row, first - 1), height_m(row, first), height_m(row, first + 1),
              height_m(row, first + 2), column - west);
}

double GeoidGrid::separation_m(double latitude_deg, double longitude_deg) const {
  if (!std::isfinite(latitude_deg) || !std::isfinite(longitude_deg)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const Place at = place(latitude_deg, longitude_deg);
  const double south = std::floor(at.row);
  const auto first = static_cast<std::ptrdiff_t>(south);
  const double t = at.row - south;
  if (interpolation_ == GeoidInterpolation::bilinear) {
    return std::lerp(linear(first, at.column), linear(first + 1, at.column), t);
  }
  return keys(cubic(first - 1, at.column), cubic(first, at.column), cubic(first + 1, at.column),
              cubic(first + 2, at.column), t);
}

}  // namespace rigwire::sim
