// What looks like what: soils of terrain, bare slopes, panes, and labels.
#include "sim/camera/surface_look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "camera_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

/// Cells of 0.5 m, 40 m across, rising to the east from x = 0 on.
HeightField ground_rising(double slope) {
  HeightField field;
  field.cell_m = 0.5;
  field.columns = field.rows = 81;
  field.origin_m = {-20.0, -20.0};
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      field.heights_m.push_back(slope * std::max(0.0, 0.5 * static_cast<double>(c) - 20.0));
    }
  }
  return field;
}

/// The first label to the west of x = 0, the second to the east.
Scene::InstanceId add_halves(Scene& scene, std::vector<std::string> labels) {
  const Scene::InstanceId terrain = scene.add_terrain(ground_rising(0.0), surface("ground"));
  std::vector<std::uint8_t> cells;
  for (int i = 0; i < 80 * 80; ++i) {
    cells.push_back(i % 80 < 40 ? 0 : 1);
  }
  scene.cover_terrain(terrain, std::move(labels), std::move(cells));
  return terrain;
}

/// Straight down from 6 m, east at the top of the picture.
RenderedPicture from_above(const Scene& scene, const CameraParameters& parameters) {
  const Daylight light({.cloud_cover = 1.0}, sun_at(35.0, 220.0));
  CameraRenderer camera(parameters, 1, "camera");
  RenderedPicture picture;
  camera.render(scene, job_for(parameters, at(0.0, 0.0, 6.0, 0.0, 90.0 * kDegree), light), picture);
  return picture;
}

Eigen::Vector3d colour_of(const RenderedPicture& picture, int y0, int y1) {
  return {mean_luminance(picture, 0, y0, picture.width, y1, 0),
          mean_luminance(picture, 0, y0, picture.width, y1, 1),
          mean_luminance(picture, 0, y0, picture.width, y1, 2)};
}

TEST(SurfaceLook, SoilsOfTerrainLookLikeThemselves) {
  Scene scene;
  add_halves(scene, {"lawn", "gravel"});
  ready(scene);
  const RenderedPicture picture = from_above(scene, small_camera());
  const Eigen::Vector3d gravel = colour_of(picture, 0, 50);
  const Eigen::Vector3d lawn = colour_of(picture, 70, 120);
  EXPECT_GT(lawn.y(), 1.1 * lawn.x());
  EXPECT_GT(gravel.x(), 1.1 * gravel.y());
  EXPECT_GT(gravel.y(), 1.5 * lawn.y());
}

TEST(SurfaceLook, SoilsThatNobodyKnowsLookLikeTheTerrain) {
  Scene plain;
  plain.add_terrain(ground_rising(0.0), surface("ground"));
  ready(plain);
  Scene covered;
  add_halves(covered, {"regolith", "hard"});
  ready(covered);
  CameraParameters parameters = small_camera();
  EXPECT_EQ(from_above(plain, parameters).luminance, from_above(covered, parameters).luminance);
  // Until a look says what they are.
  parameters.looks = {{.label = "regolith", .kind = SurfaceKind::mud}};
  EXPECT_NE(from_above(plain, parameters).luminance, from_above(covered, parameters).luminance);
}

TEST(SurfaceLook, TwinsShowTheSameSoils) {
  Scene scene;
  add_halves(scene, {"lawn", "gravel"});
  scene.add_object(scene.add_mesh(make_box("house", {2.0, 2.0, 2.0})), at(1.0, 1.0, 1.0), 1.0,
                   surface("building"));
  ready(scene);
  const std::unique_ptr<Scene> twin = scene.twin();
  twin->begin_slice(kStart, kStart + 100ms, scene.placement(), {});
  EXPECT_EQ(from_above(scene, small_camera()).luminance,
            from_above(*twin, small_camera()).luminance);
}

TEST(SurfaceLook, SoilsMeetInOneEdge) {
  Scene scene;
  add_halves(scene, {"forest_floor", "gravel"});
  ready(scene);
  CameraParameters parameters = small_camera();
  // Both even, so that brightness tells them apart.
  parameters.looks = {
      {.label = "forest_floor", .kind = SurfaceKind::plaster, .colour = {0.1, 0.1, 0.1}},
      {.label = "gravel", .kind = SurfaceKind::plaster, .colour = {0.6, 0.6, 0.6}}};
  const RenderedPicture picture = from_above(scene, parameters);
  const double middle =
      0.5 * (mean_luminance(picture, 0, 0, 160, 20) + mean_luminance(picture, 0, 100, 160, 120));
  // 80 pixels are 6 m: within 0.5 m of the edge and nowhere else both are seen.
  int changes = 0;
  for (int x = 0; x < 160; ++x) {
    for (int y = 0; y + 1 < 120; ++y) {
      const bool bright = luminance_at(picture, x, y) > middle;
      if (bright != (luminance_at(picture, x, y + 1) > middle)) {
        ++changes;
        EXPECT_NEAR(y, 59.5, 8.0) << "in column " << x;
      }
    }
  }
  EXPECT_GE(changes, 160);
  EXPECT_LT(changes, 240);
}

TEST(SurfaceLook, SteepGroundIsBare) {
  // 8 m before a slope that grass does not hold, and one that it does.
  const Daylight light({.cloud_cover = 1.0}, sun_at(35.0, 220.0));
  const auto greenness = [&](double slope) {
    Scene scene;
    scene.add_terrain(ground_rising(slope), surface("lawn"));
    ready(scene);
    const CameraParameters parameters = small_camera();
    CameraRenderer camera(parameters, 1, "camera");
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, at(-8.0, 0.0, 2.0, 0.0, 0.0), light), picture);
    const int y0 = 50;
    const int y1 = 60;
    return mean_luminance(picture, 40, y0, 120, y1, 1) /
           mean_luminance(picture, 40, y0, 120, y1, 0);
  };
  EXPECT_GT(greenness(0.5), 1.1);
  EXPECT_LT(greenness(2.5), 0.95);
}

TEST(SurfaceLook, PanesKeepTheirShareWithDistance) {
  // A wall 30 m wide and 18 m high. Far away a pixel holds several windows, and is as dark as they
  // make the wall on average.
  const Daylight light({.cloud_cover = 1.0, .ground_albedo = 0.0}, sun_at(35.0, 220.0));
  const auto brightness = [&](const char* label, double range_m, double focal_px) {
    Scene scene;
    scene.add_object(scene.add_mesh(make_box("wall", {2.0, 30.0, 18.0})), at(range_m, 0.0, 0.0),
                     1.0, surface(label));
    ready(scene);
    const CameraParameters parameters = small_camera(focal_px);
    CameraRenderer camera(parameters, 1, "camera");
    RenderedPicture picture;
    camera.render(scene, job_for(parameters, at(0.0, 0.0, 0.0), light), picture);
    const int half_x = static_cast<int>(focal_px * 14.0 / range_m);
    const int half_y = static_cast<int>(focal_px * 8.0 / range_m);
    return mean_luminance(picture, 80 - half_x, 60 - half_y, 80 + half_x, 60 + half_y);
  };
  const double wall = brightness("wall", 40.0, 200.0);
  const double near = brightness("building", 40.0, 200.0);
  const double far = brightness("building", 1000.0, 600.0);
  EXPECT_LT(near, 0.85 * wall);
  EXPECT_GT(near, 0.6 * wall);
  EXPECT_NEAR(far / near, 1.0, 0.06);
}

TEST(SurfaceLook, CoverMustFitItsTerrain) {
  Scene scene;
  const Scene::InstanceId terrain = scene.add_terrain(ground_rising(0.0), surface("ground"));
  const Scene::InstanceId box = scene.add_object(scene.add_mesh(make_box("box", {1.0, 1.0, 1.0})),
                                                 at(0.0, 0.0, 5.0), 1.0, surface("building"));
  EXPECT_THROW(scene.cover_terrain(terrain, {"mud"}, std::vector<std::uint8_t>(6399, 0)),
               std::invalid_argument);
  EXPECT_THROW(scene.cover_terrain(terrain, {"mud"}, std::vector<std::uint8_t>(6400, 1)),
               std::invalid_argument);
  EXPECT_THROW(scene.cover_terrain(box, {"mud"}, std::vector<std::uint8_t>(6400, 0)),
               std::invalid_argument);
  EXPECT_NO_THROW(scene.cover_terrain(terrain, {"mud"}, std::vector<std::uint8_t>(6400, 0)));
}

TEST(SurfaceLook, FoliageOfClosedCrownsIsCanopy) {
  Material leaves = surface("crown");
  const Shade loose = shade_of(leaves, {});
  leaves.foliage = true;
  const Shade closed = shade_of(leaves, {});
  EXPECT_EQ(loose.stones, 0.0F);
  EXPECT_GT(closed.stones, 0.0F);
  // What a camera says of the label counts for both.
  const std::vector<SurfaceLook> looks{{.label = "crown", .kind = SurfaceKind::concrete}};
  EXPECT_EQ(shade_of(leaves, looks).grain, shade_of(SurfaceKind::concrete).grain);
}

}  // namespace
}  // namespace rigwire::sim
