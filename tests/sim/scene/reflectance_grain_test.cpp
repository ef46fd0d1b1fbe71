#include "sim/scene/reflectance_grain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/lidar/counter_noise.h"
#include "sim/lidar/hit_surface.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

/// A point in a cube of 60 m.
Eigen::Vector3d reflectance_point(std::uint64_t number) {
  return 60.0 * Eigen::Vector3d(counter_uniform(number, 0), counter_uniform(number, 1),
                                counter_uniform(number, 2)) -
         Eigen::Vector3d::Constant(30.0);
}

float at_point(const Eigen::Vector3d& p_W, const Eigen::Vector3d& origin_W, float variation) {
  const Eigen::Vector3d p = p_W - origin_W;
  return grained(0.2F, variation, static_cast<float>(p.x()), static_cast<float>(p.y()),
                 static_cast<float>(p.z()), GrainLattice(origin_W));
}

TEST(ReflectanceGrain, KeepsTheMeanAndHasALongTail) {
  for (const float variation : {0.2F, 0.6F, 1.0F}) {
    constexpr int kPoints = 100'000;
    std::vector<float> found;
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      found.push_back(
          at_point(reflectance_point(static_cast<std::uint64_t>(i)), {0, 0, 0}, variation));
      sum += static_cast<double>(found.back());
    }
    std::ranges::sort(found);
    // Distribution of 4 u^3 - 1: variance 9 / 7, median -1 / 2, 95 % below 2.43.
    const double v = static_cast<double>(variation);
    EXPECT_NEAR(sum / kPoints, 0.2, 0.2 * v * 4.0 * std::sqrt(9.0 / 7.0 / kPoints));
    EXPECT_NEAR(found[kPoints / 2], 0.2 * (1.0 - 0.5 * v), 0.2 * v * 0.03);
    EXPECT_NEAR(found[kPoints * 95 / 100], 0.2 * (1.0 + 2.43 * v), 0.2 * v * 0.06);
    EXPECT_GE(found.front(), 0.2F * (1.0F - variation) - 1e-6F);
  }
}

TEST(ReflectanceGrain, IsTheSameFromEveryLocalOrigin) {
  int different = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const Eigen::Vector3d p_W = reflectance_point(i) + Eigen::Vector3d(5e5, -5.4e6, 200.0);
    const float here = at_point(p_W, {500'000.0, -5'400'000.0, 200.0}, 0.7F);
    const float there = at_point(p_W, {500'213.0, -5'399'901.0, 187.0}, 0.7F);
    different += here == there ? 0 : 1;
  }
  // Floats of 200 m at the border of a cell: some 1e-5 m of 0.5 m, on three sides.
  EXPECT_LT(different, 20);
}

TEST(ReflectanceGrain, WallsAlongTheAxesAreNotSpeckled) {
  for (const double x_m : {0.0, 0.15, 0.3, 30.0}) {
    int equal = 0;
    for (int i = 0; i < 4000; ++i) {
      const Eigen::Vector3d p_W(x_m, 0.011 * i, 0.013 * i);
      const Eigen::Vector3d next_W = p_W + Eigen::Vector3d(1e-6, 0.01, 0.0);
      equal += at_point(p_W, {0, 0, 0}, 0.7F) == at_point(next_W, {0, 0, 0}, 0.7F) ? 1 : 0;
    }
    EXPECT_GT(equal, 3700) << x_m;  // a border each 0.5 m or less, in steps of 0.01 m
  }
}

TEST(ReflectanceGrain, LanesAndSinglePlacesAgree) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("wall", {1.0, 50.0, 50.0}));
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.translation().x() = 10.5;
  Material material{.reflectance = 0.3, .label = "wall"};
  material.variation = 0.5;
  const auto wall = scene.add_object(mesh, X_WM, 1.0, material);
  scene.begin_slice(kStart, kStart + Duration{1'000'000}, {3.0, 0.0, 0.0}, {});
  const Scene::Internals& in = scene.internals();
  ASSERT_TRUE(in.varies);
  const GrainLattice lattice(in.origin_W);
  RTCRayHit8 packet{};
  for (std::size_t i = 0; i < kLanes; ++i) {
    packet.ray.dir_x[i] = 1.0F;
    packet.ray.org_y[i] = static_cast<float>(i);
    packet.ray.org_z[i] = 0.7F * static_cast<float>(i);
    packet.ray.tfar[i] = 7.0F + 0.3F * static_cast<float>(i);
    packet.hit.instID[0][i] = in.placed_of(wall).geometry_id;
    packet.hit.geomID[i] = 0;
  }
  const SurfaceNumbers surface(packet.hit);
  LaneArray reflectance;
  reflectance.fill(in.shading[surface[0]].reflectance);
  vary_reflectance(in, lattice, packet, reflectance);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Eigen::Vector3f p(packet.ray.tfar[i], packet.ray.org_y[i], packet.ray.org_z[i]);
    EXPECT_FLOAT_EQ(reflectance[i], varied_reflectance(in, lattice, surface[i], p));
  }
  EXPECT_NE(reflectance[0], reflectance[1]);
}

TEST(ReflectanceGrain, ObjectsDifferWithinHalfTheVariationAndBodiesDoNot) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {1.0, 1.0, 1.0}));
  Material material{.reflectance = 0.4, .label = "box"};
  material.variation = 0.6;
  const auto body = scene.add_body("boom");
  const auto part = scene.add_body_part(body, mesh, Eigen::Isometry3d::Identity(), material);
  double sum = 0.0;
  double least = 1.0;
  double most = 0.0;
  constexpr int kObjects = 500;
  const auto shown = [&](Scene::InstanceId id) {
    const Scene::Internals& in = scene.internals();
    return in.shading[in.placed_of(id).geometry_id];
  };
  for (int i = 0; i < kObjects; ++i) {
    const auto id = scene.add_object(mesh, Eigen::Isometry3d::Identity(), 1.0, material);
    const double own = static_cast<double>(shown(id).reflectance);
    sum += own;
    least = std::min(least, own);
    most = std::max(most, own);
  }
  EXPECT_NEAR(sum / kObjects, 0.4, 4.0 * 0.4 * 0.6 / std::sqrt(12.0 * kObjects));
  EXPECT_GE(least, 0.4 * 0.7 - 1e-6);
  EXPECT_LE(most, 0.4 * 1.3 + 1e-6);
  EXPECT_LT(least, 0.4 * 0.72);
  EXPECT_GT(most, 0.4 * 1.28);
  EXPECT_EQ(shown(part).reflectance, 0.4F);
  EXPECT_EQ(shown(part).variation, 0.0F);
}

TEST(ReflectanceGrain, GroundHasTheReflectanceOfTheSoilThatLiesThere) {
  HeightField field;
  field.cell_m = 1.0;
  field.columns = 21;
  field.rows = 21;
  field.origin_m = {-10.0, -10.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  Scene scene;
  const auto terrain = scene.add_terrain(field, {.reflectance = 0.4, .label = "lawn"});
  std::vector<std::uint8_t> cells(400, 0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    cells[i] = i % 20 >= 10 ? 1 : 0;  // east of x = 0
  }
  scene.cover_terrain(terrain, {"lawn", "asphalt"}, cells, {0.0, 0.15});
  const auto twin = scene.twin();
  scene.begin_slice(kStart, kStart + Duration{1'000'000}, {40.0, 7.0, 0.0}, {});
  twin->begin_slice(kStart, kStart + Duration{1'000'000}, scene.placement(), {});
  for (const Scene* one :
       {static_cast<const Scene*>(&scene), static_cast<const Scene*>(twin.get())}) {
    const Scene::Internals& in = one->internals();
    ASSERT_TRUE(in.varies);
    const std::uint32_t surface = in.placed_of(terrain).geometry_id;
    const GrainLattice lattice(in.origin_W);
    const auto met = [&](double x, double y) {
      const Eigen::Vector3d p = Eigen::Vector3d(x, y, 0.0) - in.origin_W;
      return varied_reflectance(in, lattice, surface, p.cast<float>());
    };
    EXPECT_EQ(met(-5.5, 3.5), 0.4F);
    EXPECT_EQ(met(-0.5, -9.5), 0.4F);
    EXPECT_EQ(met(0.5, -9.5), 0.15F);
    EXPECT_EQ(met(10.001, 10.001), 0.15F) << "a rounding beyond the edge";
  }
  EXPECT_THROW(scene.cover_terrain(terrain, {"lawn", "asphalt"}, cells, {0.1}),
               std::invalid_argument);
  EXPECT_THROW(scene.cover_terrain(terrain, {"lawn", "asphalt"}, cells, {0.1, 1.5}),
               std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
