#include "sim/scene/grass.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace rigwire::sim {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

HeightField level() {
  HeightField field;
  field.origin_m = {-50.0, -50.0};
  field.cell_m = 10.0;
  field.columns = field.rows = 11;
  field.heights_m.assign(121, 0.0);
  return field;
}

GrassField reed() {
  GrassField grass;
  grass.half_lengths_m = {30.0, 30.0};
  grass.stalks_per_m2 = 40.0;
  grass.height_m = 1.0;
  grass.diameter_m = 0.02;
  grass.lean_rad = 0.0;
  grass.patch_m = 6.0;
  return grass;
}

/// Share of level rays that get farther than a length, against the exponential law.
TEST(Grass, PenetrationFollowsTheExponentialLaw) {
  const GrassField grass = reed();
  // Stalks are few: several meadows, and rays far apart in each.
  std::vector<std::unique_ptr<Scene>> meadows;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    meadows.push_back(std::make_unique<Scene>());
    add_grass(grass, level(), {}, {}, seed, *meadows.back());
    meadows.back()->begin_slice(kStart, kStart + std::chrono::milliseconds{1}, Vector3d::Zero(),
                                {});
  }
  RandomStream random(1, "rays");
  for (const double z_m : {0.2, 0.6}) {
    const double per_m = grass.stalks_per_m2 * grass.diameter_m * (1.0 - z_m / grass.height_m);
    for (const double length_m : {0.5, 1.5, 3.0}) {
      const double expected = std::exp(-per_m * length_m);
      int passed = 0;
      int cast = 0;
      for (const auto& meadow : meadows) {
        for (int i = 0; i < 1500; ++i) {
          const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
          const Vector3d p(random.uniform(-20.0, 20.0), random.uniform(-20.0, 20.0), z_m);
          const Vector3d direction(std::cos(azimuth), std::sin(azimuth), 0.0);
          passed += meadow->cast(p, direction, 0.0, length_m, kStart).has_value() ? 0 : 1;
          ++cast;
        }
      }
      // Four patches of 1440 stalks each repeat: rays are not quite independent of each other.
      const double sigma = std::sqrt(expected * (1.0 - expected) / cast) * 1.3;
      EXPECT_NEAR(static_cast<double>(passed) / cast, expected, 3.0 * sigma)
          << z_m << " m high, " << length_m << " m far";
    }
  }
}

TEST(Grass, SameSeedSameStalks) {
  RandomStream a(3, "scene/grass");
  RandomStream b(3, "scene/grass");
  RandomStream c(4, "scene/grass");
  const TriangleMesh first = make_grass_patch(reed(), a);
  EXPECT_EQ(first.vertices, make_grass_patch(reed(), b).vertices);
  EXPECT_NE(first.vertices, make_grass_patch(reed(), c).vertices);
  EXPECT_EQ(first.triangles.size(), 3U * 1440U);
}

TEST(Grass, NoStalksNoGrass) {
  GrassField grass = reed();
  grass.stalks_per_m2 = 0.0;
  Scene scene;
  add_grass(grass, level(), {}, {}, 1, scene);
  EXPECT_EQ(scene.instance_count(), 0U);
  scene.begin_slice(kStart, kStart + std::chrono::milliseconds{1}, Vector3d::Zero(), {});
  EXPECT_FALSE(scene.cast(Vector3d::Zero(), Vector3d::UnitX(), 0.0, 9.0, kStart).has_value());
}

TEST(Grass, AbsurdCountsAreRefusedWithTheLimit) {
  GrassField grass = reed();
  grass.half_lengths_m = {4000.0, 4000.0};
  grass.patch_m = 1.0;
  EXPECT_THAT([&] { validate(grass); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("patches of the field"), HasSubstr("500000"))));
  grass = reed();
  grass.stalks_per_m2 = 20000.0;
  EXPECT_THAT([&] { validate(grass); }, ThrowsMessage<std::invalid_argument>(AllOf(
                                            HasSubstr("stalks of a patch"), HasSubstr("200000"))));
}

}  // namespace
}  // namespace rigwire::sim
