#include "sim/contact/round_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

constexpr int kCircles = 3;
constexpr int kSteps = 16;           // Along the scanned part of a circle.
constexpr double kReach_rad = 1.75;  // To either side of the lowest point: includes walls.
constexpr double kStep_rad = 2.0 * kReach_rad / kSteps;
constexpr double kGolden = std::numbers::phi - 1.0;
constexpr int kEvenRounds = 8;  // To a hundredth of a radian,
constexpr int kEdgeRounds =
    24;  // and at an edge, where the gap has a kink, to a hundred thousandth.
constexpr double kEven = 0.998;  // Cosine between normals of one face.

struct Circle {
  const Ground* ground;
  Vector middle_W;
  Vector down_W;  ///< Down in the circle's plane, as long as the radius.
  Vector ahead_W;

  [[nodiscard]] Vector at(double angle_rad) const {
    return middle_W + std::cos(angle_rad) * down_W + std::sin(angle_rad) * ahead_W;
  }
  [[nodiscard]] SidePlace place(double angle_rad) const {
    SidePlace place;
    place.p_W = at(angle_rad);
    place.under = ground->terrain_at(place.p_W.x(), place.p_W.y());
    place.normal_W = place.under.normal_W;
    place.gap_m = (place.p_W.z() - place.under.height_m) * place.normal_W.z();
    return place;
  }
  [[nodiscard]] SidePlace nearest(double low_rad, double high_rad) const;
};

// Golden section; of two halves of an edge the one that is deeper keeps the point.
SidePlace Circle::nearest(double low_rad, double high_rad) const {
  double left = high_rad - kGolden * (high_rad - low_rad);
  double right = low_rad + kGolden * (high_rad - low_rad);
  SidePlace at_left = place(left);
  SidePlace at_right = place(right);
  int rounds = kEvenRounds;
  for (int i = 0; i < rounds; ++i) {
    if (at_left.gap_m < at_right.gap_m) {
      high_rad = right;
      right = left;
      at_right = at_left;
      left = high_rad - kGolden * (high_rad - low_rad);
      at_left = place(left);
    } else {
      low_rad = left;
      left = right;
      at_left = at_right;
      right = low_rad + kGolden * (high_rad - low_rad);
      at_right = place(right);
    }
    if (i + 1 == kEvenRounds && place(low_rad).normal_W.dot(place(high_rad).normal_W) < kEven) {
      rounds = kEdgeRounds;
    }
  }
  SidePlace found = at_left.gap_m < at_right.gap_m ? at_left : at_right;
  if (rounds == kEdgeRounds) {
    const Vector before = place(low_rad).normal_W;
    const Vector after = place(high_rad).normal_W;
    const double angle = at_left.gap_m < at_right.gap_m ? left : right;
    const Vector along = std::cos(angle) * ahead_W - std::sin(angle) * down_W;
    const double falls = before.dot(along);
    const double rises = after.dot(along);
    if (falls != rises) {
      const double share = std::clamp(falls / (falls - rises), 0.0, 1.0);
      found.normal_W = ((1.0 - share) * before + share * after).normalized();
      found.gap_m = (found.p_W.z() - found.under.height_m) * found.normal_W.z();
    }
  }
  return found;
}

}  // namespace

void nearest_on_side(const Ground& ground, const ConvexShape& cylinder,
                     const Eigen::Isometry3d& X_WS, double reach_m,
                     std::vector<SidePlace>& places) {
  places.clear();
  const double radius = cylinder.half_lengths_m().x();
  const double half_length = cylinder.half_lengths_m().z();
  const Vector axis = X_WS.linear().col(2);
  // Upright on an end, any direction is as low as another.
  Vector down = axis.z() * axis - Vector::UnitZ();
  down = down.squaredNorm() > 1e-12 ? down.normalized() : Vector(X_WS.linear().col(0));
  Circle circle{&ground, {}, radius * down, radius * axis.cross(down)};
  // Over an edge, the gap at the next sample may exceed the minimum by the whole distance between.
  const double slack = radius * kStep_rad;
  std::array<double, kSteps + 1> gap{};
  for (int k = 0; k < kCircles; ++k) {
    const double y = half_length * (2.0 * k / (kCircles - 1) - 1.0);
    circle.middle_W = X_WS.translation() + y * axis;
    const auto angle = [](int i) { return kStep_rad * i - kReach_rad; };
    for (int i = 0; i <= kSteps; ++i) {
      gap[static_cast<std::size_t>(i)] = circle.place(angle(i)).gap_m;
    }
    for (std::size_t i = 1; i < kSteps; ++i) {
      if (gap[i] < gap[i - 1] && gap[i] <= gap[i + 1] && gap[i] < reach_m + slack) {
        const SidePlace found =
            circle.nearest(angle(static_cast<int>(i) - 1), angle(static_cast<int>(i) + 1));
        if (found.gap_m < reach_m && places.size() < kMostSidePlaces) {
          places.push_back(found);
        }
      }
    }
  }
}

}  // namespace rigwire::sim
