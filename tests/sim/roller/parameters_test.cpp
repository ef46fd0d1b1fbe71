#include "sim/roller/parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace rigwire::sim {
namespace {

TEST(RollerParameters, DefaultsPass) {
  EXPECT_NO_THROW(validate(RollerParameters{}));
}

TEST(RollerParameters, RefusesEachBadNumberByName) {
  using Change = std::function<void(RollerParameters&)>;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<std::string, Change>> cases{
      {"mass", [](auto& p) { p.mass_kg = 0.0; }},
      {"yaw_inertia", [=](auto& p) { p.yaw_inertia_kgm2 = nan; }},
      {"center_of_mass_x", [](auto& p) { p.center_of_mass_x_m = 2.0; }},
      {"drum.strips", [](auto& p) { p.drum.strips = 10; }},
      {"drum.radius", [](auto& p) { p.drum.radius_m = -0.6; }},
      {"drive.engine_droop", [](auto& p) { p.drive.engine_droop = 2.0; }},
      {"front_vibration.frame_share", [](auto& p) { p.front_vibration.frame_share = 1.5; }},
      {"sprinkler.initial", [](auto& p) { p.sprinkler.initial_kg = 1e4; }},
      {"edge_cutter.press_share", [](auto& p) { p.edge_cutter.press_share = 1.0; }},
      {"step", [](auto& p) { p.step_s = 0.0; }}};
  for (const auto& [name, change] : cases) {
    RollerParameters p;
    change(p);
    try {
      validate(p);
      ADD_FAILURE() << name << " passed";
    } catch (const std::invalid_argument& refusal) {
      EXPECT_EQ(std::string(refusal.what()).find(name + ": found "), 0u) << refusal.what();
      EXPECT_NE(std::string(refusal.what()).find(", allowed "), std::string::npos);
    }
  }
}

TEST(RollerParameters, LoadMovesCentreAndInertiaAsPointMasses) {
  RollerParameters p;
  p.sprinkler.x_m = 0.0;
  const RollerMass empty = loaded_mass(p, 0.0, 0.0);
  EXPECT_EQ(empty.mass_kg, p.mass_kg);
  EXPECT_EQ(empty.yaw_inertia_kgm2, p.yaw_inertia_kgm2);
  const RollerMass full = loaded_mass(p, 0.0, 1000.0);
  EXPECT_DOUBLE_EQ(full.x_m, 1000.0 * p.spreader.x_m / (p.mass_kg + 1000.0));
  const double reduced = p.mass_kg * 1000.0 / (p.mass_kg + 1000.0);
  EXPECT_NEAR(full.yaw_inertia_kgm2, p.yaw_inertia_kgm2 + reduced * std::pow(p.spreader.x_m, 2),
              1e-9 * full.yaw_inertia_kgm2);
}

}  // namespace
}  // namespace rigwire::sim
