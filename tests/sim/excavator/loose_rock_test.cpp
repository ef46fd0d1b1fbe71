// What lies loose and the bucket: it takes a rock up.
#include <gtest/gtest.h>

#include "digging_site.h"
#include "sim/contact/loose_bodies.h"
#include "sim/random.h"
#include "sim/scene/loose_rock.h"

namespace rigwire::sim::test {
namespace {

using Vector = Eigen::Vector3d;

// A rock of 170 kg is laid into the curled bucket. Lifted by 1.5 m and swung it stays in it, and
// the arm feels what it weighs.
TEST(LooseRockInABucket, IsLiftedAndSwungAndItsWeightFelt) {
  ExcavatorParameters parameters = ready_to_dig();
  parameters.initial.boom_rad = 0.35;
  parameters.initial.stick_rad = -1.2;
  parameters.initial.bucket_rad = -2.0;
  Site site(sandy(), {}, parameters);
  const auto X_WB = [&] { return site.machine.links().back().X_WL; };
  RandomStream random(3, "rock");
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  X_WR.translation() = X_WB() * Vector(0.72, 0.0, 0.1) + Vector(0.0, 0.0, 0.05);
  const LooseBody rock = loose_rock(make_rock("rock", random), X_WR, 0.3, 2650.0, "rock").body;
  site.ground.set_loose({rock});
  const auto rock_W = [&]() -> Vector { return site.ground.loose()->motion(0).X_WL.translation(); };
  const double weight = rock.mass_kg * kGravity;
  site.run(2.0, 0.0, 0.0, 0.0, 0.0);
  EXPECT_NEAR(site.machine.contact_report()->force_W.z(), -weight, 0.05 * weight);
  const Vector before = X_WB().inverse() * rock_W();
  const double low = rock_W().z();
  site.run(2.0, 0.0, 0.4, 0.0, 0.0);
  EXPECT_GT(rock_W().z(), low + 1.0);
  site.run(1.5, 0.3, 0.0, 0.0, 0.0);
  site.run(2.0, 0.0, 0.0, 0.0, 0.0);
  EXPECT_GT(rock_W().z(), low + 1.0);
  EXPECT_LT((X_WB().inverse() * rock_W() - before).norm(), 0.5) << "where it lay in the bucket";
  EXPECT_NEAR(site.machine.contact_report()->force_W.z(), -weight, 0.1 * weight);
}

}  // namespace
}  // namespace rigwire::sim::test
