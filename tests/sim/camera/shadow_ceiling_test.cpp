// Shadow rays that are not cast: only where they would have come through.
#include "sim/camera/shadow_ceiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "camera_site.h"

namespace rigwire::sim {
namespace {

using namespace camera_test;

constexpr double kHalf_m = 40.0;

/// Waves of several lengths, as steep as 45 degrees, and a bank of 70 degrees.
HeightField rolling_ground() {
  HeightField field;
  field.cell_m = 0.5;
  field.columns = 161;
  field.rows = 141;
  field.origin_m << -kHalf_m, -35.0;
  for (std::size_t r = 0; r < field.rows; ++r) {
    for (std::size_t c = 0; c < field.columns; ++c) {
      const double x = 0.5 * static_cast<double>(c);
      const double y = 0.5 * static_cast<double>(r);
      const double bank = std::clamp(2.7 * (x - 55.0), 0.0, 4.0);
      field.heights_m.push_back(120.0 + std::sin(0.3 * x) * std::cos(0.4 * y) +
                                0.3 * std::sin(1.9 * x + y) + bank);
    }
  }
  return field;
}

struct Site {
  Scene scene;
  std::vector<BodyMotion> motions;

  explicit Site(bool changeable = false) {
    const HeightField ground = rolling_ground();
    const auto terrain = scene.add_terrain(ground, surface("sand"));
    if (changeable) {
      scene.make_changeable(terrain);
      HeightField dug = ground;
      for (std::size_t r = 50; r < 60; ++r) {
        for (std::size_t c = 70; c < 90; ++c) {
          dug.heights_m[r * dug.columns + c] -= r < 55 ? 2.0 : -1.5;
        }
      }
      scene.update_terrain(terrain, dug, {0, 0, dug.columns - 1, dug.rows - 1});
    }
    const auto post = scene.add_mesh(make_box("post", {1.0, 1.5, 6.0}));
    scene.add_object(post, at(-10.0, 4.0, 122.0, 0.7), 1.0, surface("building"));
    scene.add_object(post, at(12.0, -14.0, 123.0, 0.2, 0.5), 0.7, surface("machine"));
    const auto body = scene.add_body("boom");
    scene.add_body_part(body, post, at(0.0, 0.0, 3.0), surface("machine"));
    BodyMotion motion;
    motion.X_WB_start = at(2.0, 8.0, 122.0, 0.0, 1.2);
    motion.X_WB_end = at(5.0, 8.0, 122.0, 0.4, 0.9);
    motions.push_back(motion);
    ready();
  }

  void ready() {
    scene.begin_slice(kStart, kStart + 100ms, Eigen::Vector3d(3.0, 2.0, 121.0), motions);
  }
};

struct Found {
  int certain = 0;
  int lit = 0;
  int wrong = 0;
};

/// Points where rays from above come upon something, off the surface as pictures have them.
Found look(const Site& site, const Eigen::Vector3d& to_sun, double radius_rad) {
  ShadowCeiling ceiling;
  ceiling.prepare(site.scene.internals(), to_sun.cast<float>(), radius_rad);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-kHalf_m - 3.0, kHalf_m + 3.0);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  const Eigen::Vector3d origin = site.scene.internals().origin_W;
  const Eigen::Vector3d side = to_sun.unitOrthogonal();
  Found found;
  for (int i = 0; i < 3000; ++i) {
    RTCRay8 rays{};
    std::array<int, kLanes> active{};
    alignas(32) std::array<int, kLanes> doubtful{};
    std::array<Eigen::Vector3d, kLanes> starts;
    std::array<SimTime, kLanes> times;
    for (std::size_t k = 0; k < kLanes; ++k) {
      times[k] = kStart + std::chrono::milliseconds(random() % 100);
      const Eigen::Vector3d down =
          Eigen::Vector3d(0.5 * share(random), 0.5 * share(random), -1.0).normalized();
      const Eigen::Vector3d eye(place(random), place(random), 140.0);
      const auto hit = site.scene.cast(eye, down, 0.0, 100.0, times[k]);
      starts[k] = eye;
      if (hit) {
        starts[k] = eye + hit->range_m * down + 0.003 * hit->normal_W;
        active[k] = hit->normal_W.dot(to_sun) > 0.0 ? -1 : 0;
      }
      const Eigen::Vector3f start = (starts[k] - origin).cast<float>();
      rays.org_x[k] = start.x();
      rays.org_y[k] = start.y();
      rays.org_z[k] = start.z();
    }
    ceiling.doubt(rays, active, doubtful);
    for (std::size_t k = 0; k < kLanes; ++k) {
      if (active[k] == 0) {
        EXPECT_EQ(doubtful[k], 0);
        continue;
      }
      const double angle = std::numbers::pi * share(random);
      const Eigen::Vector3d within =
          (to_sun + radius_rad * (std::cos(angle) * side + std::sin(angle) * to_sun.cross(side)))
              .normalized();
      const bool lit = !site.scene.cast(starts[k], within, 0.0, 1e4, times[k]);
      found.lit += lit ? 1 : 0;
      found.certain += doubtful[k] == 0 ? 1 : 0;
      found.wrong += doubtful[k] == 0 && !lit ? 1 : 0;
    }
  }
  return found;
}

TEST(ShadowCeiling, WhatItHoldsForLitNothingStands) {
  for (const bool changeable : {false, true}) {
    const Site site(changeable);
    for (const double elevation_deg : {4.0, 12.0, 30.0, 50.0, 75.0, 89.9, 90.0}) {
      for (const double azimuth_deg : {0.0, 37.0, 90.0, 200.0, 315.0}) {
        for (const double radius_rad : {0.0, 0.00465}) {
          const Found found = look(site, sun_at(elevation_deg, azimuth_deg), radius_rad);
          EXPECT_EQ(found.wrong, 0) << elevation_deg << " " << azimuth_deg << " " << radius_rad;
        }
      }
    }
  }
}

TEST(ShadowCeiling, MostOfWhatIsLitIsHeldForLitWithTheSunHigh) {
  const Site site(true);
  const Found found = look(site, sun_at(55.0, 150.0), 0.0);
  EXPECT_GT(found.certain, 0.75 * found.lit);
  // Low, the waves stand in each other's light, and the ceiling is over nearly all.
  const Found low = look(site, sun_at(12.0, 150.0), 0.0);
  EXPECT_LT(low.certain, low.lit);
}

/// `camera_.render` gives the same picture with every shadow ray cast: beside a second terrain
/// nothing is certain.
TEST(ShadowCeiling, PicturesAreTheSameWithEveryRayCast) {
  Site site(true);
  Site with_all(true);
  HeightField far = level_ground({5000.0, 0.0, 0.0}, 4.0);
  with_all.scene.add_terrain(far, surface("sand"));
  with_all.ready();
  for (const double elevation_deg : {10.0, 35.0, 60.0}) {
    for (const int samples : {1, 4}) {
      const Daylight light({}, sun_at(elevation_deg, 120.0));
      CameraParameters parameters = small_camera(100.0);
      parameters.samples = samples;
      CameraRenderer camera(parameters, 1, "camera");
      const PictureJob job = job_for(parameters, at(-20.0, -10.0, 126.0, 0.4, 0.25), light);
      RenderedPicture some;
      RenderedPicture all;
      camera.render(site.scene, job, some);
      camera.render(with_all.scene, job, all);
      EXPECT_EQ(some.luminance, all.luminance) << elevation_deg << ", samples " << samples;
    }
  }
}

TEST(ShadowCeiling, TheSameRendererSeesWhatWasDugAndDrivenSince) {
  // One renderer, two states of a scene and of another one: nothing of before is kept wrongly.
  Site site(true);
  Site other(true);
  const Daylight light({}, sun_at(40.0, 120.0));
  const CameraParameters parameters = small_camera(100.0);
  const PictureJob job = job_for(parameters, at(-20.0, -10.0, 126.0, 0.4, 0.25), light);
  RenderedPicture fresh;
  RenderedPicture used;
  CameraRenderer camera(parameters, 1, "camera");
  camera.render(site.scene, job, used);
  other.motions.front().X_WB_start = other.motions.front().X_WB_end = at(-8.0, -2.0, 122.0);
  other.ready();
  camera.render(other.scene, job, used);
  CameraRenderer(parameters, 1, "camera").render(other.scene, job, fresh);
  EXPECT_EQ(used.luminance, fresh.luminance);
  site.scene.displace({1, false, 0, 0}, at(4.0, -3.0, 0.0));
  site.ready();
  camera.render(site.scene, job, used);
  CameraRenderer(parameters, 1, "camera").render(site.scene, job, fresh);
  EXPECT_EQ(used.luminance, fresh.luminance);
}

}  // namespace
}  // namespace rigwire::sim
