#include "sim/gnss/gnss_fault.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "fields/check.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

using Faults = FaultBook<GnssFault>;

TEST(GnssFault, OverlapsAddUpAndAShortCircuitIsReportedFirst) {
  const FaultPeriod always{0s, 10s};
  const Faults faults({{always, AntennaOpenFault{}},
                       {always, AntennaShortFault{}},
                       {always, JammingFault{10.0}},
                       {{5s, 10s}, JammingFault{5.0}},
                       {always, JumpFault{{1.0, 2.0, 3.0}}},
                       {always, SpoofDriftFault{{0.5, 0.0, 0.0}, 2.0}}});
  const GnssFaultState state = fault_state(faults, kStart + 6s);
  EXPECT_TRUE(state.no_signal);
  EXPECT_EQ(state.antenna, AntennaState::short_circuit);
  EXPECT_DOUBLE_EQ(state.jamming_db, 15.0);
  EXPECT_TRUE(state.spoofed);
  EXPECT_TRUE(state.offset_m.isApprox(Eigen::Vector3d(4.0, 2.0, 3.0)));
  EXPECT_DOUBLE_EQ(state.clock_offset_m, 12.0);
  const Faults turned({{always, AntennaShortFault{}}, {always, AntennaOpenFault{}}});
  EXPECT_EQ(fault_state(turned, kStart).antenna, AntennaState::short_circuit);
}

TEST(GnssFault, DriftCountsFromItsOwnBegin) {
  const Faults faults({{{10s, 5s}, SpoofDriftFault{{1.0, 0.0, 0.0}}}});
  EXPECT_FALSE(fault_state(faults, kStart + 10s - 1ns).spoofed);
  EXPECT_EQ(fault_state(faults, kStart + 10s).offset_m.x(), 0.0);
  EXPECT_DOUBLE_EQ(fault_state(faults, kStart + 14s).offset_m.x(), 4.0);
}

TEST(GnssFault, RefusesWhatCannotBe) {
  const auto refused = [](const GnssFault& fault) {
    EXPECT_THROW(fields::check(fault), std::invalid_argument);
  };
  refused({{-1s, 1s}, OutageFault{}});
  refused({{0s, 0s}, OutageFault{}});
  refused({{0s, 1s}, JumpFault{{std::nan(""), 0.0, 0.0}}});
  refused({{0s, 1s}, JammingFault{81.0}});
}

}  // namespace
}  // namespace rigwire::sim
