#include "sim/ground/ground.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

/// Nodes at heights of a function of the place relative to `origin`.
template <class Height>
HeightField terrain(Eigen::Vector2d origin, std::size_t nodes, double cell, Height&& height) {
  HeightField field;
  field.origin_m = origin;
  field.cell_m = cell;
  field.columns = field.rows = nodes;
  for (std::size_t r = 0; r < nodes; ++r) {
    for (std::size_t c = 0; c < nodes; ++c) {
      field.heights_m.push_back(
          height(cell * static_cast<double>(c), cell * static_cast<double>(r)));
    }
  }
  return field;
}

HeightField rough(Eigen::Vector2d origin = Eigen::Vector2d::Zero()) {
  RandomStream random(3, "rough");
  return terrain(origin, 21, 0.5, [&](double, double) { return 0.2 * random.gaussian(); });
}

Obstacle box_at(double x, double y, double z, Vector half) {
  Obstacle box;
  box.X_WO.translation() = Vector(x, y, z);
  box.half_lengths_m = half;
  return box;
}

TEST(GroundHeights, AreThoseThatTheRaysSee) {
  const HeightField field = rough();
  const Ground ground(field, {}, {});
  RandomStream random(1, "places");
  for (int i = 0; i < 2000; ++i) {
    const double x = 5.0 + 6.0 * random.gaussian();  // also beyond the edge
    const double y = 5.0 + 6.0 * random.gaussian();
    EXPECT_NEAR(ground.height_m(x, y), field.height_m(x, y), 1e-14);
    EXPECT_EQ(ground.at(x, y, 100.0).height_m, ground.height_m(x, y));
  }
}

TEST(GroundHeights, NormalIsThatOfTheTriangle) {
  const Ground ground(rough(), {}, {});
  RandomStream random(2, "places");
  const double e = 1e-6;
  int compared = 0;
  for (int i = 0; i < 500; ++i) {
    const double x = 5.0 + 2.0 * random.gaussian();
    const double y = 5.0 + 2.0 * random.gaussian();
    const double h = ground.height_m(x, y);
    const double east = (ground.height_m(x + e, y) - h) / e;
    const double west = (h - ground.height_m(x - e, y)) / e;
    const double north = (ground.height_m(x, y + e) - h) / e;
    const double south = (h - ground.height_m(x, y - e)) / e;
    if (std::abs(east - west) < 1e-6 && std::abs(north - south) < 1e-6) {
      ++compared;
      EXPECT_LT((ground.at(x, y, 9.0).normal_W - Vector(-east, -north, 1.0).normalized()).norm(),
                1e-7);
    }
  }
  EXPECT_GT(compared, 400);
}

TEST(GroundHeights, GoOnLevelBeyondTheEdge) {
  const Ground ground(terrain({0.0, 0.0}, 3, 1.0, [](double x, double) { return x; }), {}, {});
  EXPECT_EQ(ground.height_m(5.0, 1.0), 2.0);
  EXPECT_EQ(ground.at(5.0, 1.0, 9.0).normal_W, Vector::UnitZ());
}

TEST(GroundHeights, ANodeThatIsDugChangesItsCellsOnly) {
  Ground ground(terrain({0.0, 0.0}, 5, 1.0, [](double, double) { return 0.0; }), {}, {});
  ground.set_node(2, 2, -0.5);
  EXPECT_EQ(ground.height_m(2.0, 2.0), -0.5);
  EXPECT_EQ(ground.height_m(1.5, 2.0), -0.25);
  EXPECT_EQ(ground.height_m(1.0, 2.0), 0.0);
  EXPECT_EQ(ground.field().node(2, 2), -0.5);
}

TEST(GroundSoil, IsThatOfTheCell) {
  SoilMap soils;
  soils.soils = {SoilParameters{}, SoilParameters{}};
  soils.soils[1].name = "ice";
  soils.soils[1].friction = 0.05;
  soils.cells = {0, 1, 0, 0};
  const Ground ground(terrain({0.0, 0.0}, 3, 1.0, [](double, double) { return 0.0; }), soils, {});
  EXPECT_EQ(ground.at(0.5, 0.5, 1.0).friction, 0.8);
  EXPECT_EQ(ground.at(1.5, 0.5, 1.0).friction, 0.05);
  EXPECT_EQ(ground.at(1.5, 0.5, 1.0).soil, 1);
  EXPECT_EQ(ground.at(1.5, 1.5, 1.0).soil, 0);
  EXPECT_EQ(ground.at(9.0, -9.0, 1.0).soil, 1);  // beyond the edge: the nearest cell
  const auto wheel = ground.wheel_contact({1.5, 0.5, 0.55}, Vector::UnitY(), 0.59);
  ASSERT_TRUE(wheel);
  EXPECT_EQ(wheel->ground.friction, 0.05);
}

TEST(Obstacles, OneStandsOnThoseBelowTheCeiling) {
  Obstacle ball;
  ball.shape = ObstacleShape::sphere;
  ball.half_lengths_m.x() = 1.0;
  Obstacle bridge = box_at(10.0, 0.0, 5.0, {2.0, 2.0, 0.2});
  bridge.friction = 0.6;
  const Ground ground(terrain({-20.0, -20.0}, 81, 0.5, [](double, double) { return 0.0; }), {},
                      {ball, bridge});
  const GroundPoint on_ball = ground.at(0.6, 0.0, 2.0);
  EXPECT_NEAR(on_ball.height_m, 0.8, 1e-15);
  EXPECT_LT((on_ball.normal_W - Vector(0.6, 0.0, 0.8)).norm(), 1e-12);
  EXPECT_TRUE(on_ball.obstacle);
  EXPECT_EQ(ground.at(0.6, 0.0, 0.5).height_m, 0.0);
  EXPECT_EQ(ground.at(10.0, 0.0, 2.0).height_m, 0.0);
  EXPECT_NEAR(ground.at(10.0, 0.0, 6.0).height_m, 5.2, 1e-15);
  EXPECT_EQ(ground.at(10.0, 0.0, 6.0).friction, 0.6);
}

TEST(Obstacles, TurnedBoxesAndCylindersHaveExactTops) {
  Obstacle ramp = box_at(0.0, 0.0, 0.0, {2.0, 1.0, 0.1});
  ramp.X_WO.linear() = Eigen::AngleAxisd(-0.3, Vector::UnitY()).toRotationMatrix();
  Obstacle log;
  log.shape = ObstacleShape::cylinder;
  log.X_WO.translation() = Vector(8.0, 0.0, 0.2);
  log.X_WO.linear() = Eigen::AngleAxisd(std::acos(0.0), Vector::UnitX()).toRotationMatrix();
  log.half_lengths_m = Vector(0.3, 0.0, 2.0);
  const Ground ground(terrain({-20.0, -20.0}, 81, 0.5, [](double, double) { return -1.0; }), {},
                      {ramp, log});
  EXPECT_NEAR(ground.at(0.5, 0.3, 9.0).height_m, 0.1 / std::cos(0.3) + 0.5 * std::tan(0.3), 1e-12);
  EXPECT_LT((ground.at(0.5, 0.3, 9.0).normal_W - Vector(-std::sin(0.3), 0.0, std::cos(0.3))).norm(),
            1e-12);
  EXPECT_NEAR(ground.at(8.1, 1.5, 9.0).height_m, 0.2 + std::sqrt(0.09 - 0.01), 1e-12);
  EXPECT_EQ(ground.at(8.1, 2.1, 9.0).height_m, -1.0);
}

TEST(Obstacles, PenetrationIsTheDeepest) {
  const Ground ground(
      terrain({-20.0, -20.0}, 81, 0.5, [](double x, double) { return 0.5 * x - 10.0; }), {},
      {box_at(0.0, 0.0, 1.0, {1.0, 1.0, 1.0})});
  EXPECT_FALSE(ground.penetration({0.0, 5.0, 1.0}));
  const auto in_hill = ground.penetration({2.0, 5.0, 0.5});
  ASSERT_TRUE(in_hill);
  EXPECT_NEAR(in_hill->depth_m, 0.5 / std::hypot(1.0, 0.5), 1e-14);
  const auto in_box = ground.penetration({0.9, 0.0, 1.5});
  ASSERT_TRUE(in_box);
  EXPECT_NEAR(in_box->depth_m, 0.1, 1e-15);
  EXPECT_EQ(in_box->normal_W, Vector::UnitX());
  EXPECT_EQ(in_box->friction, 0.7);
}

TEST(Obstacles, ThousandsAreFoundAsBruteForceFindsThem) {
  RandomStream random(5, "forest");
  std::vector<Obstacle> many;
  for (int i = 0; i < 1000; ++i) {
    Obstacle o =
        box_at(25.0 * random.gaussian(), 25.0 * random.gaussian(), 0.3, Vector(0.5, 0.8, 0.2));
    o.shape = static_cast<ObstacleShape>(i % 3);
    o.X_WO.linear() = Eigen::AngleAxisd(random.gaussian(), Vector::UnitZ()).toRotationMatrix();
    many.push_back(o);
  }
  const HeightField flat = terrain({-200.0, -200.0}, 3, 200.0, [](double, double) { return 0.0; });
  const Ground all(flat, {}, many);
  std::vector<Ground> single;
  for (const Obstacle& o : many) {
    single.emplace_back(flat, SoilMap{}, std::vector<Obstacle>{o});
  }
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const double x = 25.0 * random.gaussian();
    const double y = 25.0 * random.gaussian();
    double highest = 0.0;
    for (const Ground& ground : single) {
      highest = std::max(highest, ground.at(x, y, 9.0).height_m);
    }
    hits += highest > 0.0 ? 1 : 0;
    EXPECT_EQ(all.at(x, y, 9.0).height_m, highest);
  }
  EXPECT_GT(hits, 5);
}

TEST(Obstacles, WhatHasFallenIsWhereItLiesAndNotWhereItStood) {
  Obstacle trunk;
  trunk.shape = ObstacleShape::cylinder;
  trunk.half_lengths_m = {0.15, 0.15, 4.0};
  trunk.X_WO.translation() = Vector(5.0, 5.0, 4.0);
  trunk.strength_nm = 6e4;
  const Ground ground(terrain(Eigen::Vector2d::Zero(), 61, 0.5, [](double, double) { return 0.0; }),
                      {}, {trunk});
  const auto wheel_on = [&](const Ground& on, double x) {
    return on.wheel_contact({x, 5.0, 0.55}, Vector::UnitY(), 0.5);
  };
  EXPECT_FALSE(wheel_on(ground, 10.0));
  const Ground copy = ground;
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  X_WO.linear() = Eigen::AngleAxisd(0.5 * M_PI, Vector::UnitY()).matrix();
  X_WO.translation() = Vector(9.0, 5.0, 0.0);  // Its foot stays.
  ASSERT_TRUE(ground.lay(0, X_WO));
  const auto over = wheel_on(ground, 10.0);
  ASSERT_TRUE(over);
  EXPECT_NEAR(over->depth_m, 0.5 - (0.55 - 0.15), 1e-9);
  EXPECT_TRUE(over->ground.obstacle);
  EXPECT_FALSE(wheel_on(copy, 10.0)) << "of a ground of its own";
  EXPECT_NEAR(ground.at(10.0, 5.0, 1.0).height_m, 0.15, 1e-12);
  EXPECT_FALSE(ground.penetration({5.0, 5.0, 3.0})) << "it stands there no more";
  std::vector<std::uint32_t> found;
  ground.obstacles_near({12.0, 4.0}, {12.5, 5.0}, found);
  EXPECT_FALSE(found.empty());
  EXPECT_LT((ground.obstacles()[0].foot_W() - Vector(5.0, 5.0, 0.0)).norm(), 1e-12);
}

TEST(GroundSetUp, BadInputIsRefusedByName) {
  const HeightField flat = terrain({0.0, 0.0}, 3, 1.0, [](double, double) { return 0.0; });
  const auto refused = [&](const SoilMap& soils, const std::vector<Obstacle>& obstacles,
                           const char* part) {
    try {
      const Ground ground(flat, soils, obstacles);
      ADD_FAILURE() << part;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  SoilMap map;
  map.cells = {0, 0, 0};
  refused(map, {}, "3 cells, allowed: none or 4");
  map.cells = {0, 0, 0, 7};
  refused(map, {}, "cell 3 is soil 7");
  map.cells.clear();
  map.soils.clear();
  refused(map, {}, "0 soils");
  refused({}, {box_at(0.0, 0.0, 0.0, {1.0, -1.0, 1.0})}, "obstacle 0: half_lengths_m[1]");
  Obstacle stretched;
  stretched.X_WO.linear() *= 2.0;
  refused({}, {Obstacle{}, stretched}, "obstacle 1: X_WO");
  EXPECT_THROW(Ground::plane({0.0, 0.0, -1.0}, {}), std::invalid_argument);
  EXPECT_THROW(Ground::plane({0.0, std::numeric_limits<double>::quiet_NaN(), 1.0}, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
