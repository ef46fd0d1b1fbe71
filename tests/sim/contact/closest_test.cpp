#include "sim/contact/closest.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "allocation_counter.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;
using Pose = Eigen::Isometry3d;

Pose at(const Vector& place, const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  Pose X = Pose::Identity();
  X.translation() = place;
  X.linear() = turn.normalized().toRotationMatrix();
  return X;
}

Eigen::Quaterniond any_turn(RandomStream& random) {
  return Eigen::Quaterniond(random.gaussian(), random.gaussian(), random.gaussian(),
                            random.gaussian())
      .normalized();
}

double angle_deg(const Vector& a, const Vector& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

/// A shape against another whose gap and normal (from b to a) are known in b's frame.
struct Known {
  const char* name;
  ConvexShape a;
  ConvexShape b;
  Eigen::Quaterniond turn;  ///< Turn of a in b's frame.
  Vector normal;            ///< From b to a.
  Vector place_at_touch;    ///< Place of a in b's frame.
};

Eigen::Quaterniond about(const Vector& axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis));
}

std::vector<Known> closed_forms() {
  const Vector x = Vector::UnitX();
  const Vector z = Vector::UnitZ();
  const ConvexShape trunk = ConvexShape::cylinder(0.2, 5.0);
  const ConvexShape box = ConvexShape::box({1.1, 0.9, 0.4});
  const ConvexShape wheel = ConvexShape::cylinder(0.53, 0.25);
  const ConvexShape floor = ConvexShape::box({20.0, 20.0, 1.0});
  const std::vector<Vector> corners{{-0.5, -0.4, -0.3}, {0.5, -0.4, -0.3}, {-0.5, 0.4, -0.3},
                                    {0.5, 0.4, -0.3},   {-0.3, -0.2, 0.5}, {0.3, -0.2, 0.5},
                                    {-0.3, 0.2, 0.5},   {0.3, 0.2, 0.5}};
  const ConvexShape hull = ConvexShape::hull(corners);
  const double s = std::sqrt(0.5);
  // Wheel: axis y; its lowest point below a tilt of 20 degrees about x.
  const Eigen::Quaterniond upright = about(x, 90.0);
  const Eigen::Quaterniond tilted = about(x, 70.0);
  const double tilt = 20.0 * kDegree;
  return {
      {"sphere on a plane", ConvexShape::sphere(0.7), floor, about(x, 33.0), z, {1.0, 2.0, 1.7}},
      {"face on a plane", box, floor, about(z, 17.0), z, {1.0, -2.0, 1.4}},
      {"face at a trunk", box, trunk, about(x, 0.0), x, {1.3, 0.3, 0.6}},
      {"edge at a trunk", box, trunk, about(z, 45.0), x, {0.2 + s * (1.1 + 0.9), s * 0.2, 0.4}},
      {"wheel at a trunk", wheel, trunk, upright, x, {0.73, 0.1, 0.3}},
      {"parallel cylinders",
       ConvexShape::cylinder(0.3, 0.6),
       trunk,
       about(z, 5.0),
       x,
       {0.5, 0.0, 0.2}},
      {"tilted wheel on a plane",
       wheel,
       floor,
       tilted,
       z,
       {0.0, 0.0, 1.0 + 0.53 * std::cos(tilt) + 0.25 * std::sin(tilt)}},
      {"hull on a plane", hull, floor, about(z, 31.0), z, {0.2, 0.1, 1.3}},
      {"rock at a trunk", ConvexShape::sphere(0.7), trunk, about(z, 0.0), x, {0.9, 0.0, 1.0}},
  };
}

TEST(Closest, MeetsClosedFormsAnywhereInTheWorld) {
  RandomStream random(1, "closest");
  for (const Known& known : closed_forms()) {
    double worst_m = 0.0;
    double worst_deg = 0.0;
    for (int i = 0; i < 120; ++i) {
      const double far = i < 60 ? 10.0 : 1e6;
      const Pose X_WB = at(far * Vector(random.gaussian(), random.gaussian(), random.gaussian()),
                           any_turn(random));
      const double gap = i % 4 == 0   ? 0.0
                         : i % 4 == 1 ? 0.02
                         : i % 4 == 2 ? -1e-4
                                      : -0.1 * std::abs(std::sin(0.1 * i));
      const PlacedShape b{&known.b, X_WB};
      const PlacedShape a{&known.a,
                          X_WB * at(known.place_at_touch + gap * known.normal, known.turn)};
      const auto found = closest(a, b, 0.1);
      ASSERT_TRUE(found) << known.name << " " << gap;
      worst_m = std::max(worst_m, std::abs(found->gap_m - gap));
      worst_deg = std::max(worst_deg, angle_deg(found->normal_W, X_WB.linear() * known.normal));
    }
    EXPECT_LT(worst_m, 5e-6) << known.name;
    EXPECT_LT(worst_deg, 0.1) << known.name;
  }
}

std::vector<ConvexShape> odd_shapes(RandomStream& random) {
  std::vector<ConvexShape> shapes{ConvexShape::box({0.5, 0.4, 0.02}),
                                  ConvexShape::box({2.0, 0.05, 0.05}),
                                  ConvexShape::box({0.5, 0.5, 0.5}),
                                  ConvexShape::cylinder(0.53, 0.25),
                                  ConvexShape::cylinder(0.1, 5.0),
                                  ConvexShape::cylinder(0.4, 0.05),
                                  ConvexShape::sphere(0.7)};
  for (int i = 0; i < 2; ++i) {
    std::vector<Vector> points;
    for (int k = 0; k < 20; ++k) {
      points.push_back(
          0.5 * Vector(random.gaussian(), random.gaussian(), random.gaussian()).normalized());
    }
    shapes.push_back(ConvexShape::hull(points));
  }
  return shapes;
}

/// A turn of one of three kinds: any, along the axes, along them but for 1e-6.
Eigen::Quaterniond odd_turn(RandomStream& random, int kind) {
  if (kind == 0) {
    return any_turn(random);
  }
  const double quarter = std::floor(4.0 * random.uniform()) * 90.0;
  const Eigen::Quaterniond turn =
      about(Vector::Unit(static_cast<Eigen::Index>(3.0 * random.uniform())), quarter);
  return kind == 1 ? turn : turn * about(Vector(1.0, -2.0, 0.5).normalized(), 1e-6 / kDegree);
}

TEST(Closest, NeverNamesADirectionThatPartsTheBodiesLessThanAnotherDoes) {
  RandomStream random(2, "odd pairs");
  const std::vector<ConvexShape> shapes = odd_shapes(random);
  int worse = 0;
  int checked = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto pick = [&] {
      return static_cast<std::size_t>(random.uniform() * static_cast<double>(shapes.size()));
    };
    PlacedShape b{&shapes[pick()], at(Vector::Zero(), odd_turn(random, i % 3))};
    PlacedShape a{&shapes[pick()], at(Vector::Zero(), odd_turn(random, i % 3))};
    // Along a direction until the gap along it is the one wanted.
    const Vector way =
        i % 3 == 0 ? Vector(random.gaussian(), random.gaussian(), random.gaussian()).normalized()
                   : Vector(Vector::Unit(i % 2 == 0 ? 0 : 2));
    const double wanted[] = {0.05, 1e-4, 0.0, -1e-4, -1e-2};
    a.X_WS.translation() = way * (wanted[i % 5] - gap_along(a, b, way));
    const auto found = closest(a, b, 0.1);
    if (!found) {
      continue;  // The shortest way is another, and longer.
    }
    ++checked;
    ASSERT_NEAR(found->normal_W.norm(), 1.0, 1e-12);
    ASSERT_NEAR(found->gap_m, gap_along(a, b, found->normal_W), 1e-12);
    double best = -1e300;
    for (int k = 0; k < 60; ++k) {
      const Vector other =
          k == 0 ? way
                 : (found->normal_W +
                    0.02 * k * Vector(random.gaussian(), random.gaussian(), random.gaussian()))
                       .normalized();
      best = std::max(best, gap_along(a, b, other));
    }
    worse += best > found->gap_m + 1e-3 ? 1 : 0;
    EXPECT_LT(best, found->gap_m + 3e-3) << i;
  }
  EXPECT_GT(checked, 2000);
  EXPECT_LE(worse, 1);
}

TEST(Closest, DepthAndNormalDoNotJumpWhileAHullTurnsPastATrunk) {
  RandomStream random(3, "turning");
  std::vector<Vector> points;
  for (int k = 0; k < 24; ++k) {
    points.push_back(0.6 *
                     Vector(random.gaussian(), random.gaussian(), random.gaussian()).normalized());
  }
  const ConvexShape hull = ConvexShape::hull(points);
  const ConvexShape trunk = ConvexShape::cylinder(0.2, 5.0);
  const PlacedShape b{&trunk, Pose::Identity()};
  std::vector<Vector> kept;
  std::optional<Separation> before;
  double jump_m = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double turn = 1e-3 * i / kDegree;
    const PlacedShape a{&hull, at({0.72, 1e-5 * i, 0.3}, about(Vector::UnitZ(), turn))};
    const auto found = closest(a, b, 0.1, kept);
    if (found && before) {
      // 1 mrad of 0.6 m and 10 um a step move no point by more than 0.7 mm.
      jump_m = std::max(jump_m, std::abs(found->gap_m - before->gap_m));
    }
    before = found;
    kept.clear();
    if (found) {
      kept.push_back(found->normal_W);
    }
  }
  EXPECT_LT(jump_m, 0.7e-3);
}

TEST(Closest, AThinPostIsNotPushedOutAtItsFarSide) {
  const ConvexShape post = ConvexShape::cylinder(0.1, 1.5);
  const ConvexShape front = ConvexShape::box({0.3, 1.0, 0.3});
  const PlacedShape b{&post, Pose::Identity()};
  std::vector<Vector> kept;
  for (double x = -0.45; x < 0.1; x += 0.005) {
    const PlacedShape a{&front, at({x, 0.0, 0.5})};
    const auto found = closest(a, b, 0.1, kept);
    ASSERT_TRUE(found);
    EXPECT_LT(found->normal_W.x(), -0.999) << x;
    EXPECT_NEAR(found->gap_m, -x - 0.4, 1e-9) << x;
    kept.assign(1, found->normal_W);
  }
}

TEST(Closest, AllocatesNothing) {
  const ConvexShape wheel = ConvexShape::cylinder(0.53, 0.25);
  const ConvexShape trunk = ConvexShape::cylinder(0.2, 5.0);
  const PlacedShape b{&trunk, Pose::Identity()};
  double sum = 0.0;
  const std::uint64_t before = rigwire::test::allocations();
  for (int i = 0; i < 100; ++i) {
    const PlacedShape a{&wheel, at({0.74 - 1e-3 * i, 0.0, 0.3}, about(Vector::UnitX(), 80.0))};
    const auto found = closest(a, b, 0.1);
    sum += found ? found->gap_m : 1.0;
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_NE(sum, 0.0);
}

}  // namespace
}  // namespace rigwire::sim
