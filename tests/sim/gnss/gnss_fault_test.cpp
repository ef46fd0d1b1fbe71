#include "sim/gnss/gnss_fault.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

GnssFault fault(GnssFaultKind kind, Duration start, Duration duration) {
  GnssFault made;
  made.kind = kind;
  made.start = start;
  made.duration = duration;
  return made;
}

TEST(GnssFault, LastsFromItsStartToBeforeItsEnd) {
  const std::vector<GnssFault> faults{fault(GnssFaultKind::outage, 10s, 5s)};
  EXPECT_FALSE(fault_state(faults, kStart + 10s - 1ns).no_signal);
  EXPECT_TRUE(fault_state(faults, kStart + 10s).no_signal);
  EXPECT_TRUE(fault_state(faults, kStart + 15s - 1ns).no_signal);
  EXPECT_FALSE(fault_state(faults, kStart + 15s).no_signal);
}

TEST(GnssFault, OverlapsAddUpAndAShortCircuitIsReportedFirst) {
  std::vector<GnssFault> faults{
      fault(GnssFaultKind::antenna_open, 0s, 10s), fault(GnssFaultKind::antenna_short, 0s, 10s),
      fault(GnssFaultKind::jamming, 0s, 10s),      fault(GnssFaultKind::jamming, 5s, 10s),
      fault(GnssFaultKind::jump, 0s, 10s),         fault(GnssFaultKind::spoof_drift, 0s, 10s)};
  faults[2].jamming_db = 10.0;
  faults[3].jamming_db = 5.0;
  faults[4].offset_m = {1.0, 2.0, 3.0};
  faults[5].drift_mps = {0.5, 0.0, 0.0};
  faults[5].clock_drift_mps = 2.0;
  const GnssFaultState state = fault_state(faults, kStart + 6s);
  EXPECT_TRUE(state.no_signal);
  EXPECT_EQ(state.antenna, AntennaState::short_circuit);
  EXPECT_DOUBLE_EQ(state.jamming_db, 15.0);
  EXPECT_TRUE(state.spoofed);
  EXPECT_TRUE(state.offset_m.isApprox(Eigen::Vector3d(4.0, 2.0, 3.0)));
  EXPECT_DOUBLE_EQ(state.clock_offset_m, 12.0);
  EXPECT_EQ(fault_state({faults[1], faults[0]}, kStart).antenna, AntennaState::short_circuit);
}

TEST(GnssFault, RefusesWhatCannotBe) {
  EXPECT_THROW(validate(fault(GnssFaultKind::outage, -1s, 1s)), std::invalid_argument);
  EXPECT_THROW(validate(fault(GnssFaultKind::outage, 0s, 0s)), std::invalid_argument);
  GnssFault jump = fault(GnssFaultKind::jump, 0s, 1s);
  jump.offset_m.x() = std::nan("");
  EXPECT_THROW(validate(jump), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
