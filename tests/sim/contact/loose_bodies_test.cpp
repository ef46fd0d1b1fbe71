// Rocks and crates that lie loose: they fall, slide, stack, rest, are pushed, and never gain
// energy.
#include "sim/contact/loose_bodies.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "free_body.h"
#include "sim/random.h"
#include "sim/scene/loose_rock.h"

namespace rigwire::sim {
namespace {

using Vector = Eigen::Vector3d;

SoilParameters rough(double friction) {
  SoilParameters soil;
  soil.friction = friction;
  return soil;
}

Ground slope(double angle_rad, double friction) {
  return Ground::plane({std::sin(angle_rad), 0.0, std::cos(angle_rad)}, rough(friction));
}

LooseBody crate(const std::string& name, const Vector& size_m, double mass_kg, const Vector& at) {
  LooseBody body{.name = name, .shape = ConvexShape::box(0.5 * size_m)};
  const Eigen::Array3d squares = size_m.array().square();
  body.mass_kg = mass_kg;
  body.inertia_kgm2 = mass_kg / 12.0 * (squares.sum() - squares).matrix();
  body.X_WB.translation() = at;
  return body;
}

LooseBody rock(double radius_m, const Vector& at, unsigned seed = 3) {
  RandomStream random(seed, "rock");
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = at;
  return loose_rock(make_rock("rock", random), X, radius_m, 2650.0, "rock").body;
}

void run(LooseBodies& bodies, double h, double span_s) {
  for (int i = 0; i < static_cast<int>(span_s / h); ++i) {
    (void)bodies.advance(h);
  }
}

std::vector<LooseBody> three_crates() {
  const Vector size(1.0, 0.8, 0.6);
  return {crate("lowest", size, 1000.0, {0.0, 0.0, 0.3}),
          crate("middle", size, 1000.0, {0.05, 0.02, 0.9}),
          crate("top", size, 1000.0, {-0.03, 0.0, 1.5})};
}

TEST(LooseBodies, ThreeCratesStackedRestForAnHourToTheBit) {
  const Ground ground = slope(0.0, 0.6);
  LooseBodies bodies(three_crates(), ground);
  run(bodies, 1e-3, 3.0);
  std::vector<LinkMotion> before;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    before.push_back(bodies.motion(i));
    EXPECT_TRUE(bodies.movers()[i].rests) << bodies.name(i);
    EXPECT_FALSE(bodies.moved(i));
  }
  run(bodies, 1e-3, 3600.0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(bodies.motion(i).X_WL.matrix(), before[i].X_WL.matrix());
  }
}

class LooseSteps : public testing::TestWithParam<double> {};

// What is woken again and again may not creep, either.
TEST_P(LooseSteps, AStackThatIsKeptAwakeStandsStill) {
  const double h = GetParam();
  const Ground ground = slope(0.0, 0.6);
  LooseBodies bodies(three_crates(), ground);
  run(bodies, h, 3.0);
  std::vector<Vector> before;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    before.push_back(bodies.motion(i).X_WL.translation());
  }
  for (int i = 0; i < static_cast<int>(20.0 / h); ++i) {
    bodies.ground_changed({-5.0, -5.0}, {5.0, 5.0});
    (void)bodies.advance(h);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_LT((bodies.motion(i).X_WL.translation() - before[i]).norm(), 1e-4) << i;
  }
}

TEST_P(LooseSteps, ACrateOnASlopeHoldsOrSlidesByCoulombsLaw) {
  const double h = GetParam();
  for (const double angle : {20.0 * kDegree, 40.0 * kDegree}) {
    const double friction = 0.5;
    const Ground ground = slope(angle, friction);
    LooseBody body = crate("crate", {1.0, 0.8, 0.4}, 300.0, Vector::Zero());
    body.X_WB.linear() = Eigen::AngleAxisd(angle, Vector::UnitY()).matrix();
    body.X_WB.translation() = body.X_WB.linear() * Vector(0.0, 0.0, 0.1999);
    LooseBodies bodies({body}, ground);
    run(bodies, h, 1.0);
    const double before = bodies.motion(0).v_WL_W.norm();
    run(bodies, h, 1.0);
    const double slides = kGravity_mps2 * (std::sin(angle) - friction * std::cos(angle));
    EXPECT_NEAR(bodies.motion(0).v_WL_W.norm() - before, std::max(0.0, slides), 0.03);
    EXPECT_LT(bodies.report().deepest_m, 5e-3);
  }
}

// The key had no effect on the ground: at 0.2 on soil of 0.8 a crate stood at 36 degrees.
TEST_P(LooseSteps, TheSmallerFrictionOfCrateAndSoilCounts) {
  const double h = GetParam();
  struct Surfaces {
    double crate;
    double soil;
  };
  for (const Surfaces mu : {Surfaces{0.2, 0.8}, {0.5, 0.8}, {0.8, 0.3}, {0.9, 0.5}}) {
    const double friction = std::min(mu.crate, mu.soil);
    for (const double beyond : {-2.0 * kDegree, 2.0 * kDegree}) {
      const double angle = std::atan(friction) + beyond;
      const Ground ground = slope(angle, mu.soil);
      LooseBody body = crate("crate", {1.0, 0.8, 0.4}, 300.0, Vector::Zero());
      body.friction = mu.crate;
      body.X_WB.linear() = Eigen::AngleAxisd(angle, Vector::UnitY()).matrix();
      body.X_WB.translation() = body.X_WB.linear() * Vector(0.0, 0.0, 0.1999);
      LooseBodies bodies({body}, ground);
      run(bodies, h, 1.0);
      const double before = bodies.motion(0).v_WL_W.norm();
      run(bodies, h, 1.0);
      const double slides = kGravity_mps2 * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(bodies.motion(0).v_WL_W.norm() - before, std::max(0.0, slides), 0.03)
          << mu.crate << " on " << mu.soil << ", " << beyond / kDegree;
      EXPECT_EQ(bodies.moved(0), beyond > 0.0) << mu.crate << " on " << mu.soil;
    }
  }
}

// Those that lay on more than four points went on trembling, and that gave energy.
TEST_P(LooseSteps, RocksThatTumbleDownASlopeNeverGainEnergyAndComeToRest) {
  const double h = GetParam();
  const double angle = 5.0 * kDegree;
  const Ground ground = slope(angle, 0.7);
  for (unsigned seed = 3; seed < 9; ++seed) {
    std::vector<LooseBody> rocks;
    for (unsigned i = 0; i < 6; ++i) {
      rocks.push_back(rock(0.3 + 0.05 * i, {1.4 * i, 0.1 * i, 1.2 - 0.2 * i}, seed + i));
    }
    LooseBodies bodies(rocks, ground);
    const double start = bodies.energy_j();
    double most_lost = 0.0;
    double gain = 0.0;
    for (int i = 0; i < static_cast<int>(20.0 / h); ++i) {
      (void)bodies.advance(h);
      gain = std::max(gain, most_lost - bodies.report().lost_j);
      most_lost = std::max(most_lost, bodies.report().lost_j);
    }
    EXPECT_LT(gain, 5e-4 * (start - bodies.energy_j())) << seed;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_TRUE(bodies.movers()[i].rests) << bodies.name(i) << i << " of " << seed;
      const Vector p = bodies.motion(i).X_WL.translation();
      EXPECT_GT(p.dot(Vector(std::sin(angle), 0.0, std::cos(angle))), 0.1) << "on the ground";
    }
  }
}

TEST_P(LooseSteps, AMachineAndWhatItPushesFeelTheSameForce) {
  const double h = GetParam();
  for (const double mass : {50.0, 500.0, 5000.0}) {
    for (const double stiffness : {1e6, 1e8}) {
      Ground ground = slope(0.0, 0.6);
      ground.set_loose({crate("crate", {1.0, 1.0, 1.0}, mass, {3.0, 0.1, 50.0})});
      LooseBodies& loose = *ground.loose();
      loose.gravity_mps2 = 0.0;
      const Vector half(1.0, 0.8, 0.5);
      FreeBody machine(ground, ConvexShape::box(half), 5600.0, Vector(4e3, 5e3, 6e3), stiffness,
                       5e4);
      machine.gravity_mps2 = 0.0;
      machine.X_WB.translation() << 0.0, 0.0, 50.1;
      machine.v_W.x() = 3.0;
      const Vector momentum = 5600.0 * machine.v_W;
      const double start = machine.energy_j();
      double most = 0.0;
      for (int i = 0; i < static_cast<int>(1.5 / h); ++i) {
        machine.step(h);
        most = std::max(most, machine.energy_j() + loose.energy_j());
      }
      const std::string what = std::to_string(mass) + " kg, " + std::to_string(stiffness);
      const Vector after = 5600.0 * machine.v_W + mass * loose.motion(0).v_WL_W;
      EXPECT_LT((after - momentum).norm(), 1e-6 * momentum.norm()) << what;
      EXPECT_LT(most, start * (1.0 + 1e-3)) << what;
      EXPECT_GT(loose.motion(0).v_WL_W.x(), 1.0) << what;
      EXPECT_LT(machine.contact().report().deepest_ever_m, 0.15) << what;
      EXPECT_EQ(machine.contact().report().points, 0U) << "it flies ahead";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Steps, LooseSteps, testing::Values(5e-4, 1e-3, 2e-3),
                         [](const auto& step) {
                           return "step_" + std::to_string(std::lround(1e4 * step.param)) +
                                  "_tenths_of_ms";
                         });

// A machine's room for points was that of all loose bodies together: the thirteenth fell through.
TEST(LooseBodies, FortyRocksAtOnceHaveRoomForTheirPoints) {
  const Ground ground = slope(0.0, 0.7);
  std::vector<LooseBody> rocks;
  for (unsigned i = 0; i < 40; ++i) {
    rocks.push_back(rock(0.4, {1.1 * (i % 8), 1.1 * (i / 8), 0.6}, 3 + i % 5));
  }
  LooseBodies bodies(rocks, ground);
  run(bodies, 2e-3, 3.0);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_GT(bodies.motion(i).X_WL.translation().z(), 0.1) << i;
  }
  EXPECT_LT(bodies.report().deepest_ever_m, 0.03);
}

// A pair that is far apart is looked at again when either of the two can have come near.
TEST(LooseBodies, WhatFliesAtAMachineThatStandsIsMet) {
  const auto hit = [](bool anew) {
    Ground ground = slope(0.0, 0.6);
    ground.set_loose({crate("crate", {1.0, 1.0, 1.0}, 500.0, {1.8, 0.1, 50.0})});
    LooseBodies& loose = *ground.loose();
    loose.gravity_mps2 = 0.0;
    FreeBody machine(ground, ConvexShape::box({1.0, 0.8, 0.5}), 5600.0, Vector(4e3, 5e3, 6e3), 1e6,
                     5e4);
    machine.gravity_mps2 = 0.0;
    machine.X_WB.translation() << 0.0, 0.0, 50.1;
    for (int i = 0; i < 1000; ++i) {
      if (i == 100) {
        loose.push(0, {1.8, 0.1, 50.0}, {-1000.0, 0.0, 0.0});
      }
      if (anew) {
        machine.look_anew(1);
      }
      machine.step(1e-3);
    }
    EXPECT_EQ(machine.contact().report().touches, 1U);
    EXPECT_LT(machine.v_W.x(), -0.1);
    EXPECT_LT(machine.contact().report().deepest_ever_m, 0.06);
    return machine.X_WB;
  };
  EXPECT_EQ(hit(false).matrix(), hit(true).matrix());
}

// Terrain may rise about what lies there, and scenes may sink it.
TEST(LooseBodies, WhatBeginsInTheGroundIsNotThrownOut) {
  const Ground ground = slope(0.0, 0.6);
  LooseBodies loose({crate("crate", {1.0, 0.8, 0.6}, 300.0, {0.0, 0.0, 0.2})}, ground);
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    fastest = std::max(fastest, loose.advance(1e-3));
  }
  EXPECT_LT(fastest, 0.05);
  EXPECT_NEAR(loose.motion(0).X_WL.translation().z(), 0.2, 2e-3);
  EXPECT_TRUE(loose.movers()[0].rests);
}

TEST(LooseBodies, RunsTwiceToTheSameBits) {
  const Ground ground = slope(15.0 * kDegree, 0.6);
  const auto run_once = [&] {
    std::vector<LooseBody> bodies = three_crates();
    bodies.push_back(rock(0.4, {-2.0, 0.0, 2.5}));
    LooseBodies loose(bodies, ground);
    run(loose, 1e-3, 4.0);
    std::vector<double> bits;
    for (std::size_t i = 0; i < loose.size(); ++i) {
      const Eigen::Matrix4d X = loose.motion(i).X_WL.matrix();
      bits.insert(bits.end(), X.data(), X.data() + 16);
    }
    return bits;
  };
  EXPECT_EQ(run_once(), run_once());
}

TEST(LooseBodies, WhatRestsFallsWhenTheGroundUnderItIsDug) {
  HeightField field;
  field.cell_m = 0.5;
  field.columns = field.rows = 21;
  field.origin_m = {-5.0, -5.0};
  field.heights_m.assign(field.columns * field.rows, 0.0);
  Ground ground(field, {}, {});
  ground.set_loose({crate("crate", {0.6, 0.6, 0.6}, 200.0, {0.0, 0.0, 0.31})});
  LooseBodies& loose = *ground.loose();
  loose.settle(5.0);
  ASSERT_TRUE(loose.movers()[0].rests);
  EXPECT_NEAR(loose.motion(0).X_WL.translation().z(), 0.3, 1e-3);
  for (std::size_t r = 5; r < 16; ++r) {
    for (std::size_t c = 5; c < 16; ++c) {
      ground.set_node(c, r, -1.0);
    }
  }
  run(loose, 1e-3, 3.0);
  EXPECT_TRUE(loose.movers()[0].rests);
  EXPECT_NEAR(loose.motion(0).X_WL.translation().z(), -0.7, 1e-3);
  EXPECT_TRUE(loose.moved(0));
}

TEST(LooseBodies, ARestingStackIsKnockedOverByARockThatRollsIntoIt) {
  const Ground ground = slope(0.0, 0.6);
  std::vector<LooseBody> bodies = three_crates();
  bodies.push_back(rock(0.5, {-30.0, 0.0, 0.6}));
  LooseBodies loose(bodies, ground);
  run(loose, 1e-3, 4.0);
  ASSERT_TRUE(loose.movers()[2].rests);
  // 1 t at 6 m/s.
  loose.push(3, loose.motion(3).X_WL.translation(),
             {6.0 / loose.movers()[3].inverse_mass_1pkg * 1.5, 0.0, 0.0});
  loose.push(3, loose.motion(3).X_WL.translation() + Vector(0.0, 0.0, 0.3), {1.0, 0.0, 0.0});
  run(loose, 1e-3, 15.0);
  EXPECT_TRUE(loose.moved(3));
}

TEST(LooseBodies, BadOnesAreRefusedByNameWithWhatIsAllowed) {
  const Ground ground = slope(0.0, 0.6);
  const auto refusal = [&](auto&& change) -> std::string {
    LooseBody body = crate("keg", {1.0, 1.0, 1.0}, 100.0, Vector::Zero());
    change(body);
    try {
      const LooseBodies bodies({body}, ground);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal([](LooseBody&) {}), "");
  for (const double mass : {0.0, -1.0, 1e-300, 1e9, nan, 1e300}) {
    const std::string said = refusal([&](LooseBody& body) { body.mass_kg = mass; });
    EXPECT_NE(said.find("'keg': mass, kg"), std::string::npos) << mass << ": " << said;
    EXPECT_NE(said.find("0.01 .. "), std::string::npos) << mass << ": " << said;
  }
  EXPECT_NE(refusal([&](LooseBody& b) { b.inertia_kgm2.y() = nan; }).find("inertia"),
            std::string::npos);
  EXPECT_NE(refusal([&](LooseBody& b) { b.friction = -0.1; }).find("friction"), std::string::npos);
  EXPECT_NE(refusal([&](LooseBody& b) { b.X_WB.translation().x() = nan; }).find("position"),
            std::string::npos);
  EXPECT_NE(refusal([&](LooseBody& b) { b.X_WB.linear() *= 2.0; }).find("axes"), std::string::npos);
}

// Hard cases.

Ground sandy_plain() {
  SoilParameters soil = rough(0.6);
  soil.soft = true;
  soil.cohesion_pa = 0.0;
  soil.internal_friction_rad = 30.0 * kDegree;
  soil.density_kgpm3 = 1600.0;
  return Ground::plane(Vector::UnitZ(), soil);
}

// On loose sand it sinks until the sand bears it, by the closed form: 10 t stay on top, 40 t go in.
TEST(LooseBodies, SoilBearsWhatItsStrengthAllowsAndNoMore) {
  const double weight = 1600.0 * kGravity_mps2;
  const double by_depth = weight * 18.40;        // N_q of 30 degrees.
  const double by_width = weight * 0.5 * 22.40;  // N_gamma.
  for (const double mass : {10e3, 40e3}) {
    const Ground ground = sandy_plain();
    LooseBodies loose({crate("block", {1.0, 1.0, 3.0}, mass, {0.0, 0.0, 1.501})}, ground);
    run(loose, 1e-3, 6.0);
    // Put there at once it goes on until its weight's work is done: twice as deep as it bears.
    const double sinks = 2.0 * std::max(0.0, (mass * kGravity_mps2 - by_width) / by_depth);
    EXPECT_NEAR(loose.motion(0).X_WL.translation().z(), 1.5 - sinks, 0.02 + 0.05 * sinks) << mass;
    EXPECT_LT(loose.motion(0).v_WL_W.norm(), 0.01) << mass;
    // The rest is in the springs: at most a quarter of 0.6 MN in each point of 4.5 MN/m.
    EXPECT_NEAR(loose.report().sunk_m, 1.5 - loose.motion(0).X_WL.translation().z(), 0.04) << mass;
  }
}

// A rock of 0.5 m thrown at 50 km/h against a wall of terrain and against level ground.
TEST(LooseBodies, ARockAt50KilometresAnHourNeverGivesBackMoreThanItCameWith) {
  for (const bool soft : {false, true}) {
    const Ground ground = soft ? sandy_plain() : slope(0.0, 0.6);
    LooseBodies loose({rock(0.5, {0.0, 0.0, 0.6})}, ground);
    run(loose, 1e-3, 2.0);
    const double mass = 1.0 / loose.movers()[0].inverse_mass_1pkg;
    loose.push(0, loose.motion(0).X_WL.translation(), mass * Vector(13.9, 0.0, -8.0));
    const double came = 0.5 * mass * (13.9 * 13.9 + 64.0);
    const double before = loose.energy_j();
    double most = 0.0;
    for (int i = 0; i < 10000; ++i) {
      (void)loose.advance(1e-3);
      most = std::max(most, loose.energy_j() - before);
    }
    EXPECT_LT(most, 1.001 * came) << soft;
    EXPECT_LT(loose.motion(0).v_WL_W.norm(), 0.05) << "it comes to rest";
    EXPECT_GT(loose.motion(0).X_WL.translation().z(), soft ? -0.5 : 0.1);
  }
}

TEST(LooseBodies, ACrateTipsOverAnEdgeWhenItsMiddleIsBeyondIt) {
  // It meets the terrain by points a sixth of its length apart.
  for (const double over : {-0.2, 0.05}) {
    // A step of 2 m, its edge at x = 0 to 0.1.
    HeightField field;
    field.cell_m = 0.1;
    field.columns = field.rows = 101;
    field.origin_m = {-5.0, -5.0};
    for (std::size_t r = 0; r < field.rows; ++r) {
      for (std::size_t c = 0; c < field.columns; ++c) {
        field.heights_m.push_back(c <= 50 ? 0.0 : -2.0);
      }
    }
    const Ground ground(field, {}, {});
    LooseBodies loose({crate("crate", {0.8, 0.8, 0.4}, 500.0, {0.05 + over, 0.0, 0.21})}, ground);
    run(loose, 1e-3, 5.0);
    if (over > 0.0) {
      EXPECT_LT(loose.motion(0).X_WL.translation().z(), -0.5);
    } else {
      EXPECT_NEAR(loose.motion(0).X_WL.translation().z(), 0.2, 0.02);
    }
  }
}

// A ball's worth of positions have 1e-10 m there.
TEST(LooseBodies, AThousandKilometresFromTheOriginAStackStandsAsAtIt) {
  const Ground ground = slope(0.0, 0.6);
  std::vector<LooseBody> far = three_crates();
  for (LooseBody& body : far) {
    body.X_WB.translation().x() += 1e6;
    body.X_WB.translation().y() -= 1e6;
  }
  LooseBodies loose(far, ground);
  LooseBodies at_it(three_crates(), ground);
  run(loose, 1e-3, 5.0);
  run(at_it, 1e-3, 5.0);
  for (std::size_t i = 0; i < loose.size(); ++i) {
    const Vector moved = loose.motion(i).X_WL.translation() - far[i].X_WB.translation();
    const Vector there = at_it.motion(i).X_WL.translation() - three_crates()[i].X_WB.translation();
    EXPECT_LT((moved - there).norm(), 1e-5) << i;
    EXPECT_TRUE(loose.movers()[i].rests) << i;
  }
}

// A machine of ten tonnes, the rest of which stands, comes down on a stone of 10 kg with 8.5 kJ:
// more than the soil below the stone bears.
TEST(LooseBodies, ALightStoneUnderAHeavyMachineIsPressedAndNotShotAway) {
  for (const double h : {5e-4, 1e-3, 2e-3}) {
    Ground ground = slope(0.0, 0.6);
    ground.set_loose({crate("stone", {0.2, 0.2, 0.16}, 10.0, {0.1, 0.05, 0.08})});
    LooseBodies& loose = *ground.loose();
    run(loose, 1e-3, 2.0);
    FreeBody machine(ground, ConvexShape::box({1.5, 1.0, 0.5}), 10e3, Vector(4e3, 8e3, 1e4), 1e7,
                     2e5);
    machine.X_WB.translation() << 0.0, 0.0, 0.67;
    machine.v_W.z() = -1.3;
    machine.push_W.z() = 0.97 * 10e3 * machine.gravity_mps2;
    double fastest = 0.0;
    for (int i = 0; i < static_cast<int>(2.0 / h); ++i) {
      machine.step(h);
      fastest = std::max(fastest, loose.motion(0).v_WL_W.norm());
    }
    EXPECT_LT(fastest, 2.0) << h;
    EXPECT_GT(machine.contact().report().touches, 0U) << h;
    EXPECT_LT(machine.v_W.norm(), 20.0) << h;
  }
}

TEST(LooseRock, WeighsAndTurnsAsItsMeshSays) {
  const MassProperties box = mass_properties(make_box("box", {2.0, 1.0, 0.5}));
  EXPECT_NEAR(box.volume_m3, 1.0, 1e-6);
  EXPECT_LT(box.centre_m.norm(), 1e-6);
  EXPECT_NEAR(box.inertia_m5(0, 0), (1.0 + 0.25) / 12.0, 1e-6);
  EXPECT_NEAR(box.inertia_m5(1, 1), (4.0 + 0.25) / 12.0, 1e-6);
  EXPECT_NEAR(box.inertia_m5(0, 1), 0.0, 1e-9);
  RandomStream random(1, "rock");
  const TriangleMesh mesh = make_rock("rock", random);
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();
  X_WM.linear() = Eigen::AngleAxisd(1.0, Vector(0.3, -0.5, 0.8).normalized()).matrix();
  X_WM.translation() << 5.0, -3.0, 1.0;
  const LooseRock loose = loose_rock(mesh, X_WM, 0.7, 2650.0, "stone");
  ASSERT_EQ(loose.mesh.vertices.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector was = X_WM * Vector(0.7 * mesh.vertices[i].cast<double>());
    EXPECT_LT((loose.body.X_WB * loose.mesh.vertices[i].cast<double>() - was).norm(), 1e-5);
  }
  const MassProperties own = mass_properties(loose.mesh);
  EXPECT_NEAR(loose.body.mass_kg, 2650.0 * own.volume_m3, 1e-3 * loose.body.mass_kg);
  EXPECT_LT(own.centre_m.norm(), 1e-4);
  EXPECT_LT(
      (2650.0 * own.inertia_m5 - Eigen::Matrix3d(loose.body.inertia_kgm2.asDiagonal())).norm(),
      1e-3 * loose.body.inertia_kgm2.norm());
}

}  // namespace
}  // namespace rigwire::sim
