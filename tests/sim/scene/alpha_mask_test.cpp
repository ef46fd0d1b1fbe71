#include "sim/scene/alpha_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "sim/random.h"
#include "sim/scene/leaf_masks.h"
#include "sim/scene/scene.h"
#include "sim/scene/scene_internals.h"

namespace rigwire::sim {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr SimTime kT0 = kStart;
constexpr SimTime kT1 = kStart + std::chrono::milliseconds{1};
constexpr double kCard_m = 10.0;
constexpr double kWall_m = 3.0;
constexpr unsigned kNone = RTC_INVALID_GEOMETRY_ID;

/// A board of chess: opaque where column and row are both even or both odd.
std::shared_ptr<const AlphaMask> chess() {
  auto mask = std::make_shared<AlphaMask>();
  mask->name = "chess";
  mask->columns = 8;
  mask->rows = 8;
  for (unsigned i = 0; i < 64; ++i) {
    mask->opacity.push_back((i % 8 + i / 8) % 2 == 0 ? 255 : 0);
  }
  return mask;
}

bool opaque_field(double y_m, double z_m) {
  const auto field = [](double x) { return static_cast<int>(std::floor((x / kCard_m + 0.5) * 8)); };
  return (field(y_m) + field(z_m)) % 2 == 0;
}

/// A card square to x at x = 0 with the board on it, and a wall behind, 3 m farther.
class AlphaCard : public testing::Test {
 protected:
  AlphaCard() {
    TriangleMesh card;
    card.name = "card";
    const auto half = static_cast<float>(0.5 * kCard_m);
    card.vertices = {{0, -half, -half}, {0, half, -half}, {0, half, half}, {0, -half, half}};
    card.triangles = {{0, 1, 2}, {0, 2, 3}};
    card.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    card.alpha = chess();
    card_id = scene.add_object(scene.add_mesh(card), Isometry3d::Identity(), 1.0, {});
    Isometry3d X_WM = Isometry3d::Identity();
    X_WM.translation().x() = kWall_m + 0.5;
    wall_id = scene.add_object(scene.add_mesh(make_box("wall", {1.0, 20.0, 20.0})), X_WM, 1.0, {});
    scene.begin_slice(kT0, kT1, Vector3d::Zero(), {});
  }

  [[nodiscard]] Vector3d somewhere() {
    return {-5.0, random.uniform(-0.49, 0.49) * kCard_m, random.uniform(-0.49, 0.49) * kCard_m};
  }

  Scene scene;
  Scene::InstanceId card_id = 0;
  Scene::InstanceId wall_id = 0;
  RandomStream random{1, "card"};
};

TEST_F(AlphaCard, RaysPassHolesAndMeetWhatIsBehind) {
  for (int i = 0; i < 20000; ++i) {
    const Vector3d p = somewhere();
    const auto hit = scene.cast(p, Vector3d::UnitX(), 0.0, 100.0, kT0);
    ASSERT_TRUE(hit.has_value());
    const bool opaque = opaque_field(p.y(), p.z());
    EXPECT_EQ(hit->instance, opaque ? card_id : wall_id);
    EXPECT_NEAR(hit->range_m, opaque ? 5.0 : 5.0 + kWall_m, 1e-5);
  }
}

template <class Packet, unsigned kWidth, class Cast>
void compare_packets(const Scene::Internals& in, RandomStream& random,
                     RTCIntersectContextFlags flag, Cast&& cast) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flag;
  for (int round = 0; round < 500; ++round) {
    Packet packet{};
    alignas(64) std::array<int, kWidth> valid{};
    std::array<RTCRayHit, kWidth> single{};
    for (unsigned i = 0; i < kWidth; ++i) {
      valid[i] = random.uniform() < 0.9 ? -1 : 0;
      const Vector3d p(-5.0, random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0));
      single[i].ray = make_ray(p, Vector3d::UnitX(), 0.0, 100.0, 0.0F, Scene::kSeeEverything);
      single[i].hit.geomID = single[i].hit.instID[0] = kNone;
      packet.ray.org_x[i] = single[i].ray.org_x;
      packet.ray.org_y[i] = single[i].ray.org_y;
      packet.ray.org_z[i] = single[i].ray.org_z;
      packet.ray.dir_x[i] = 1.0F;
      packet.ray.tfar[i] = 100.0F;
      packet.ray.mask[i] = Scene::kSeeEverything;
      packet.hit.geomID[i] = packet.hit.instID[0][i] = kNone;
    }
    cast(valid.data(), in.fixed.get(), &context, &packet);
    for (unsigned i = 0; i < kWidth; ++i) {
      if (valid[i] == 0) {
        // Nobody reads them: on some processors Embree casts lanes that are switched off, too.
        continue;
      }
      rtcIntersect1(in.fixed.get(), &context, &single[i]);
      ASSERT_NE(packet.hit.instID[0][i], kNone);
      EXPECT_EQ(packet.hit.instID[0][i], single[i].hit.instID[0]);
      EXPECT_FLOAT_EQ(packet.ray.tfar[i], single[i].ray.tfar);
      const bool opaque = opaque_field(packet.ray.org_y[i], packet.ray.org_z[i]);
      EXPECT_NEAR(packet.ray.tfar[i], opaque ? 5.0 : 5.0 + kWall_m, 1e-5);
    }
  }
}

TEST_F(AlphaCard, PacketsOfAnyWidthSeeThroughTheSameHoles) {
  const Scene::Internals& in = scene.internals();
  const FlushDenormals flush;
  for (const auto flag :
       {RTC_INTERSECT_CONTEXT_FLAG_COHERENT, RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT}) {
    compare_packets<RTCRayHit4, 4>(in, random, flag, rtcIntersect4);
    compare_packets<RTCRayHit8, 8>(in, random, flag, rtcIntersect8);
    compare_packets<RTCRayHit16, 16>(in, random, flag, rtcIntersect16);
  }
}

TEST(AlphaMask, SightThroughHolesIsNotBlocked) {
  Scene scene;
  TriangleMesh card;
  card.name = "card";
  card.vertices = {{0, -5, -5}, {0, 5, -5}, {0, 5, 5}, {0, -5, 5}};
  card.triangles = {{0, 1, 2}, {0, 2, 3}};
  card.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  card.alpha = chess();
  scene.add_object(scene.add_mesh(card), Isometry3d::Identity(), 1.0, {});
  scene.begin_slice(kT0, kT1, Vector3d::Zero(), {});
  RandomStream random(2, "sight");
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p(-5.0, random.uniform(-4.9, 4.9), random.uniform(-4.9, 4.9));
    EXPECT_EQ(scene.blocked(p, Vector3d::UnitX(), 0.1), opaque_field(p.y(), p.z()));
  }
}

TEST(AlphaMask, TextureRepeatsBeyondOneAndBelowZero) {
  const auto mask = chess();
  for (const float whole : {-2.0F, -1.0F, 0.0F, 1.0F, 7.0F}) {
    EXPECT_TRUE(mask->opaque_at(whole + 0.05F, 0.05F));
    EXPECT_FALSE(mask->opaque_at(whole + 0.2F, 0.05F));
    EXPECT_FALSE(mask->opaque_at(0.05F, whole + 0.95F));
  }
  EXPECT_DOUBLE_EQ(mask->coverage(), 0.5);
}

TEST(AlphaMask, LeavesAreAboutHalfOfTheirCards) {
  for (const auto& mask : {broad_leaves(), needles()}) {
    EXPECT_NO_THROW(validate(*mask));
    EXPECT_GT(mask->coverage(), 0.35) << mask->name;
    EXPECT_LT(mask->coverage(), 0.75) << mask->name;
  }
}

TEST(AlphaMask, BadMasksAreRefused) {
  AlphaMask mask = *chess();
  mask.opacity.pop_back();
  EXPECT_THAT([&] { validate(mask); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("63 opacities for 64 texels")));
  mask.rows = 0;
  EXPECT_THAT([&] { validate(mask); }, ThrowsMessage<std::invalid_argument>(HasSubstr("8 x 0")));
  TriangleMesh mesh = make_box("box", {1, 1, 1});
  mesh.alpha = chess();
  EXPECT_THAT([&] { validate(mesh); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("0 texture coordinates")));
}

}  // namespace
}  // namespace rigwire::sim
