// The proof of the carrier phase: RTKLIB resolves whole-cycle ambiguities between two of our
// receivers, each with a clock of its own, and finds the baseline to the millimetre.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "recorded_receiver.h"

namespace rigwire::sim {
namespace {

TEST(RelativePositionTest, AmbiguitiesAreWholeAndTheBaselineIsTheTruth) {
  const std::array kRelativePositionGps{GnssSystem::gps};
  const auto constellation = make_nominal_constellation(kRelativePositionGps);
  // Over a change of the broadcast at 10:00:00 GPS and several resets of either clock.
  const Calendar calendar(UtcTime{2024, 6, 1, 9, 57, 0, 0});
  const LocalFrame frame(LocalFrameParameters{});
  const auto rest = [](double) { return AntennaMotion{{0.0, 0.0, 3.0}, Eigen::Vector3d::Zero()}; };
  const auto drive = [](double t) {
    const double angle = 0.05 * t;
    return AntennaMotion{{400.0 + 60.0 * std::cos(angle), 60.0 * std::sin(angle), 2.0},
                         3.0 * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0)};
  };
  const Recording base = record(*constellation, calendar, frame,
                                ReceiverClock({.drift = 4e-6}, 1, "base"), 400, true, rest);
  const Recording rover = record(*constellation, calendar, frame,
                                 ReceiverClock({.drift = -5e-6}, 2, "rover"), 400, true, drive);
  RtklibRun rtklib("relative");
  rtklib.file("rover.obs", rover.observations);
  rtklib.file("base.obs", base.observations);
  rtklib.file("both.nav", rover.navigation);
  const Eigen::Vector3d& at = base.truth.front().position_E_m;
  std::array<char, 256> reference{};
  std::snprintf(reference.data(), reference.size(),
                "ant2-postype=xyz\nant2-pos1=%.4f\nant2-pos2=%.4f\nant2-pos3=%.4f\n", at.x(),
                at.y(), at.z());
  const auto fixes = rtklib.solve(
      "pos1-posmode=kinematic\npos1-frequency=l1\npos1-ionoopt=brdc\npos1-tropopt=saas\n"
      "pos2-armode=continuous\n" +
      std::string(reference.data()));
  ASSERT_TRUE(fixes);
  ASSERT_EQ(fixes->size(), rover.truth.size());
  std::size_t fixed = 0;
  for (const ClientFix& fix : *fixes) {
    const RecordedTruth* truth = truth_of(rover, fix);
    ASSERT_NE(truth, nullptr);
    if (fix.quality == 1) {
      ++fixed;
      EXPECT_LT((fix.position_E_m - truth->position_E_m).norm(), 0.005) << fix.time_ns;
    }
  }
  EXPECT_GT(fixed, fixes->size() * 9 / 10);
}

}  // namespace
}  // namespace rigwire::sim
