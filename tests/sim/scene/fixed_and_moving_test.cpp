// Fixed things and moving ones together: the nearest is met, by single rays and by packets.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/random.h"
#include "sim/scene/scene.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr SimTime kFixedAndMovingT0 = kStart;
constexpr SimTime kFixedAndMovingT1 = kStart + std::chrono::milliseconds{1};

Isometry3d at(const Vector3d& p) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = p;
  return X;
}

/// A pole with a plate on top: two surfaces in one model.
std::vector<MeshPart> signpost() {
  TriangleMesh plate = make_box("plate", {0.1, 1.0, 1.0});
  for (auto& vertex : plate.vertices) {
    vertex.z() += 2.5F;
  }
  TriangleMesh pole = make_box("pole", {0.1, 0.1, 2.0});
  for (auto& vertex : pole.vertices) {
    vertex.z() += 1.0F;
  }
  return {{pole, {.reflectance = 0.2, .label = "pole"}},
          {plate, {.reflectance = 0.9, .label = "plate", .retro_gain = 0.8}}};
}

TEST(FixedAndMoving, PartsOfAModelHaveTheirOwnMaterialAndOneName) {
  Scene scene;
  const auto model = scene.add_model(signpost());
  for (const double offset : {0.0, 10e3, 1000e3}) {
    const Vector3d foot(offset + 10.0, -offset, 0.0);
    const auto pole = scene.add_model_object(model, at(foot), 1.0, "sign");
    scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, foot, {});
    const auto low =
        scene.cast({foot.x() - 10.0, foot.y(), 1.0}, Vector3d::UnitX(), 0, 50, kFixedAndMovingT0);
    const auto high = scene.cast({foot.x() - 10.0, foot.y() + 0.3, 2.6}, Vector3d::UnitX(), 0, 50,
                                 kFixedAndMovingT0);
    ASSERT_TRUE(low && high);
    EXPECT_EQ(low->instance, pole);
    EXPECT_EQ(high->instance, pole + 1);
    EXPECT_EQ(scene.label(low->instance), "pole");
    EXPECT_EQ(scene.label(high->instance), "plate");
    EXPECT_EQ(scene.name(low->instance), "sign");
    EXPECT_EQ(scene.name(high->instance), "sign");
    EXPECT_NEAR(high->range_m, 9.95, 1e-4) << offset;
  }
}

TEST(FixedAndMoving, PacketsMeetWhatSingleRaysMeet) {
  Scene scene;
  const auto model = scene.add_model(signpost());
  RandomStream random(1, "posts");
  for (int i = 0; i < 60; ++i) {
    scene.add_model_object(
        model, at({random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), 0.0}), 1.0, "sign");
  }
  const auto body = scene.add_body("boom");
  scene.add_body_part(body, scene.add_mesh(make_box("boom", {2, 2, 2})), Isometry3d::Identity(),
                      {.reflectance = 0.5, .label = "boom"});
  const std::vector<BodyMotion> motion{{at({3, 3, 1}), at({3, 3, 1})}};
  scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), motion);
  const Scene::Internals& in = scene.internals();
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(32) std::array<int, 8> valid{};
  valid.fill(-1);
  std::array<int, 3> met{};
  for (int round = 0; round < 2000; ++round) {
    RTCRayHit8 packet{};
    std::array<Vector3d, 8> directions;
    const Vector3d p(0.1, 0.2, 1.8);
    const double azimuth = random.uniform(0.0, 6.283);
    for (std::size_t i = 0; i < 8; ++i) {
      const double a = azimuth + 0.002 * static_cast<double>(i);
      directions[i] = Vector3d(std::cos(a), std::sin(a), random.uniform(-0.1, 0.15)).normalized();
      const RTCRay ray = make_ray(p, directions[i], 0.0, 60.0, 0.0F, Scene::kSeeEverything);
      packet.ray.org_x[i] = ray.org_x;
      packet.ray.org_y[i] = ray.org_y;
      packet.ray.org_z[i] = ray.org_z;
      packet.ray.dir_x[i] = ray.dir_x;
      packet.ray.dir_y[i] = ray.dir_y;
      packet.ray.dir_z[i] = ray.dir_z;
      packet.ray.tfar[i] = ray.tfar;
      packet.ray.mask[i] = ray.mask;
      packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    in.intersect(valid.data(), context, packet);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto hit = scene.cast(p, directions[i], 0.0, 60.0, kFixedAndMovingT0);
      const unsigned number = surface_number(packet.hit.instID[0][i], packet.hit.geomID[i]);
      ASSERT_EQ(hit.has_value(), number != RTC_INVALID_GEOMETRY_ID);
      if (hit) {
        EXPECT_EQ(in.instance_of[number], hit->instance);
        EXPECT_FLOAT_EQ(in.shading[number].reflectance,
                        static_cast<float>(scene.material(hit->instance).reflectance));
        EXPECT_NEAR(packet.ray.tfar[i], hit->range_m, 1e-4);
        const std::string& label = scene.label(hit->instance);
        ++met[label == "pole" ? 0 : (label == "plate" ? 1 : 2)];
      }
    }
  }
  EXPECT_GT(*std::ranges::min_element(met), 100);
}

TEST(FixedAndMoving, ThingsAddedBetweenSlicesAndFarMovesAreSeen) {
  Scene scene;
  const auto cube = scene.add_mesh(make_box("cube", {2, 2, 2}));
  scene.add_object(cube, at({10, 0, 0}), 1.0, {}, "first");
  scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), {});
  EXPECT_NEAR(scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0, 50, kFixedAndMovingT0)->range_m,
              9.0, 1e-5);
  const auto second = scene.add_object(cube, at({5, 0, 0}), 1.0, {});
  scene.begin_slice(kFixedAndMovingT1, kFixedAndMovingT1 + std::chrono::milliseconds{1},
                    Vector3d::Zero(), {});
  const auto hit = scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0, 50, kFixedAndMovingT1);
  EXPECT_NEAR(hit->range_m, 4.0, 1e-5);
  EXPECT_EQ(hit->instance, second);
  EXPECT_EQ(scene.name(second), "cube") << "the mesh's name where no other is given";
  EXPECT_EQ(scene.name(0), "first");
  scene.begin_slice(kFixedAndMovingT1, kFixedAndMovingT1 + std::chrono::milliseconds{2},
                    {200.0, 0.0, 0.0}, {});
  EXPECT_NEAR(scene.cast({200, 0, 0}, -Vector3d::UnitX(), 0, 500, kFixedAndMovingT1)->range_m,
              189.0, 1e-4);
}

TEST(FixedAndMoving, AThingIsMetAlikeWhereItStandsOrIsCarried) {
  // Boxes at the same places: all fixed, all on bodies that rest, or every other one on a body.
  RandomStream placing(7, "boxes");
  std::vector<Isometry3d> poses;
  for (int i = 0; i < 80; ++i) {
    Isometry3d X = at(
        {placing.uniform(-15.0, 15.0), placing.uniform(-15.0, 15.0), placing.uniform(-3.0, 3.0)});
    X.rotate(Eigen::AngleAxisd(placing.uniform(0.0, 3.0), Vector3d(1, 2, 3).normalized()));
    poses.push_back(X);
  }
  struct Ways {
    Scene scene;
    std::vector<BodyMotion> motions;
  };
  std::array<Ways, 3> ways;
  for (std::size_t way = 0; way < ways.size(); ++way) {
    Scene& scene = ways[way].scene;
    const auto box = scene.add_mesh(make_box("box", {1.0, 1.5, 0.7}));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (way == 1 || (way == 2 && i % 2 == 0)) {
        scene.add_body_part(scene.add_body("box"), box, Isometry3d::Identity(), {});
        ways[way].motions.push_back({poses[i], poses[i]});
      } else {
        scene.add_object(box, poses[i], 1.0, {});
      }
    }
    scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), ways[way].motions);
  }
  RandomStream random(8, "rays");
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d p(random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), 0.0);
    const Vector3d direction =
        Vector3d(random.gaussian(), random.gaussian(), 0.3 * random.gaussian()).normalized();
    const auto fixed = ways[0].scene.cast(p, direction, 0.0, 100.0, kFixedAndMovingT0);
    const bool blocked = ways[0].scene.blocked(p, direction, 0.0);
    for (const std::size_t way : {1U, 2U}) {
      const auto hit = ways[way].scene.cast(p, direction, 0.0, 100.0, kFixedAndMovingT0);
      ASSERT_EQ(hit.has_value(), fixed.has_value());
      EXPECT_EQ(ways[way].scene.blocked(p, direction, 0.0), blocked);
      if (hit) {
        EXPECT_EQ(hit->instance, fixed->instance);
        EXPECT_NEAR(hit->range_m, fixed->range_m, 1e-4);
        EXPECT_NEAR((hit->normal_W - fixed->normal_W).norm(), 0.0, 1e-5);
        ++met;
      }
    }
  }
  EXPECT_GT(met, 1000);
}

TEST(FixedAndMoving, GroundThatIsDugHidesAndIsHiddenLikeOther) {
  HeightField field;
  field.cell_m = 0.5;
  field.columns = field.rows = 101;
  field.origin_m = {-25.0, -25.0};
  for (std::size_t i = 0; i < field.columns * field.rows; ++i) {
    field.heights_m.push_back(0.4 * std::sin(0.1 * static_cast<double>(i)));
  }
  std::array<Scene, 2> scenes;
  for (Scene& scene : scenes) {
    const auto ground = scene.add_terrain(field, {});
    const auto model = scene.add_model(signpost());
    RandomStream random(3, "posts");
    for (int i = 0; i < 40; ++i) {
      scene.add_model_object(
          model, at({random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), -0.5}), 1.0, "sign");
    }
    if (&scene == &scenes[1]) {
      scene.make_changeable(ground);
    }
    scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), {});
  }
  RandomStream random(4, "rays");
  std::array<int, 2> met{};
  for (int i = 0; i < 4000; ++i) {
    const Vector3d direction =
        Vector3d(random.gaussian(), random.gaussian(), -random.uniform(0.0, 0.4)).normalized();
    const auto whole = scenes[0].cast({0, 0, 2}, direction, 0.0, 100.0, kFixedAndMovingT0);
    const auto tiled = scenes[1].cast({0, 0, 2}, direction, 0.0, 100.0, kFixedAndMovingT0);
    ASSERT_EQ(whole.has_value(), tiled.has_value());
    if (whole) {
      EXPECT_EQ(whole->instance, tiled->instance);
      EXPECT_NEAR(whole->range_m, tiled->range_m, 1e-4);
      ++met[whole->instance == 0 ? 0 : 1];
    }
  }
  EXPECT_GT(*std::ranges::min_element(met), 100);
}

TEST(FixedAndMoving, MoreMovingThingsThanLowNumbersKeepTheirs) {
  Scene scene;
  const auto cube = scene.add_mesh(make_box("cube", {1, 1, 1}));
  const auto body = scene.add_body("train");
  constexpr std::uint32_t kWaggons = Scene::Internals::kLowNumbers + 50;
  for (std::uint32_t i = 0; i < kWaggons; ++i) {
    // By turns a fixed thing beside it: instances 2 i and 2 i + 1.
    scene.add_body_part(body, cube, at({2.0 * i, 0, 0}), {.reflectance = 0.5, .label = "waggon"});
    scene.add_object(cube, at({2.0 * i, 10, 0}), 1.0, {.reflectance = 0.2, .label = "post"});
  }
  const std::vector<BodyMotion> motion{{at({0, 3, 0}), at({0, 3, 0})}};
  scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), motion);
  for (std::uint32_t i = 0; i < kWaggons; ++i) {
    const auto waggon =
        scene.cast({2.0 * i, 0, 0}, Vector3d::UnitY(), 0.0, 50.0, kFixedAndMovingT0);
    const auto post =
        scene.cast({2.0 * i, 20, 0}, -Vector3d::UnitY(), 0.0, 50.0, kFixedAndMovingT0);
    ASSERT_TRUE(waggon && post);
    ASSERT_EQ(waggon->instance, 2 * i);
    ASSERT_EQ(post->instance, 2 * i + 1);
    ASSERT_EQ(scene.label(waggon->instance), "waggon");
  }
}

TEST(FixedAndMoving, AnEmptySceneIsEmpty) {
  Scene scene;
  scene.begin_slice(kFixedAndMovingT0, kFixedAndMovingT1, Vector3d::Zero(), {});
  EXPECT_FALSE(
      scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0, 1e4, kFixedAndMovingT0).has_value());
  EXPECT_FALSE(scene.blocked(Vector3d::Zero(), Vector3d::UnitZ(), 0.0));
}

TEST(FixedAndMoving, ModelsAndMeshesAreNotMixedUp) {
  Scene scene;
  const auto model = scene.add_model(signpost());
  const auto mesh = scene.add_mesh(make_box("cube", {2, 2, 2}));
  const auto body = scene.add_body("boom");
  EXPECT_THAT(
      [&] {
        scene.add_object(model, at({0, 0, 0}), 1.0, {});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("is a model")));
  EXPECT_THAT(
      [&] {
        scene.add_body_part(body, model, at({0, 0, 0}), {});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("is a model")));
  EXPECT_THAT(
      [&] {
        scene.add_model_object(mesh, at({0, 0, 0}), 1.0, "x");
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("plain mesh")));
  EXPECT_THAT([&] { scene.add_model({}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no part")));
}

TEST(FixedAndMoving, BodyPartsBearTheirBodysNameUnlessGivenOne) {
  Scene scene;
  const auto mesh = scene.add_mesh(make_box("cube", {2, 2, 2}));
  const auto body = scene.add_body("boom");
  EXPECT_EQ(scene.name(scene.add_body_part(body, mesh, at({0, 0, 0}), {})), "boom");
  EXPECT_EQ(scene.name(scene.add_body_part(body, mesh, at({0, 0, 0}), {}, "lamp")), "lamp");
}

}  // namespace
}  // namespace rigwire::sim
