#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "sim/lidar/lane_array.h"
#include "sim/random.h"
#include "sim/scene/scene.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::size_t kNodes = 101;  // More than three tiles a side, the last one narrow.

HeightField rough(const Vector3d& centre_W) {
  HeightField field;
  field.cell_m = 0.4;
  field.columns = kNodes;
  field.rows = kNodes;
  field.origin_m = {centre_W.x() - 20.0, centre_W.y() - 20.0};
  RandomStream random(3, "rough");
  for (std::size_t i = 0; i < kNodes * kNodes; ++i) {
    field.heights_m.push_back(centre_W.z() + random.uniform(-0.2, 0.2));
  }
  return field;
}

NodeRectangle dig(HeightField& field) {
  const NodeRectangle hole{28, 30, 40, 66};
  for (std::size_t r = hole.first_row; r <= hole.last_row; ++r) {
    for (std::size_t c = hole.first_column; c <= hole.last_column; ++c) {
      field.heights_m[r * field.columns + c] -= 1.5;
    }
  }
  return hole;
}

void begin(Scene& scene, int ms, const Vector3d& focus = Vector3d::Zero()) {
  scene.begin_slice(kStart + milliseconds{ms}, kStart + milliseconds{ms + 10}, focus, {});
}

double down(const Scene& scene, double x, double y, double from_z = 30.0) {
  const auto hit = scene.cast({x, y, from_z}, -Vector3d::UnitZ(), 0.0, 1e3, kStart);
  return hit ? from_z - hit->range_m : std::numeric_limits<double>::quiet_NaN();
}

TEST(TerrainUpdate, RaysSeeTheHoleWhereTheHeightsHaveIt) {
  HeightField field = rough(Vector3d::Zero());
  Scene scene;
  const auto terrain = scene.add_terrain(field, {.reflectance = 0.4, .label = "pit"});
  scene.make_changeable(terrain);
  begin(scene, 0);
  scene.update_terrain(terrain, field, dig(field));
  begin(scene, 10);
  RandomStream random(4, "rays");
  for (int i = 0; i < 5000; ++i) {
    const double x = random.uniform(-19.9, 19.9);
    const double y = random.uniform(-19.9, 19.9);
    ASSERT_NEAR(down(scene, x, y), field.height_m(x, y), 5e-5) << x << ' ' << y;
  }
  const auto hit = scene.cast({-6.0, 0.0, 30.0}, -Vector3d::UnitZ(), 0.0, 1e3, kStart);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->instance, terrain);
  EXPECT_EQ(scene.material(hit->instance).label, "pit");
}

TEST(TerrainUpdate, DugManyTimesItIsMetFromAllSidesAsIfItHadBeenSoFromTheStart) {
  HeightField field = rough(Vector3d::Zero());
  Scene dug;
  const auto terrain = dug.add_terrain(field, {});
  dug.make_changeable(terrain);
  begin(dug, 0);
  for (int time = 1; time <= 20; ++time) {  // 30 m deep
    dug.update_terrain(terrain, field, dig(field));
    begin(dug, 10 * time);
  }
  Scene fresh;
  fresh.make_changeable(fresh.add_terrain(field, {}));
  begin(fresh, 0);
  RandomStream random(5, "sides");
  int met = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vector3d from(random.uniform(-19.0, 19.0), random.uniform(-19.0, 19.0),
                        random.uniform(-40.0, 5.0));
    const Vector3d along =
        Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0))
            .normalized();
    const auto expected = fresh.cast(from, along, 0.0, 1e3, kStart);
    const auto found = dug.cast(from, along, 0.0, 1e3, kStart);
    ASSERT_EQ(found.has_value(), expected.has_value()) << from.transpose();
    if (found) {
      ++met;
      ASSERT_NEAR(found->range_m, expected->range_m, 1e-4) << from.transpose();
    }
  }
  EXPECT_GT(met, 5'000);
}

TEST(TerrainUpdate, FarFromTheMapOriginAndAfterTheFocusMoved) {
  const Vector3d centre(1e6, -5e5, 300.0);
  HeightField field = rough(centre);
  Scene scene;
  const auto terrain = scene.add_terrain(field, {});
  scene.make_changeable(terrain);
  begin(scene, 0, centre);
  scene.update_terrain(terrain, field, dig(field));
  begin(scene, 10, centre);
  EXPECT_NEAR(down(scene, centre.x() - 6.03, centre.y() + 0.07, 330.0),
              field.height_m(centre.x() - 6.03, centre.y() + 0.07), 1e-3);
  begin(scene, 20, centre + Vector3d(200.0, 0.0, 0.0));  // Rebases.
  EXPECT_NEAR(down(scene, centre.x() - 6.03, centre.y() + 0.07, 330.0),
              field.height_m(centre.x() - 6.03, centre.y() + 0.07), 1e-3);
}

/// Rays as a camera has them from there: of four by two pixels beside each other.
RTCRayHit8 pixels(const Vector3d& p, const Vector3d& towards) {
  RTCRayHit8 packet{};
  const Vector3d side = towards.unitOrthogonal();
  for (std::size_t k = 0; k < kLanes; ++k) {
    const Vector3d direction = (towards + 0.002 * static_cast<double>(k % 4) * side +
                                (k < 4 ? 0.0 : 0.002) * towards.cross(side))
                                   .normalized();
    packet.ray.org_x[k] = static_cast<float>(p.x());
    packet.ray.org_y[k] = static_cast<float>(p.y());
    packet.ray.org_z[k] = static_cast<float>(p.z());
    packet.ray.dir_x[k] = static_cast<float>(direction.x());
    packet.ray.dir_y[k] = static_cast<float>(direction.y());
    packet.ray.dir_z[k] = static_cast<float>(direction.z());
    packet.ray.tnear[k] = 0.1F;
    packet.ray.tfar[k] = 100.0F;
    packet.ray.mask[k] = Scene::kSeeEverything;
    packet.hit.geomID[k] = packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
  }
  return packet;
}

TEST(TerrainUpdate, TilesShowACameraTheSameBitsAsTheWholeTerrain) {
  const HeightField field = rough(Vector3d::Zero());
  Scene whole;
  Scene tiled;
  whole.add_terrain(field, {});
  tiled.make_changeable(tiled.add_terrain(field, {}));
  begin(whole, 0);
  begin(tiled, 0);
  RandomStream random(7, "bits");
  alignas(32) std::array<int, kLanes> valid;
  valid.fill(-1);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d p(random.uniform(-10, 10), random.uniform(-10, 10), 2.5);
    const Vector3d direction =
        Vector3d(random.gaussian(), random.gaussian(), -0.2 - random.uniform(0, 1)).normalized();
    RTCRayHit8 of_whole = pixels(p - whole.internals().origin_W, direction);
    RTCRayHit8 of_tiles = of_whole;
    whole.internals().intersect(valid.data(), context, of_whole);
    tiled.internals().intersect(valid.data(), context, of_tiles);
    for (std::size_t k = 0; k < kLanes; ++k) {
      const bool met = of_whole.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID;
      ASSERT_EQ(met, of_tiles.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID);
      hits += met ? 1 : 0;
      ASSERT_EQ(of_whole.ray.tfar[k], of_tiles.ray.tfar[k]);
      ASSERT_EQ(of_whole.hit.Ng_x[k], of_tiles.hit.Ng_x[k]);
      ASSERT_EQ(of_whole.hit.Ng_y[k], of_tiles.hit.Ng_y[k]);
      ASSERT_EQ(of_whole.hit.Ng_z[k], of_tiles.hit.Ng_z[k]);
    }
    // What is not marked coherent, as lidars' rays, goes one by one, by Embree's other arithmetic.
    const auto a = whole.cast(p, direction, 0.1, 100.0, kStart);
    const auto b = tiled.cast(p, direction, 0.1, 100.0, kStart);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (a) {
      ASSERT_NEAR(a->range_m, b->range_m, 2e-5);
      ASSERT_EQ(a->instance, b->instance);
    }
  }
  EXPECT_GT(hits, 50000);
}

TEST(TerrainUpdate, NoRayLeaksBetweenTiles) {
  HeightField field = rough(Vector3d::Zero());
  Scene scene;
  const auto terrain = scene.add_terrain(field, {});
  scene.make_changeable(terrain);
  scene.update_terrain(terrain, field, dig(field));
  begin(scene, 0);
  for (std::size_t i = 1; i + 1 < kNodes; ++i) {
    const double along = -20.0 + 0.4 * static_cast<double>(i);
    for (const std::size_t border : {32u, 64u, 96u}) {
      const double across = -20.0 + 0.4 * static_cast<double>(border);
      ASSERT_FALSE(std::isnan(down(scene, across, along + 0.1)));
      ASSERT_FALSE(std::isnan(down(scene, along, across)));
    }
  }
}

TEST(TerrainUpdate, ObjectsAddedAfterwardsKeepTheirNumbers) {
  HeightField field = rough(Vector3d::Zero());
  Scene scene;
  const auto terrain = scene.add_terrain(field, {});
  scene.make_changeable(terrain);
  const auto mesh = scene.add_mesh(make_box("box", {2.0, 2.0, 2.0}));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 5.0, 5.0, 3.0;
  const auto box = scene.add_object(mesh, X, 1.0, {.reflectance = 0.9, .label = "box"});
  EXPECT_EQ(box, terrain + 1);
  const auto body = scene.add_body("boom");
  X.translation() << -5.0, 5.0, 3.0;
  const auto part = scene.add_body_part(body, mesh, X, {.reflectance = 0.1, .label = "boom"});
  const std::vector<BodyMotion> still(1);
  scene.begin_slice(kStart, kStart + milliseconds{10}, Vector3d::Zero(), still);
  const auto on_box = scene.cast({5.1, 5.1, 30.0}, -Vector3d::UnitZ(), 0.0, 1e3, kStart);
  ASSERT_TRUE(on_box.has_value());
  EXPECT_EQ(on_box->instance, box);
  const auto on_part = scene.cast({-5.1, 5.1, 30.0}, -Vector3d::UnitZ(), 0.0, 1e3, kStart);
  ASSERT_TRUE(on_part.has_value());
  EXPECT_EQ(on_part->instance, part);
  EXPECT_EQ(scene.instance_count(), 3u);
}

TEST(TerrainUpdate, WaitsForItsPeriodAndLosesNothing) {
  HeightField field = rough(Vector3d::Zero());
  const HeightField before = field;
  Scene scene;
  const auto terrain = scene.add_terrain(field, {});
  scene.make_changeable(terrain);
  scene.set_terrain_period(milliseconds{100});
  scene.update_terrain(terrain, field, dig(field));
  begin(scene, 0);  // The first is due at once.
  EXPECT_NEAR(down(scene, -6.0, 0.0), field.height_m(-6.0, 0.0), 5e-5);
  const HeightField once = field;
  scene.update_terrain(terrain, field, dig(field));
  begin(scene, 50);
  EXPECT_NEAR(down(scene, -6.0, 0.0), once.height_m(-6.0, 0.0), 5e-5);
  begin(scene, 100);
  EXPECT_NEAR(down(scene, -6.0, 0.0), field.height_m(-6.0, 0.0), 5e-5);
  EXPECT_NEAR(before.height_m(-6.0, 0.0) - down(scene, -6.0, 0.0), 3.0, 1e-4);
}

// Finding: rigs without a lidar spent four fifths of their time on placing what no ray met.
TEST(TerrainUpdate, SlicesThatNoRayLooksIntoMayBePassed) {
  const auto seen = [](bool each_slice) {
    HeightField field = rough(Vector3d::Zero());
    Scene scene;
    const auto terrain = scene.add_terrain(field, {});
    scene.make_changeable(terrain);
    scene.set_terrain_period(milliseconds{100});
    std::vector<double> ranges_m;
    // Digs in each slice, shows every second one, looks into every fifth; the focus goes far enough
    // for the rays' origin to follow it.
    for (int slice = 0; slice < 100; ++slice) {
      scene.update_terrain(terrain, field, dig(field));
      const SimTime t0 = kStart + slice * milliseconds{50};
      const Vector3d focus_W(7.0 * slice, 0.0, 0.0);
      if (const bool looks = slice % 5 == 0; looks || each_slice) {
        scene.begin_slice(t0, t0 + milliseconds{50}, focus_W, {});
        if (looks) {
          ranges_m.push_back(down(scene, -6.0, 0.0));
          ranges_m.push_back(down(scene, 3.3, 1.7));
        }
      } else {
        scene.pass_slice(t0, t0 + milliseconds{50}, focus_W);
      }
    }
    return ranges_m;
  };
  EXPECT_EQ(seen(false), seen(true)) << "to the last bit";
}

// Soil fell through a truck that no sensor looked at.
TEST(TerrainUpdate, WhatIsFixedIsThereInSlicesThatArePassed) {
  HeightField field = rough(Vector3d::Zero());
  Scene scene;
  scene.make_changeable(scene.add_terrain(field, {}));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 5.0, 5.0, 3.0;
  scene.add_object(scene.add_mesh(make_box("truck", {2.0, 2.0, 2.0})), X, 1.0, {});
  const auto below = [&](double x_m, double y_m, double far_m) {
    return scene.fixed_within({x_m, y_m, 20.0}, -Vector3d::UnitZ(), far_m);
  };
  EXPECT_FALSE(below(5.0, 5.0, 30.0)) << "before the first slice";
  scene.pass_slice(kStart, kStart + milliseconds{1}, Vector3d::Zero());
  EXPECT_TRUE(below(5.0, 5.0, 30.0));
  EXPECT_FALSE(below(5.0, 5.0, 15.9)) << "its top is 16 m below";
  EXPECT_FALSE(below(-5.0, -5.0, 30.0)) << "the terrain may be dug";
}

TEST(TerrainUpdate, APassedSliceIsRefusedWhereOneThatBeginsIs) {
  Scene scene;
  const auto pass = [&](Duration length, const Vector3d& focus_W) {
    return [&scene, length, focus_W] { scene.pass_slice(kStart, kStart + length, focus_W); };
  };
  EXPECT_THAT(pass(Duration{0}, Vector3d::Zero()),
              ThrowsMessage<std::invalid_argument>(HasSubstr("t0 < t1")));
  EXPECT_THAT(pass(milliseconds{1}, Vector3d(0.0, std::nan(""), 0.0)),
              ThrowsMessage<std::invalid_argument>(HasSubstr("finite focus")));
}

TEST(TerrainUpdate, BadChangesAreRefused) {
  HeightField field = rough(Vector3d::Zero());
  Scene scene;
  const auto terrain = scene.add_terrain(field, {});
  const auto box = scene.add_object(scene.add_mesh(make_box("box", {1.0, 1.0, 1.0})),
                                    Eigen::Isometry3d::Identity(), 1.0, {});
  EXPECT_THAT(
      [&] {
        scene.update_terrain(terrain, field, {0, 0, 1, 1});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("not made changeable")));
  EXPECT_THAT([&] { scene.make_changeable(box); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("no terrain")));
  scene.make_changeable(terrain);
  EXPECT_THAT(
      [&] {
        scene.update_terrain(terrain, field, {0, 0, kNodes, 1});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("do not lie")));
  field.heights_m[5] = std::nan("");
  EXPECT_THAT(
      [&] {
        scene.update_terrain(terrain, field, {0, 0, 8, 1});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("column 5, row 0")));
}

}  // namespace
}  // namespace rigwire::sim
