#include "protocols/ubx/precise_position.h"

#include <cmath>

namespace rigwire::protocols::ubx {

SplitAngle split_angle(double angle_deg) {
  const long long e9deg = std::llround(angle_deg * 1e9);
  return {static_cast<std::int32_t>(e9deg / 100), static_cast<std::int8_t>(e9deg % 100)};
}

SplitHeight split_height(double height_m) {
  const long long e4m = std::llround(height_m * 1e4);
  return {static_cast<std::int32_t>(e4m / 10), static_cast<std::int8_t>(e4m % 10)};
}

SplitCoordinate split_coordinate(double coordinate_m) {
  const long long e4m = std::llround(coordinate_m * 1e4);
  return {static_cast<std::int32_t>(e4m / 100), static_cast<std::int8_t>(e4m % 100)};
}

double join(const SplitAngle& angle) {
  return static_cast<double>(angle.e7deg * 100LL + angle.rest_e9deg) / 1e9;
}

double join(const SplitHeight& height) {
  return static_cast<double>(height.mm * 10LL + height.rest_e4m) / 1e4;
}

double join(const SplitCoordinate& coordinate) {
  return static_cast<double>(coordinate.cm * 100LL + coordinate.rest_e4m) / 1e4;
}

}  // namespace rigwire::protocols::ubx
