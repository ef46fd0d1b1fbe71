#include "sim/lidar/beam_sampler.h"

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/constants.h"

namespace rigwire::sim {
namespace {

// All in half angles; found by minimising the error that beam_sampler.h states.
constexpr double kCrossRadius = 0.7;
constexpr double kCrossMiddle = 0.25;
constexpr double kGridSpacing = 0.45;
constexpr double kGridDecay = 1.2;
constexpr double kGridTurn = kTurn / 24.0;
constexpr int kGridRings = 2;
constexpr int kHaloRays = 6;

SubRay at(double radius, double angle_rad, double weight, double spacing) {
  return {radius * std::cos(angle_rad), radius * std::sin(angle_rad), weight, spacing, spacing};
}

std::vector<SubRay> cross() {
  std::vector<SubRay> rays{at(0.0, 0.0, kCrossMiddle, kCrossRadius)};
  // Turned by atan(1/2), so that no two of the five share a row or a column.
  for (int i = 0; i < 4; ++i) {
    rays.push_back(
        at(kCrossRadius, std::atan(0.5) + kTurn * i / 4, (1.0 - kCrossMiddle) / 4.0, kCrossRadius));
  }
  return rays;
}

std::vector<SubRay> grid() {
  std::vector<SubRay> rays{at(0.0, 0.0, 1.0, kGridSpacing)};
  double sum = 1.0;
  for (int column = -kGridRings; column <= kGridRings; ++column) {
    for (int row = -kGridRings; row <= kGridRings; ++row) {
      if ((column == 0 && row == 0) || std::abs(column + row) > kGridRings) {
        continue;
      }
      // Hexagonal grid in axial coordinates, weight by a Gaussian of its radius.
      const double x = kGridSpacing * (column + 0.5 * row);
      const double y = kGridSpacing * std::sqrt(0.75) * row;
      const double weight = std::exp(-kGridDecay * (x * x + y * y));
      rays.push_back(at(std::hypot(x, y), std::atan2(y, x) + kGridTurn, weight, kGridSpacing));
      sum += weight;
    }
  }
  for (SubRay& ray : rays) {
    ray.weight /= sum;
  }
  return rays;
}

std::vector<SubRay> spiral(int count) {
  const double golden_angle = std::numbers::pi * (3.0 - std::sqrt(5.0));
  const double weight = 1.0 / count;
  std::vector<SubRay> rays;
  for (int i = 0; i < count; ++i) {
    const double outside = 1.0 - (i + 0.5) / count;  // share of the pulse farther out
    // exp(-2 r^2) of a Gaussian pulse lies beyond r; its density there is 2 / pi exp(-2 r^2).
    const double radius = i == 0 ? 0.0 : std::sqrt(-0.5 * std::log(outside));
    const double share_per_area = 2.0 / std::numbers::pi * outside;
    rays.push_back(at(radius, golden_angle * i, weight, std::sqrt(weight / share_per_area)));
  }
  return rays;
}

}  // namespace

std::vector<SubRay> sample_beam(const LaserBeam& beam, int count) {
  for (const double divergence : {beam.horizontal_divergence_rad, beam.vertical_divergence_rad}) {
    if (!(divergence >= 0.0 && divergence < 0.5)) {
      throw std::invalid_argument("lidar beam: the divergence is " + std::to_string(divergence) +
                                  " rad, allowed: 0 to 0.5");
    }
  }
  std::vector<SubRay> rays;
  switch (count) {
    case 1:
      rays = {SubRay{}};
      break;
    case 5:
      rays = cross();
      break;
    case 19:
      rays = grid();
      break;
    case 1000:
      rays = spiral(count);
      break;
    default:
      throw std::invalid_argument("lidar beam: " + std::to_string(count) +
                                  " sub-rays, allowed: 1, 5, 19 or 1000");
  }
  for (SubRay& ray : rays) {
    // From half angles of 1 to those of the beam.
    ray.right_rad *= 0.5 * beam.horizontal_divergence_rad;
    ray.spacing_right_rad *= 0.5 * beam.horizontal_divergence_rad;
    ray.up_rad *= 0.5 * beam.vertical_divergence_rad;
    ray.spacing_up_rad *= 0.5 * beam.vertical_divergence_rad;
  }
  return rays;
}

std::vector<SubRay> sample_halo(double angle_rad, double share) {
  std::vector<SubRay> rays;
  rays.reserve(kHaloRays);
  for (int i = 0; i < kHaloRays; ++i) {
    rays.push_back(at(angle_rad, kTurn * i / kHaloRays, share / kHaloRays, 0.0));
  }
  return rays;
}

}  // namespace rigwire::sim
