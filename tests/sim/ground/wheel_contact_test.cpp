#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/ground/disc_cut.h"
#include "sim/ground/ground.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;
constexpr double kRadius_m = 0.59;

HeightField field_of(Eigen::Vector2d origin, std::size_t nodes, double cell) {
  HeightField field;
  field.origin_m = origin;
  field.cell_m = cell;
  field.columns = field.rows = nodes;
  field.heights_m.assign(nodes * nodes, 0.0);
  return field;
}

HeightField slope(Eigen::Vector2d middle, double east, double north) {
  HeightField field = field_of(middle - Eigen::Vector2d(10.0, 10.0), 9, 2.5);
  for (std::size_t i = 0; i < 81; ++i) {
    field.heights_m[i] = east * (2.5 * static_cast<double>(i % 9) - 10.0) +
                         north * (2.5 * static_cast<double>(i / 9) - 10.0);
  }
  return field;
}

HeightField wheel_contact_rough(Eigen::Vector2d origin) {
  HeightField field = field_of(origin, 41, 0.5);
  RandomStream random(3, "rough");
  for (double& height : field.heights_m) {
    height = 0.1 * random.gaussian();
  }
  return field;
}

class PlaneContact : public testing::TestWithParam<double> {};

TEST_P(PlaneContact, IsExactForEverySlopeAndTilt) {
  const Eigen::Vector2d middle(GetParam(), -GetParam());
  RandomStream random(4, "planes");
  int checked = 0;
  for (int i = 0; i < 3000; ++i) {
    const double east = 0.4 * random.gaussian();
    const double north = 0.4 * random.gaussian();
    const Vector n = Vector(-east, -north, 1.0).normalized();
    const Vector axis =
        Vector(random.gaussian(), random.gaussian(), 0.3 * random.gaussian()).normalized();
    const double sine = std::sqrt(1.0 - n.dot(axis) * n.dot(axis));
    if (sine < 0.6 || std::abs(east) > 0.9 || std::abs(north) > 0.9) {
      continue;  // wheels on their side
    }
    ++checked;
    const double depth = 0.3 * std::abs(std::sin(0.1 * i)) * kRadius_m * sine + 1e-6;
    // Centre above the plane by R sin - depth, somewhere.
    Vector centre(0.7 * std::cos(i), 0.7 * std::sin(i), 0.0);
    centre.z() = (kRadius_m * sine - depth - n.x() * centre.x() - n.y() * centre.y()) / n.z();
    const Vector origin(middle.x(), middle.y(), 0.0);
    const Ground ground(slope(middle, east, north), {}, {});
    const auto contact = ground.wheel_contact(centre + origin, axis, kRadius_m);
    ASSERT_TRUE(contact) << i;
    EXPECT_NEAR(contact->depth_m, depth, 1e-9);
    EXPECT_LT((contact->normal_W - n).norm(), 1e-8);
    EXPECT_NEAR(n.dot(contact->point_W - origin), 0.0, 1e-9);
    EXPECT_NEAR(axis.dot(contact->point_W - origin - centre), 0.0, 1e-9);
    const auto endless = Ground::plane(n, {}).wheel_contact(centre, axis, kRadius_m);
    ASSERT_TRUE(endless);
    EXPECT_NEAR(endless->depth_m, depth, 1e-14);
    EXPECT_LT((endless->point_W + origin - contact->point_W).norm(), 1e-8);
  }
  EXPECT_GT(checked, 1500);
}

INSTANTIATE_TEST_SUITE_P(Offsets, PlaneContact, testing::Values(0.0, 1e6), [](const auto& test) {
  return test.param == 0.0 ? "at_the_origin" : "a_million_metres_away";
});

TEST(WheelContact, LosesNoDigitsAMillionMetresAway) {
  const Ground near(wheel_contact_rough({0.0, 0.0}), {}, {});
  const Ground far(wheel_contact_rough({1e6, 1e6}), {}, {});
  for (double x = 2.0; x < 18.0; x += 0.0625) {
    const auto a = near.wheel_contact({x, 10.125, 0.5}, Vector::UnitY(), kRadius_m);
    const auto b = far.wheel_contact({1e6 + x, 1e6 + 10.125, 0.5}, Vector::UnitY(), kRadius_m);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      EXPECT_NEAR(a->depth_m, b->depth_m, 1e-8);
      EXPECT_LT((a->normal_W - b->normal_W).norm(), 1e-7);
    }
  }
}

TEST(WheelContact, IsNothingInTheAir) {
  const Ground ground;
  EXPECT_FALSE(ground.wheel_contact({0.0, 0.0, kRadius_m + 1e-9}, Vector::UnitY(), kRadius_m));
  EXPECT_TRUE(ground.wheel_contact({0.0, 0.0, kRadius_m - 1e-9}, Vector::UnitY(), kRadius_m));
  EXPECT_FALSE(ground.wheel_contact({0.0, 0.0, 0.1}, Vector::UnitZ(), kRadius_m));
}

/// Largest change of the overlap vector over a millimetre of way, at a height that keeps touching.
double greatest_jump(const Ground& ground, double from, double to, double y, double z) {
  Vector before = Vector::Zero();
  double jump = 0.0;
  bool first = true;
  for (double x = from; x < to; x += 0.001) {
    const auto contact = ground.wheel_contact({x, y, z}, Vector::UnitY(), kRadius_m);
    const Vector overlap =
        contact ? Vector(contact->depth_m * contact->normal_W) : Vector(Vector::Zero());
    jump = first ? 0.0 : std::max(jump, (overlap - before).norm());
    before = overlap;
    first = false;
  }
  return jump;
}

TEST(WheelContact, DrivingOverAStepJumpsNowhere) {
  Obstacle step;
  step.X_WO.translation() = Vector(12.0, 10.0, 0.1);
  step.half_lengths_m = Vector(1.0, 1.0, 0.1);
  const Ground ground(field_of({0.0, 0.0}, 41, 0.5), {}, {step});
  EXPECT_LT(greatest_jump(ground, 9.0, 15.0, 10.0, 0.56), 0.0012);
}

TEST(WheelContact, DrivingOverRoughGroundJumpsNowhere) {
  const Ground ground(wheel_contact_rough({0.0, 0.0}), {}, {});
  EXPECT_LT(greatest_jump(ground, 1.0, 19.0, 10.1, 0.52), 0.002);
}

TEST(WheelContact, RollsOntoTheEdgeOfAStep) {
  Obstacle step;
  step.X_WO.translation() = Vector(12.0, 10.0, 0.1);
  step.half_lengths_m = Vector(1.0, 1.0, 0.1);
  const Ground ground(field_of({0.0, 0.0}, 41, 0.5), {}, {step});
  // Centre 0.42 m ahead of the edge, 0.36 m above it.
  const auto contact = ground.wheel_contact({10.58, 10.0, 0.56}, Vector::UnitY(), kRadius_m);
  ASSERT_TRUE(contact);
  // Flat ground 30 mm deep and the edge R - hypot(0.42, 0.36) deep: the shortest way out of both.
  const double edge = kRadius_m - std::hypot(0.42, 0.36);
  const Vector to_centre = Vector(-0.42, 0.0, 0.36).normalized();
  const Vector way = contact->depth_m * contact->normal_W;
  EXPECT_GE(way.z(), 0.03 - 1e-12);
  EXPECT_GE(way.dot(to_centre), edge - 1e-12);
  EXPECT_NEAR(std::min(way.z() - 0.03, way.dot(to_centre) - edge), 0.0, 1e-12);
}

TEST(WheelContact, ATreeIsNotRolledOver) {
  Obstacle trunk;
  trunk.shape = ObstacleShape::cylinder;
  trunk.X_WO.translation() = Vector(10.0, 10.0, 5.0);
  trunk.half_lengths_m = Vector(0.2, 0.2, 5.0);
  const Ground ground(field_of({0.0, 0.0}, 41, 0.5), {}, {trunk});
  // Neither a wall nor a tower to the disc: the wheel's body meets it (sim/contact).
  EXPECT_TRUE(ground.too_high(0, {9.25, 10.0, 0.6}));
  EXPECT_FALSE(ground.wheel_contact({9.25, 10.0, 0.6}, Vector::UnitY(), kRadius_m));
}

TEST(WheelContact, ATiltedBoxIsAsExactAsAPlane) {
  Obstacle ramp;
  ramp.X_WO.linear() =
      (Eigen::AngleAxisd(-0.25, Vector::UnitY()) * Eigen::AngleAxisd(0.15, Vector::UnitX()))
          .toRotationMatrix();
  ramp.X_WO.translation() = Vector(10.0, 10.0, 3.0) - ramp.X_WO.linear() * Vector(0.0, 0.0, 0.5);
  ramp.half_lengths_m = Vector(5.0, 5.0, 0.5);
  const Ground ground(field_of({0.0, 0.0}, 41, 0.5), {}, {ramp});
  const Vector n = ramp.X_WO.linear() * Vector::UnitZ();
  const Vector axis = Vector(0.2, 1.0, 0.1).normalized();
  const double sine = std::sqrt(1.0 - n.dot(axis) * n.dot(axis));
  const Vector centre = Vector(10.0, 10.0, 3.0) + (kRadius_m * sine - 0.05) * n;
  EXPECT_FALSE(ground.too_high(0, centre));  // Though its upper end is above the wheel.
  const auto contact = ground.wheel_contact(centre, axis, kRadius_m);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(contact->depth_m, 0.05, 1e-12);
  EXPECT_LT((contact->normal_W - n).norm(), 1e-10);
}

TEST(WheelContact, BuriedWheelsAreLiftedNotLost) {
  const Ground ground(field_of({0.0, 0.0}, 41, 0.5), {}, {});
  double before = 0.0;
  for (double z = 0.5; z > -5.0; z -= 0.01) {
    const auto contact = ground.wheel_contact({10.0, 10.0, z}, Vector::UnitY(), kRadius_m);
    ASSERT_TRUE(contact);
    EXPECT_GT(contact->depth_m, before);
    EXPECT_NEAR(contact->depth_m, kRadius_m - z, 1e-9);
    before = contact->depth_m;
  }
}

TEST(DiscCut, DepthIsTheInverseOfTheArea) {
  for (double depth = 1e-7; depth < kRadius_m; depth *= 1.7) {
    const double half = std::acos(1.0 - depth / kRadius_m);
    const double area = kRadius_m * kRadius_m * (half - std::sin(half) * std::cos(half));
    EXPECT_NEAR(straight_cut_depth_m(area, kRadius_m), depth, 1e-9 * depth + 1e-12);
  }
  EXPECT_EQ(straight_cut_depth_m(0.0, kRadius_m), 0.0);
  EXPECT_EQ(straight_cut_depth_m(10.0, kRadius_m), kRadius_m);
}

TEST(DiscCut, ForceInProportionToTheDepthIsConservative) {
  // Once round a closed way over a ridge: no work. The profile stands still in the world here.
  const auto cut_at = [](double x, double z) {
    const double xs[kProfilePoints] = {-2.0, -0.3, -0.1, 0.0, 0.15, 0.3, 2.0};
    const double zs[kProfilePoints] = {0.0, 0.0, 0.05, 0.1, 0.02, 0.04, 0.1};
    std::array<Eigen::Vector2d, kProfilePoints> profile;
    for (std::size_t i = 0; i < kProfilePoints; ++i) {
      profile[i] = {xs[i] - x, zs[i] - z};
    }
    const auto cut = cut_disc(profile, kRadius_m);
    return cut ? Eigen::Vector2d(cut->depth_m * cut->normal) : Eigen::Vector2d(0.0, 0.0);
  };
  double work = 0.0;
  double absolute = 0.0;
  const int pieces = 20'000;
  for (int i = 0; i < pieces; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.5) / pieces;
    const double step = 2.0 * std::numbers::pi / pieces;
    const Eigen::Vector2d force = cut_at(0.4 * std::cos(angle), 0.55 + 0.1 * std::sin(angle));
    const double done =
        force.dot(Eigen::Vector2d(-0.4 * std::sin(angle) * step, 0.1 * std::cos(angle) * step));
    work += done;
    absolute += std::abs(done);
  }
  EXPECT_GT(absolute, 0.01);
  EXPECT_NEAR(work, 0.0, 2e-3 * absolute);
}

TEST(ShortestEscape, LeavesEveryOverlapAndNoFurther) {
  const Penetration floor{0.03, Vector::UnitZ(), 0.8};
  const Penetration wall{0.04, -Vector::UnitX(), 0.7};
  const Penetration plate{0.02, Vector::UnitZ(), 0.6};
  const std::array<Penetration, 3> all{floor, wall, plate};
  const Escape corner = shortest_escape(all);
  EXPECT_LT((corner.way_W - Vector(-0.04, 0.0, 0.03)).norm(), 1e-15);
  EXPECT_NEAR(corner.shares[0], 0.03, 1e-15);
  EXPECT_NEAR(corner.shares[1], 0.04, 1e-15);
  EXPECT_EQ(corner.shares[2], 0.0);  // the plate on the floor adds nothing
}

}  // namespace
}  // namespace rigwire::sim
