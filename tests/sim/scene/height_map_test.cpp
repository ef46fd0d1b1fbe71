#include "sim/scene/height_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/scene/scene_description.h"
#include "sim/scene/utm.h"

namespace rigwire::sim {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// A plane, which every interpolation keeps.
HeightField plane(std::size_t columns, std::size_t rows, double cell_m) {
  HeightField field;
  field.cell_m = cell_m;
  field.columns = columns;
  field.rows = rows;
  field.origin_m = -0.5 * cell_m *
                   Eigen::Vector2d(static_cast<double>(columns - 1), static_cast<double>(rows - 1));
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const Eigen::Vector2d p =
          field.origin_m + cell_m * Eigen::Vector2d(static_cast<double>(c), static_cast<double>(r));
      field.heights_m.push_back(100.0 + 0.1 * p.x() - 0.05 * p.y());
    }
  }
  return field;
}

TEST(HeightMap, FinerAndCoarserCellsKeepAPlane) {
  const HeightField loaded = plane(101, 81, 5.0);
  for (const double cell : {0.0, 1.3, 5.0, 12.0}) {
    for (const double size : {0.0, 150.0}) {
      const HeightField field = resampled(loaded, cell, size);
      EXPECT_NO_THROW(validate(field));
      EXPECT_DOUBLE_EQ(field.cell_m, cell == 0.0 ? 5.0 : cell);
      for (std::size_t r = 0; r < field.rows; r += 7) {
        for (std::size_t c = 0; c < field.columns; c += 5) {
          const double x = field.origin_m.x() + field.cell_m * static_cast<double>(c);
          const double y = field.origin_m.y() + field.cell_m * static_cast<double>(r);
          EXPECT_NEAR(field.node(c, r), 100.0 + 0.1 * x - 0.05 * y, 1e-9);
        }
      }
    }
  }
}

TEST(HeightMap, AskingForMoreThanThereIsNamesWhatThereIs) {
  EXPECT_THAT([] { (void)resampled(plane(101, 81, 5.0), 0.0, 450.0); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("terrain.size: found 450 m"), HasSubstr("-200"))));
  EXPECT_THAT([] { (void)resampled(plane(101, 81, 5.0), 0.01, 0.0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("8192")));
}

TEST(HeightMap, SceneStandsOnTheMap) {
  SceneDescription description;
  HeightMapTerrain map;
  map.material.label = "measured";
  map.heights = std::make_shared<HeightField>(plane(41, 41, 2.0));
  description.terrain = map;
  const BuiltScene built = build_scene(description, {}, 1);
  built.scene->begin_slice(kStart, kStart + std::chrono::milliseconds{1}, {0, 0, 100}, {});
  const auto hit =
      built.scene->cast({10.3, -5.7, 150.0}, -Eigen::Vector3d::UnitZ(), 0.0, 100.0, kStart);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(150.0 - hit->range_m, 100.0 + 1.03 + 0.285, 1e-4);
  EXPECT_EQ(built.scene->label(hit->instance), "measured");
  EXPECT_EQ(built.scene->name(hit->instance), "terrain");
}

TEST(HeightMap, UnloadedMapIsNamed) {
  SceneDescription description;
  HeightMapTerrain map;
  map.file = "dem.tif";
  EXPECT_NO_THROW(validate(map)) << "a file is checked before its heights are loaded";
  description.terrain = map;
  EXPECT_THAT(
      [&] { (void)build_scene(description, {}, 1); },
      ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("dem.tif"), HasSubstr("not loaded"))));
}

/// Length of the meridian from the equator to `latitude` on WGS 84, by Simpson's rule.
double meridian_m(double latitude_rad) {
  constexpr int kSteps = 2000;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    const double sine = std::sin(latitude_rad * i / kSteps);
    const double radius =
        6378137.0 * (1.0 - 6.69437999014e-3) / std::pow(1.0 - 6.69437999014e-3 * sine * sine, 1.5);
    sum += radius * (i == 0 || i == kSteps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0));
  }
  return sum * latitude_rad / (3.0 * kSteps);
}

TEST(Utm, CentralMeridianIsTheMeridianArcAtTheZonesScale) {
  for (const double latitude : {1.0, 33.9, 49.4247, 70.0}) {
    const double arc = 0.9996 * meridian_m(latitude * std::numbers::pi / 180.0);
    const UtmPlace north = utm_place(latitude, 9.0, 32, true);
    EXPECT_NEAR(north.easting_m, 500e3, 1e-6);
    EXPECT_NEAR(north.northing_m, arc, 1e-4);
    EXPECT_NEAR(north.grid_scale, 0.9996, 1e-9);
    EXPECT_NEAR(utm_place(-latitude, 9.0, 32, false).northing_m, 10e6 - arc, 1e-4);
  }
  EXPECT_NEAR(utm_place(-1e-6, 9.0, 32, true).northing_m, -0.11, 0.01)
      << "zones run on beyond the equator";
  EXPECT_THROW((void)utm_place(49.4, 100.0, 32, true), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
