#include "sim/hydraulics/supply.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

namespace rigwire::sim {
namespace {

// Research case 7.
TEST(Supply, SaturatedPumpGivesExactlyItsFlowInTheRatioOfTheRequests) {
  SupplyParameters parameters;
  parameters.power_limit_w = 1e9;
  const std::array<double, 4> requests{0.004, -0.003, 0.0, 0.002};
  const double share = flow_share(parameters, requests, 20e6);
  EXPECT_NEAR((0.004 + 0.003 + 0.002) * share, parameters.pump_flow_m3ps, 1e-12);
}

TEST(Supply, PowerLimitBindsAtHighPressure) {
  const SupplyParameters parameters;
  const std::array<double, 2> requests{0.003, 0.003};
  const double share = flow_share(parameters, requests, 30e6);
  EXPECT_NEAR(30e6 * 0.006 * share, 100e3 * 0.9, 1e-6);
  EXPECT_EQ(flow_share(parameters, requests, 5e6), 1.0);
}

TEST(Supply, NoRequestNeedsNoSharing) {
  const std::array<double, 4> none{};
  EXPECT_EQ(flow_share(SupplyParameters{}, none, 0.0), 1.0);
}

TEST(Supply, PortPressuresBalanceTheForceAndNeitherFallsBelowTank) {
  for (const double force : {-3e5, -1e4, 0.0, 1e3, 4e5}) {
    const PortPressures ports = port_pressures(force, 0.0123, 0.0059, 0.3e6);
    EXPECT_NEAR(ports.a_pa * 0.0123 - ports.b_pa * 0.0059, force, 1e-9);
    EXPECT_GE(ports.a_pa, 0.3e6 - 1e-6);
    EXPECT_GE(ports.b_pa, 0.3e6 - 1e-6);
  }
}

TEST(Supply, ForceLimitsAreReliefOnOneSideAndTankOnTheOther) {
  const ForceLimits limits = force_limits(2.077e-2, 1.072e-2, 35e6, 0.3e6);
  EXPECT_NEAR(limits.greatest, 727e3 - 3.2e3, 1e3);
  EXPECT_NEAR(limits.least, -(375e3 - 6.2e3), 1e3);
}

TEST(Supply, AreasAreTheResearchTables) {
  const CylinderParameters boom{2, 0.115, 0.080, 1.49, 2.54};
  EXPECT_NEAR(boom.bottom_area_m2(), 2.077e-2, 5e-6);
  EXPECT_NEAR(boom.rod_side_area_m2(), 1.072e-2, 5e-6);
}

}  // namespace
}  // namespace rigwire::sim
