// A scene's twin: the same things for rays at other instants, on other threads.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "sim/scene/height_field.h"
#include "sim/scene/scene.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

Eigen::Isometry3d scene_twin_at(double x, double y, double z) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << x, y, z;
  return X;
}

/// Level ground of 80 m scene_twin_at height 0 that can be dug, a box of 2 m scene_twin_at (10, 0),
/// and one body, a cube of 1 m.
struct Yard {
  Yard() {
    field.cell_m = 1.0;
    field.columns = field.rows = 81;
    field.origin_m = Eigen::Vector2d(-40.0, -40.0);
    field.heights_m.assign(field.columns * field.rows, 0.0);
    ground = scene.add_terrain(field, {});
    box = scene.add_object(scene.add_mesh(make_box("box", {2.0, 2.0, 2.0})),
                           scene_twin_at(10.0, 0.0, 1.0), 1.0, {});
    body = scene.add_body("cube");
    cube = scene.add_body_part(body, scene.add_mesh(make_box("cube", {1.0, 1.0, 1.0})),
                               Eigen::Isometry3d::Identity(), {});
    scene.make_changeable(ground);
  }

  /// The live scene's slice, the cube standing.
  void live(SimTime t0, const Eigen::Isometry3d& X_WB,
            const Eigen::Vector3d& focus = Eigen::Vector3d::Zero()) {
    const BodyMotion motion{X_WB, X_WB};
    scene.begin_slice(t0, t0 + 2ms, focus, {&motion, 1});
  }

  Scene scene;
  HeightField field;
  Scene::InstanceId ground = 0;
  Scene::InstanceId box = 0;
  Scene::BodyId body = 0;
  Scene::InstanceId cube = 0;
};

std::optional<SceneHit> down(const Scene& scene, double x, double y, SimTime time) {
  return scene.cast({x, y, 20.0}, -Eigen::Vector3d::UnitZ(), 0.0, 100.0, time);
}

TEST(SceneTwin, has_everything_fixed_and_its_bodies_where_it_is_told) {
  Yard yard;
  yard.live(kStart, scene_twin_at(0.0, 0.0, 0.5));
  const auto twin = yard.scene.twin();
  const BodyMotion motion{scene_twin_at(-5.0, 0.0, 0.5), scene_twin_at(-5.0, 4.0, 0.5)};
  twin->begin_slice(kStart, kStart + 100ms, yard.scene.placement(), {&motion, 1});
  yard.live(kStart + 2ms, scene_twin_at(0.0, 5.0, 0.5));

  const auto box = down(*twin, 10.0, 0.0, kStart);
  ASSERT_TRUE(box);
  EXPECT_EQ(box->instance, yard.box);
  EXPECT_NEAR(box->range_m, 18.0, 1e-5);
  const auto cube = down(*twin, -5.0, 2.0, kStart + 50ms);
  ASSERT_TRUE(cube);
  EXPECT_EQ(cube->instance, yard.cube);
  EXPECT_NEAR(cube->range_m, 19.0, 1e-5);
  EXPECT_EQ(down(*twin, 0.0, 5.0, kStart)->instance, yard.ground);
  EXPECT_EQ(down(yard.scene, 0.0, 5.0, kStart + 2ms)->instance, yard.cube);
  EXPECT_EQ(twin->name(yard.box), yard.scene.name(yard.box));
}

TEST(SceneTwin, digs_for_itself) {
  Yard yard;
  yard.live(kStart, scene_twin_at(0.0, 0.0, 0.5));
  const auto twin = yard.scene.twin();
  const NodeRectangle hole{18, 18, 22, 22};
  twin->update_terrain(yard.ground, hole, std::vector<double>(hole.nodes(), -2.0));
  const BodyMotion motion{scene_twin_at(0.0, 0.0, 0.5), scene_twin_at(0.0, 0.0, 0.5)};
  twin->begin_slice(kStart, kStart + 1ms, yard.scene.placement(), {&motion, 1});
  EXPECT_NEAR(down(*twin, -20.0, -20.0, kStart)->range_m, 22.0, 1e-5);
  EXPECT_NEAR(down(yard.scene, -20.0, -20.0, kStart)->range_m, 20.0, 1e-5);
  EXPECT_THROW(twin->update_terrain(yard.ground, hole, std::vector<double>(3, 0.0)),
               std::invalid_argument);
}

TEST(SceneTwin, keeps_what_it_casts_into_when_the_origin_moves) {
  Yard yard;
  yard.live(kStart, scene_twin_at(0.0, 0.0, 0.5));
  const auto twin = yard.scene.twin();
  const ScenePlacement before = yard.scene.placement();
  const BodyMotion motion{scene_twin_at(0.0, 0.0, 0.5), scene_twin_at(0.0, 0.0, 0.5)};
  twin->begin_slice(kStart, kStart + 1ms, before, {&motion, 1});
  // Far enough for another local origin.
  yard.live(kStart + 2ms, scene_twin_at(0.0, 0.0, 0.5), {200.0, 0.0, 0.0});
  EXPECT_NE(yard.scene.placement().fixed, before.fixed);
  EXPECT_NEAR(down(*twin, 10.0, 0.0, kStart)->range_m, 18.0, 1e-5);
  EXPECT_NEAR(down(yard.scene, 10.0, 0.0, kStart + 2ms)->range_m, 18.0, 1e-4);
  // And follows when it is told.
  twin->begin_slice(kStart, kStart + 1ms, yard.scene.placement(), {&motion, 1});
  EXPECT_NEAR(down(*twin, 10.0, 0.0, kStart)->range_m, 18.0, 1e-4);
  EXPECT_NEAR(down(*twin, -20.0, -20.0, kStart)->range_m, 20.0, 1e-4);
  EXPECT_EQ(down(*twin, 0.0, 0.0, kStart)->instance, yard.cube);
}

TEST(SceneTwin, is_cast_into_while_the_live_scene_goes_on) {
  Yard yard;
  yard.live(kStart, scene_twin_at(0.0, 0.0, 0.5));
  const auto twin = yard.scene.twin();
  std::atomic<bool> stop{false};
  std::atomic<int> wrong{0};
  ScenePlacement placement = yard.scene.placement();
  std::thread other([&] {
    for (int round = 0; !stop; ++round) {
      const double x = -5.0 - round % 7;
      const BodyMotion motion{scene_twin_at(x, 0.0, 0.5), scene_twin_at(x, 0.0, 0.5)};
      twin->begin_slice(kStart, kStart + 1ms, placement, {&motion, 1});
      for (int i = 0; i < 50; ++i) {
        const auto cube = down(*twin, x, 0.0, kStart);
        const auto box = down(*twin, 10.0, 0.0, kStart);
        wrong += !cube || cube->instance != yard.cube ? 1 : 0;
        wrong += !box || box->instance != yard.box ? 1 : 0;
      }
    }
  });
  const NodeRectangle hole{18, 18, 22, 22};
  for (int i = 1; i < 200; ++i) {
    yard.scene.update_terrain(yard.ground, hole, std::vector<double>(hole.nodes(), -0.01 * i));
    // Back and forth, so that everything fixed is placed anew each time.
    yard.live(kStart + 2ms * i, scene_twin_at(0.0, 0.0, 0.5), {i % 2 == 0 ? 0.0 : 200.0, 0.0, 0.0});
    ASSERT_NEAR(down(yard.scene, -20.0, -20.0, kStart + 2ms * i)->range_m, 20.0 + 0.01 * i, 1e-4);
  }
  stop = true;
  other.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace rigwire::sim
