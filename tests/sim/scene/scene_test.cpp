#include "sim/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim/random.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Property;
using testing::ThrowsMessage;

constexpr SimTime kSceneT0 = kStart + milliseconds{10};
constexpr SimTime kSceneT1 = kStart + milliseconds{20};

Isometry3d at(double x, double y, double z) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() << x, y, z;
  return X;
}

HeightField flat_ground(const Vector3d& centre_W) {
  HeightField field;
  field.cell_m = 1.0;
  field.columns = 201;
  field.rows = 201;
  field.origin_m = {centre_W.x() - 100.0, centre_W.y() - 100.0};
  field.heights_m.assign(field.columns * field.rows, centre_W.z());
  return field;
}

HeightField rough_ground() {
  HeightField field = flat_ground(Vector3d::Zero());
  RandomStream random(1, "rough");
  for (double& height : field.heights_m) {
    height = random.uniform(-1.0, 1.0);
  }
  return field;
}

Vector3d random_direction(RandomStream& random) {
  return Vector3d(random.gaussian(), random.gaussian(), random.gaussian()).normalized();
}

TEST(Scene, PlaneRangeEqualsTheClosedFormFarFromTheMapOrigin) {
  for (const double offset : {0.0, 10e3, 1000e3}) {
    const Vector3d centre(offset, -0.5 * offset, 300.0);
    Scene scene;
    scene.add_terrain(flat_ground(centre), {});
    scene.begin_slice(kSceneT0, kSceneT1, centre, {});
    RandomStream random(2, "plane");
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
      Vector3d direction = random_direction(random);
      direction.z() = -std::abs(direction.z()) - 0.03;
      direction.normalize();
      const Vector3d p = centre + Vector3d(0.123, 0.456, 2.5);
      const double truth = -2.5 / direction.z();
      const auto hit = scene.cast(p, direction, 0.1, 200.0, kSceneT0);
      ASSERT_TRUE(hit.has_value()) << "leak at offset " << offset;
      worst = std::max(worst, std::abs(hit->range_m - truth));
    }
    EXPECT_LT(worst, 0.5e-3) << "at offset " << offset;
  }
}

TEST(Scene, BoxHitHasRangeNormalAndMaterial) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {2.0, 4.0, 6.0}));
  const auto id =
      scene.add_object(mesh, at(10.0, 0.0, 0.0), 1.0, {.reflectance = 0.7, .label = "truck"});
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  const auto hit = scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0.0, 100.0, kSceneT0);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->range_m, 9.0, 1e-5);
  EXPECT_NEAR((hit->normal_W + Vector3d::UnitX()).norm(), 0.0, 1e-6);
  EXPECT_EQ(hit->instance, id);
  EXPECT_EQ(scene.material(id).label, "truck");
  EXPECT_FALSE(scene.cast(Vector3d::Zero(), Vector3d::UnitY(), 0.0, 100.0, kSceneT0).has_value());
}

TEST(Scene, ScaledRotatedObjectKeepsItsNormal) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {1.0, 1.0, 1.0}));
  Isometry3d X_WM = at(10.0, 0.0, 0.0);
  X_WM.linear() = Eigen::AngleAxisd(std::numbers::pi / 4, Vector3d::UnitZ()).toRotationMatrix();
  scene.add_object(mesh, X_WM, 4.0, {});
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  const auto hit = scene.cast({0.0, 0.5, 0.0}, Vector3d::UnitX(), 0.0, 100.0, kSceneT0);
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->range_m, 10.0 - 2.0 * std::numbers::sqrt2 + 0.5, 1e-5);
  EXPECT_NEAR(hit->normal_W.x(), -std::numbers::sqrt2 / 2, 1e-6);
  EXPECT_NEAR(hit->normal_W.y(), std::numbers::sqrt2 / 2, 1e-6);
}

TEST(Scene, RayMeetsTheMovingBoxWhereItIsAtTheRaysTime) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {2.0, 2.0, 2.0}));
  const auto body = scene.add_body("boom");
  scene.add_body_part(body, mesh, at(1.0, 0.0, 0.0), {});
  const std::vector<BodyMotion> motion{{at(10.0, 0.0, 0.0), at(14.0, 0.0, 0.0)}};
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), motion);
  for (const int ms : {10, 12, 15, 20}) {
    const auto hit =
        scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0.0, 100.0, kStart + milliseconds{ms});
    ASSERT_TRUE(hit.has_value());
    EXPECT_NEAR(hit->range_m, 10.0 + 0.4 * (ms - 10), 1e-5) << ms << " ms";
  }
}

TEST(Scene, MaskHidesOneBodyAndNothingElse) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {2.0, 2.0, 2.0}));
  const auto boom = scene.add_body("boom");
  const auto stick = scene.add_body("stick");
  scene.add_body_part(boom, mesh, Isometry3d::Identity(), {});
  scene.add_body_part(stick, mesh, Isometry3d::Identity(), {});
  const std::vector<BodyMotion> motions{{at(5.0, 0.0, 0.0), at(5.0, 0.0, 0.0)},
                                        {at(9.0, 0.0, 0.0), at(9.0, 0.0, 0.0)}};
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), motions);
  const auto range = [&](std::uint32_t mask) {
    return scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0.0, 100.0, kSceneT0, mask)->range_m;
  };
  EXPECT_NEAR(range(Scene::kSeeEverything), 4.0, 1e-5);
  EXPECT_NEAR(range(~Scene::body_mask(boom)), 8.0, 1e-5);
}

TEST(Scene, SkyIsBlockedByTerrainAndByTheMachine) {
  Scene scene;
  scene.add_terrain(flat_ground(Vector3d::Zero()), {});
  const auto mesh = scene.add_mesh(make_box("roof", {2.0, 2.0, 0.1}));
  const auto body = scene.add_body("cab");
  scene.add_body_part(body, mesh, Isometry3d::Identity(), {});
  const std::vector<BodyMotion> motion{{at(0.0, 0.0, 3.0), at(0.0, 0.0, 3.0)}};
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), motion);
  const Visibility& sky = scene;
  EXPECT_TRUE(sky.blocked({0.0, 0.0, 2.0}, Vector3d::UnitZ(), 0.05));
  EXPECT_FALSE(sky.blocked({5.0, 0.0, 2.0}, Vector3d::UnitZ(), 0.05));
  EXPECT_TRUE(sky.blocked({5.0, 0.0, 2.0}, -Vector3d::UnitZ(), 0.05));
  EXPECT_FALSE(sky.blocked({0.0, 0.0, 2.0}, Vector3d::UnitZ(), 1.5)) << "within the clearance";
}

TEST(Scene, RoughTerrainHasNoLeaksAndEqualsItsHeightFunction) {
  const HeightField ground = rough_ground();
  Scene scene;
  scene.add_terrain(ground, {});
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  RandomStream random(3, "leaks");
  std::size_t leaks = 0;
  double worst = 0.0;
  for (int i = 0; i < 1000000; ++i) {
    // Every tenth ray is aimed exactly at a node, the rest anywhere.
    const double x =
        i % 10 == 0 ? std::floor(random.uniform(-90.0, 90.0)) : random.uniform(-90.0, 90.0);
    const double y =
        i % 10 == 0 ? std::floor(random.uniform(-90.0, 90.0)) : random.uniform(-90.0, 90.0);
    const auto hit = scene.cast({x, y, 5.0}, -Vector3d::UnitZ(), 0.0, 100.0, kSceneT0);
    if (!hit.has_value()) {
      ++leaks;
      continue;
    }
    worst = std::max(worst, std::abs(5.0 - hit->range_m - ground.height_m(x, y)));
  }
  EXPECT_EQ(leaks, 0U);
  EXPECT_LT(worst, 1e-4);
}

TEST(Scene, GrazingRaysFindThePlane) {
  Scene scene;
  scene.add_terrain(flat_ground(Vector3d::Zero()), {});
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  for (const double degrees : {0.5, 1.0, 2.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const auto hit = scene.cast({-40.0, 0.3, 1.0}, {std::cos(angle), 0.0, -std::sin(angle)}, 0.0,
                                200.0, kSceneT0);
    ASSERT_TRUE(hit.has_value()) << degrees;
    EXPECT_NEAR(hit->range_m, 1.0 / std::sin(angle), 2e-3) << degrees;
  }
}

TEST(Scene, RefusesMeshesByName) {
  Scene scene;
  TriangleMesh broken = make_box("broken_rock", {1.0, 1.0, 1.0});
  broken.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { scene.add_mesh(broken); },
              ThrowsMessage<std::invalid_argument>(
                  HasSubstr("mesh 'broken_rock': vertex 3 is not a finite number")));
  EXPECT_THAT([&] { scene.add_mesh({.name = "nothing", .vertices = {}, .triangles = {}}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("'nothing': has no triangle")));
  TriangleMesh wild = make_box("wild", {1.0, 1.0, 1.0});
  wild.triangles[5][1] = 99;
  EXPECT_THAT([&] { scene.add_mesh(wild); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("names vertex 99")));
  TriangleMesh flat = make_box("flat", {1.0, 1.0, 1.0});
  for (auto& vertex : flat.vertices) {
    vertex.setZero();
  }
  EXPECT_THAT([&] { scene.add_mesh(flat); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("zero area")));
}

TEST(Scene, RefusesWhatHasNoPlaceOrNoSense) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("box", {1.0, 1.0, 1.0}));
  EXPECT_THROW(scene.add_object(mesh, at(std::nan(""), 0.0, 0.0), 1.0, {}), std::invalid_argument);
  EXPECT_THROW(scene.add_object(mesh, at(0.0, 0.0, 0.0), 0.0, {}), std::invalid_argument);
  EXPECT_THROW(scene.add_object(mesh, at(0.0, 0.0, 0.0), 1.0, {.reflectance = 1.5, .label = "x"}),
               std::invalid_argument);
  HeightField hole = flat_ground(Vector3d::Zero());
  hole.heights_m[7] = std::numeric_limits<double>::infinity();
  EXPECT_THAT([&] { scene.add_terrain(hole, {}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("column 7, row 0")));
  EXPECT_THROW(scene.begin_slice(kSceneT1, kSceneT0, Vector3d::Zero(), {}), std::invalid_argument);
  EXPECT_THROW(scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), std::vector<BodyMotion>(1)),
               std::invalid_argument);
}

TEST(Scene, RebaseLeavesRangesAsTheyWere) {
  Scene scene;
  scene.add_terrain(flat_ground(Vector3d::Zero()), {});
  const Vector3d p(3.0, 4.0, 2.0);
  const Vector3d direction = Vector3d(1.0, 1.0, -0.2).normalized();
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  const double before = scene.cast(p, direction, 0.0, 100.0, kSceneT0)->range_m;
  scene.begin_slice(kSceneT0, kSceneT1, {1000.0, 0.0, 0.0}, {});
  EXPECT_NEAR(scene.cast(p, direction, 0.0, 100.0, kSceneT0)->range_m, before, 2e-3);
  scene.begin_slice(kSceneT0, kSceneT1, Vector3d::Zero(), {});
  EXPECT_NEAR(scene.cast(p, direction, 0.0, 100.0, kSceneT0)->range_m, before, 1e-5);
}

}  // namespace
}  // namespace rigwire::sim
