#include "sim/ground/diggable_terrain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "allocation_counter.h"
#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

SoilParameters sand() {
  SoilParameters soil;
  soil.name = "sand";
  soil.soft = true;
  soil.density_kgpm3 = 1700.0;
  soil.repose_rad = 35.0 * std::numbers::pi / 180.0;
  return soil;
}

/// 40 m by 40 m about the origin, surface at the given height.
HeightField level(double cell_m, double height_m = 10.0) {
  HeightField field;
  field.cell_m = cell_m;
  field.columns = static_cast<std::size_t>(std::lround(40.0 / cell_m)) + 1;
  field.rows = field.columns;
  field.origin_m = {-20.0, -20.0};
  field.heights_m.assign(field.columns * field.rows, height_m);
  return field;
}

Ground sandy(const HeightField& field) {
  return Ground(field, SoilMap{{sand()}, {}}, {});
}

CuttingEdge edge_at(double x, double y, double z, double width, double yaw = 0.0) {
  const Vector3d side(-std::sin(yaw), std::cos(yaw), 0.0);
  const Vector3d middle(x, y, z);
  return {middle + 0.5 * width * side, middle - 0.5 * width * side};
}

/// Volume under the triangles, weighted node by node, in long double: independent of the units.
long double volume_m3(const HeightField& field) {
  long double sum = 0.0L;
  for (std::size_t r = 0; r + 1 < field.rows; ++r) {
    for (std::size_t c = 0; c + 1 < field.columns; ++c) {
      const long double diagonal = static_cast<long double>(field.node(c + 1, r)) +
                                   static_cast<long double>(field.node(c, r + 1));
      sum += (2.0L * diagonal + static_cast<long double>(field.node(c, r)) +
              static_cast<long double>(field.node(c + 1, r + 1))) /
             6.0L;
    }
  }
  return sum * static_cast<long double>(field.cell_m) * static_cast<long double>(field.cell_m);
}

void settle_fully(DiggableTerrain& terrain) {
  for (int i = 0; i < 200000 && !terrain.settled(); ++i) {
    terrain.settle();
  }
  ASSERT_TRUE(terrain.settled());
}

TEST(DiggableTerrain, PlaneCutTakesWidthTimesDepthTimesWay) {
  for (const double cell : {0.1, 0.4}) {
    for (const double yaw : {0.0, 0.3, 2.2}) {
      for (const double step : {0.001, 0.05, 3.0}) {
        Ground ground = sandy(level(cell));
        DiggableTerrain terrain(ground, {.bank_rad = 1.56});
        const Vector3d way(std::cos(yaw), std::sin(yaw), 0.0);
        std::int64_t units = 0;
        double mass = 0.0;
        CuttingEdge before = edge_at(0.05, 0.03, 9.7, 1.1, yaw);
        const int steps = static_cast<int>(std::lround(6.0 / step));
        for (int i = 1; i <= steps; ++i) {
          const Vector3d p = 6.0 * i / steps * way;
          const CuttingEdge after = edge_at(0.05 + p.x(), 0.03 + p.y(), 9.7, 1.1, yaw);
          const CutSoil soil = terrain.cut(before, after, way);
          units += soil.units;
          mass += soil.mass_kg;
          before = after;
        }
        const double volume = static_cast<double>(units) * terrain.unit_m3();
        // The column in which the edge comes down counts as swept from its rear edge.
        EXPECT_NEAR(volume, 1.1 * 0.3 * 6.0, 1.1 * 0.3 * cell + 0.01) << cell << ' ' << yaw;
        EXPECT_NEAR(mass, 1700.0 * volume, 1e-6 * mass);
        EXPECT_EQ(terrain.gained_units() + units, 0);
      }
    }
  }
}

TEST(DiggableTerrain, ASecondPassAlongTheSameWayFindsNothingInColumnsWhollySwept) {
  Ground ground = sandy(level(0.2));
  DiggableTerrain terrain(ground, {.bank_rad = 1.56});
  const auto from = edge_at(-3.1, 0.0, 9.8, 3.0);  // Edges between the nodes: whole columns only.
  const auto to = edge_at(3.1, 0.0, 9.8, 3.0);
  const auto first = terrain.cut(from, to, Vector3d::UnitX());
  const auto second = terrain.cut(from, to, Vector3d::UnitX());
  EXPECT_GT(first.units, 0);
  EXPECT_EQ(second.units, 0);
  EXPECT_NEAR(terrain.height_m(0.0, 0.0), 9.8, 1e-10);
}

TEST(DiggableTerrain, BackwardSidewaysAndAboveGroundTakeNothing) {
  Ground ground = sandy(level(0.2));
  DiggableTerrain terrain(ground, {});
  const auto at = edge_at(0.0, 0.0, 9.5, 1.0);
  EXPECT_EQ(terrain.cut(at, edge_at(-1.0, 0.0, 9.5, 1.0), Vector3d::UnitX()).units, 0);
  EXPECT_EQ(terrain.cut(at, edge_at(0.0, 1.0, 9.5, 1.0), Vector3d::UnitX()).units, 0);
  EXPECT_EQ(terrain.cut(at, edge_at(0.0, 0.0, 9.0, 1.0), Vector3d::UnitX()).units, 0);
  EXPECT_EQ(terrain.cut(edge_at(0, 0, 10.1, 1), edge_at(2, 0, 10.1, 1), Vector3d::UnitX()).units,
            0);
  EXPECT_EQ(terrain.cut(at, edge_at(std::nan(""), 0.0, 9.5, 1.0), Vector3d::UnitX()).units, 0);
  EXPECT_EQ(terrain.gained_units(), 0);
  EXPECT_FALSE(terrain.take_changes().has_value());
  EXPECT_EQ(ground.field().heights_m, level(0.2).heights_m);
}

TEST(DiggableTerrain, RockIsNotDug) {
  Ground ground = sandy(level(0.25));
  DiggableTerrain terrain(ground, {.depth_max_m = 0.4, .bank_rad = 1.56});
  EXPECT_NEAR(terrain.floor_height_m(1.0, 1.0), 9.6, 1e-12);
  terrain.cut(edge_at(-4, 0, 8.0, 2), edge_at(4, 0, 8.0, 2), Vector3d::UnitX());
  EXPECT_NEAR(terrain.height_m(0.0, 0.0), 9.6, 1e-9);
}

TEST(DiggableTerrain, HardSoilIsNotDugButLooseSoilOnItIs) {
  SoilParameters hard;
  Ground ground(level(0.25), SoilMap{{hard}, {}}, {});
  DiggableTerrain terrain(ground, {});
  EXPECT_EQ(terrain.cut(edge_at(-2, 0, 9.5, 2), edge_at(2, 0, 9.5, 2), Vector3d::UnitX()).units, 0);
  terrain.pour(0.0, 0.0, 1.0, terrain.units(0.5));
  EXPECT_GT(terrain.cut(edge_at(-2, 0, 9.5, 2), edge_at(2, 0, 9.5, 2), Vector3d::UnitX()).units, 0);
}

TEST(DiggableTerrain, PouredSoilLiesAtItsAngleOfRepose) {
  const double cell = 0.2;
  Ground ground = sandy(level(cell));
  DiggableTerrain terrain(ground, {});
  const std::int64_t load = terrain.units(0.02);
  std::int64_t poured = 0;
  for (int i = 0; i < 1000; ++i) {
    terrain.pour(0.0, 0.0, 0.3, load);
    poured += load;
    terrain.settle();
  }
  settle_fully(terrain);
  EXPECT_EQ(terrain.gained_units(), poured);
  const double limit = std::tan(sand().repose_rad);
  const HeightField& field = ground.field();
  double steepest = 0.0;
  for (std::size_t r = 1; r + 2 < field.rows; ++r) {
    for (std::size_t c = 1; c + 2 < field.columns; ++c) {
      steepest = std::max(
          {steepest, std::abs(field.node(c + 1, r) - field.node(c, r)) / cell,
           std::abs(field.node(c, r + 1) - field.node(c, r)) / cell,
           std::abs(field.node(c + 1, r + 1) - field.node(c, r)) / (cell * std::numbers::sqrt2)});
    }
  }
  EXPECT_LE(steepest, limit + 1e-3);
  EXPECT_GE(steepest, limit - 0.02);
  // The cone of that volume, 20 m3: V = pi/3 h^3 / tan^2.
  const double height = std::cbrt(3.0 * 20.0 * limit * limit / std::numbers::pi);
  EXPECT_NEAR(terrain.height_m(0.0, 0.0) - 10.0, height, 0.12 * height);
  for (const double angle : {0.0, 0.785, 1.571, 2.4, 3.14, 4.0, 5.0}) {
    const double middle = 0.5 * height / limit;
    EXPECT_NEAR(terrain.height_m(middle * std::cos(angle), middle * std::sin(angle)) - 10.0,
                0.5 * height, 0.12 * height)
        << angle;
  }
}

TEST(DiggableTerrain, FirmBankStandsAndATooSteepOneBreaks) {
  const double cell = 0.25;
  for (const double bank : {1.5, 0.7}) {
    Ground ground = sandy(level(cell));
    DiggableTerrain terrain(ground, {.bank_rad = bank});
    terrain.cut(edge_at(-3, 0, 9.0, 3), edge_at(3, 0, 9.0, 3), Vector3d::UnitX());
    const double outside = terrain.height_m(0.0, 2.25);
    settle_fully(terrain);
    EXPECT_NEAR(outside, 10.0, 1e-9);
    if (bank > 1.0) {
      EXPECT_NEAR(terrain.height_m(0.0, 2.25), 10.0, 1e-9);
      EXPECT_NEAR(terrain.height_m(0.0, 0.0), 9.0, 0.01);
    } else {
      EXPECT_LT(terrain.height_m(0.0, 1.75), 9.95);
      EXPECT_GT(terrain.height_m(0.0, 1.0), 9.05);
    }
  }
}

TEST(DiggableTerrain, ThousandsOfDigsAndPoursBalanceToTheLastUnit) {
  HeightField field = level(0.4, 412.3456789);
  RandomStream random(5, "dig");
  for (double& height : field.heights_m) {
    height += random.uniform(-0.05, 0.05);
  }
  Ground ground = sandy(field);
  DiggableTerrain terrain(ground, {});
  const long double at_start = volume_m3(ground.field());
  std::int64_t bucket = 0;
  long double taken_m3 = 0.0L;
  const auto before = rigwire::test::allocations();
  for (int i = 0; i < 4000; ++i) {
    const double x = random.uniform(-10, 10);
    const double y = random.uniform(-10, 10);
    const double yaw = random.uniform(-3, 3);
    const double z = terrain.height_m(x, y) - random.uniform(0.0, 0.4);
    const double way = random.uniform(0.0, 1.5);
    const auto soil =
        terrain.cut(edge_at(x, y, z, 1.1, yaw),
                    edge_at(x + way * std::cos(yaw), y + way * std::sin(yaw), z, 1.1, yaw + 0.05),
                    {std::cos(yaw), std::sin(yaw), 0.0});
    bucket += soil.units;
    taken_m3 += static_cast<long double>(soil.units) * static_cast<long double>(terrain.unit_m3());
    const auto out =
        static_cast<std::int64_t>(random.uniform(0.0, 1.0) * static_cast<double>(bucket));
    terrain.pour(random.uniform(-25, 25), random.uniform(-25, 25), random.uniform(0, 1.5), out);
    bucket -= out;
    terrain.settle();
    ASSERT_EQ(terrain.gained_units() + bucket, 0) << i;
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_GT(taken_m3, 100.0L);
  // By the heights themselves, which the rays and wheels see.
  const long double held =
      static_cast<long double>(bucket) * static_cast<long double>(terrain.unit_m3());
  EXPECT_NEAR(static_cast<double>((volume_m3(ground.field()) + held - at_start) / taken_m3), 0.0,
              1e-9);
}

TEST(DiggableTerrain, SlidesEndAndAreBoundedForEachCall) {
  Ground ground = sandy(level(0.4));
  DiggableTerrain terrain(ground, {.slide_visits = 16});
  terrain.pour(0.0, 0.0, 0.0, terrain.units(30.0));
  int calls = 0;
  while (!terrain.settled()) {
    terrain.settle();
    ASSERT_LT(++calls, 100000);
  }
  EXPECT_GT(calls, 10);
  terrain.take_changes();
  terrain.settle();
  EXPECT_FALSE(terrain.take_changes().has_value());
}

TEST(DiggableTerrain, ChangesAreReportedOnceAndUntouchedNodesKeepTheirBits) {
  HeightField field = level(0.25);
  RandomStream random(6, "bits");
  for (double& height : field.heights_m) {
    height += random.uniform(-1e-3, 1e-3);
  }
  Ground ground = sandy(field);
  DiggableTerrain terrain(ground, {});
  terrain.cut(edge_at(-1, 2, 9.8, 1), edge_at(1, 2, 9.8, 1), Vector3d::UnitX());
  const auto changes = terrain.take_changes();
  ASSERT_TRUE(changes.has_value());
  EXPECT_FALSE(terrain.take_changes().has_value());
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const bool inside = c >= changes->first_column && c <= changes->last_column &&
                          r >= changes->first_row && r <= changes->last_row;
      if (!inside) {
        ASSERT_EQ(ground.field().node(c, r), field.node(c, r));
      }
    }
  }
  EXPECT_LT(changes->last_column - changes->first_column, 14u);
  EXPECT_LT(changes->last_row - changes->first_row, 8u);
}

TEST(DiggableTerrain, BadParametersAreRefusedByName) {
  Ground ground = sandy(level(0.5));
  const auto make = [&](const DiggableTerrainParameters& p) {
    return [&ground, p] { DiggableTerrain terrain(ground, p); };
  };
  EXPECT_THAT(make({.depth_max_m = -1.0}), ThrowsMessage<std::invalid_argument>(HasSubstr(
                                               "depth_max: found -1 m, allowed 0 .. 1000 m")));
  EXPECT_THAT(make({.bank_rad = std::nan("")}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("bank: found nan")));
  EXPECT_THAT(make({.slide_visits = 0}),
              ThrowsMessage<std::invalid_argument>(HasSubstr("slide_visits: found 0, allowed")));
}

}  // namespace
}  // namespace rigwire::sim
