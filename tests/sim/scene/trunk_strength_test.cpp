#include "sim/scene/trunk_strength.h"

#include <gtest/gtest.h>

#include <array>

namespace rigwire::sim {
namespace {

struct Stem {
  double diameter_m;
  double height_m;
  double break_knm;  ///< By hand from the sources.
  double uproot_knm;
};

TEST(TrunkStrength, SpruceBearsWhatTheSourcesSay) {
  constexpr std::array<Stem, 4> kStems{{{0.10, 8.0, 3.7, 2.9},
                                        {0.20, 15.0, 30.0, 21.0},
                                        {0.30, 20.0, 101.0, 64.0},
                                        {0.45, 25.0, 340.0, 181.0}}};
  for (const Stem& stem : kStems) {
    EXPECT_NEAR(breaking_moment_nm(Wood::spruce, stem.diameter_m), 1e3 * stem.break_knm,
                0.02 * 1e3 * stem.break_knm);
    EXPECT_NEAR(uprooting_moment_nm(Wood::spruce, stem.diameter_m, stem.height_m),
                1e3 * stem.uproot_knm, 0.025 * 1e3 * stem.uproot_knm);
    Obstacle trunk;
    root(trunk, Wood::spruce, stem.diameter_m, stem.height_m);
    EXPECT_NEAR(trunk.strength_nm, 1e3 * stem.uproot_knm, 0.025 * 1e3 * stem.uproot_knm);
  }
}

TEST(TrunkStrength, PineStandsFasterThanSpruceAndBroadleafWoodIsStronger) {
  EXPECT_GT(uprooting_moment_nm(Wood::pine, 0.3, 20.0),
            uprooting_moment_nm(Wood::spruce, 0.3, 20.0));
  EXPECT_GT(breaking_moment_nm(Wood::broadleaf, 0.3), breaking_moment_nm(Wood::pine, 0.3));
}

}  // namespace
}  // namespace rigwire::sim
