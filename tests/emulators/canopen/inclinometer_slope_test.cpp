// From the specific force to the slopes of the dictionary.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "emulators/canopen/inclinometer.h"
#include "inclinometer_rig.h"

namespace rigwire::emulators {
namespace {

using protocols::canopen::SdoAbort;

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

std::uint32_t inclinometer_slope_code(SdoAbort abort) {
  return static_cast<std::uint32_t>(abort);
}

InclinometerSettings with_quadrants(std::uint8_t quadrants) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.quadrants = quadrants;
  return settings;
}

TEST(Inclinometer, SlopesAreTheAnglesOfTheAxesToTheHorizontal) {
  InclinometerRig rig;
  rig.boot();
  for (int pitch = -90; pitch <= 90; pitch += 15) {
    for (int roll = -90; roll <= 90; roll += 15) {
      rig.tilt(pitch * kDegree, roll * kDegree);
      rig.measure();
      const double lateral =
          std::asin(std::cos(pitch * kDegree) * std::sin(roll * kDegree)) / kDegree;
      EXPECT_EQ(rig.slope16(0x6010), 100 * pitch) << pitch << ' ' << roll;
      EXPECT_NEAR(rig.slope16(0x6020), 100.0 * lateral, 0.5 + 1e-6) << pitch << ' ' << roll;
    }
  }
}

TEST(Inclinometer, RoundsToTheNearestCountOfEachResolution) {
  InclinometerRig rig;
  rig.boot();
  rig.tilt(12.3456 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 1235);
  EXPECT_EQ(rig.write(0x6000, 0, 1, 2), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 12346);
  EXPECT_EQ(rig.write(0x6000, 0, 100, 2), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 123);
  EXPECT_EQ(rig.write(0x6000, 0, 1000, 2), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 12);
  EXPECT_EQ(rig.write(0x6000, 0, 20, 2), inclinometer_slope_code(SdoAbort::value_range));
  EXPECT_EQ(rig.write(0x6000, 0, 0, 2), inclinometer_slope_code(SdoAbort::value_too_low));
  EXPECT_EQ(rig.write(0x6000, 0, 1001, 2), inclinometer_slope_code(SdoAbort::value_too_high));
  EXPECT_EQ(rig.slope16(0x6010), 12);
}

/// The 16-bit value ends at 32.767 deg of a thousandth each; the 32-bit one goes on.
TEST(Inclinometer, SixteenBitsSaturateAndThirtyTwoCarryTheFullResolution) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.resolution_mdeg = 1;
  InclinometerRig rig(settings);
  rig.boot();
  rig.tilt(60.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 32767);
  EXPECT_EQ(rig.slope32(0x6110), 60000);
  rig.tilt(-60.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), -32768);
  EXPECT_EQ(rig.slope32(0x6110), -60000);
  EXPECT_TRUE(rig.output.with_id(0xA0).empty());
}

TEST(Inclinometer, AccelerationTiltsIt) {
  InclinometerRig rig;
  rig.boot();
  rig.force = {0.1 * kGravity_mps2, 0.0, kGravity_mps2};
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), std::lround(100.0 * std::atan(0.1) / kDegree));
  rig.force = {0.0, -kGravity_mps2, kGravity_mps2};
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 0);
  EXPECT_EQ(rig.slope16(0x6020), -4500);
}

TEST(Inclinometer, QuadrantCorrectionTellsTheBackFromTheFront) {
  InclinometerRig off;
  InclinometerRig half(with_quadrants(1));
  InclinometerRig full(with_quadrants(2));
  struct Case {
    int pitch;
    int without;
    int half;
    int full;
  };
  for (const Case& c : {Case{0, 0, 0, 0}, Case{30, 30, 30, 30}, Case{90, 90, 90, 90},
                        Case{120, 60, 120, 120}, Case{180, 0, 180, 180}, Case{-30, -30, -30, 330},
                        Case{-120, -60, -120, 240}, Case{-90, -90, -90, 270}}) {
    for (InclinometerRig* rig : {&off, &half, &full}) {
      rig->boot();
      rig->tilt(c.pitch * kDegree, 0.0);
      rig->measure();
    }
    EXPECT_EQ(off.slope32(0x6110), 100 * c.without) << c.pitch;
    EXPECT_EQ(half.slope32(0x6110), 100 * c.half) << c.pitch;
    EXPECT_EQ(full.slope32(0x6110), 100 * c.full) << c.pitch;
  }
  // Upside down about x: the lateral slope counts on, and so does the longitudinal one.
  half.force = {0.0, 0.0, -kGravity_mps2};
  half.measure();
  EXPECT_EQ(half.slope16(0x6010), 18000);
  EXPECT_EQ(half.slope16(0x6020), 18000);
  EXPECT_EQ(half.write(0x2040, 0, 0, 1), 0U);
  EXPECT_EQ(half.slope16(0x6020), 0);
  EXPECT_EQ(half.write(0x2040, 0, 3, 1), inclinometer_slope_code(SdoAbort::value_too_high));
}

/// A quarter of a count below a whole turn is 0 again, and 36000 does not fit into 16 bits.
TEST(Inclinometer, CountedThroughItWrapsAtTheTurnAndSaturatesIn16Bits) {
  InclinometerRig rig(with_quadrants(2));
  rig.boot();
  rig.tilt(-0.0025 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope32(0x6110), 0);
  rig.tilt(-10.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.slope32(0x6110), 35000);
  EXPECT_EQ(rig.slope16(0x6010), 32767);
  EXPECT_EQ(rig.write(0x6000, 0, 100, 2), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 3500);
  EXPECT_EQ(rig.write(0x6011, 0, 1, 1), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 100);
}

TEST(Inclinometer, FilterFollowsTheClosedFormOfItsCutOff) {
  const double cut_offs_hz[] = {10.0, 5.0, 1.0, 0.5};
  for (std::uint8_t step = 1; step <= 4; ++step) {
    InclinometerSettings settings = InclinometerRig::settings();
    settings.filter_step = step;
    settings.resolution_mdeg = 1;
    InclinometerRig rig(settings);
    rig.boot();
    // The force steps from "up" by (g, 0, 0) at the next sample.
    rig.force = {kGravity_mps2, 0.0, kGravity_mps2};
    for (int sample = 0; sample < 100; ++sample) {
      rig.measure();
      const double passed_s = 5e-3 * sample;
      const double share =
          1.0 - std::exp(-2.0 * std::numbers::pi * cut_offs_hz[step - 1] * passed_s);
      EXPECT_NEAR(rig.slope32(0x6110), 1000.0 * std::atan(share) / kDegree, 0.5 + 1e-6)
          << int{step} << ' ' << sample;
    }
  }
}

/// What the filter has forgotten depends on the time, not on the number of samples.
TEST(Inclinometer, FilterIsTheSameAtEachSampling) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.filter_step = 3;
  settings.resolution_mdeg = 1;
  InclinometerRig fine(settings);
  settings.sampling = 100ms;
  InclinometerRig coarse(settings);
  for (InclinometerRig* rig : {&fine, &coarse}) {
    rig->boot();
    rig->force = {kGravity_mps2, 0.0, kGravity_mps2};
    rig->feed(rig->now);
    rig->run(400ms);
  }
  EXPECT_NEAR(fine.slope32(0x6110), coarse.slope32(0x6110), 1);
  EXPECT_GT(fine.slope32(0x6110), 40000);
}

TEST(Inclinometer, FilterStepChangesAtOnceAndWithoutAJump) {
  InclinometerRig rig;
  rig.boot();
  rig.tilt(20.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.write(0x2043, 0, 4, 1), 0U);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 2000);
  rig.tilt(0.0, 0.0);
  rig.run(20ms);
  EXPECT_GT(rig.slope16(0x6010), 1800);
  EXPECT_EQ(rig.write(0x2043, 0, 0, 1), 0U);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 0);
  EXPECT_EQ(rig.write(0x2043, 0, 5, 1), inclinometer_slope_code(SdoAbort::value_too_high));
}

TEST(Inclinometer, InversionAndOffsetsAsTheOperatingParameterSays) {
  InclinometerRig rig;
  rig.boot();
  rig.tilt(10.0 * kDegree, 5.0 * kDegree);
  rig.measure();
  const int lateral = rig.slope16(0x6020);
  EXPECT_EQ(rig.write(0x6013, 0, 300, 2), 0U);
  EXPECT_EQ(rig.write(0x6014, 0, 40, 2), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 1000);  // not in force yet
  EXPECT_EQ(rig.write(0x6011, 0, 1, 1), 0U);
  EXPECT_EQ(rig.slope16(0x6010), -1000);
  EXPECT_EQ(rig.write(0x6011, 0, 2, 1), 0U);
  EXPECT_EQ(rig.slope16(0x6010), 1340);
  EXPECT_EQ(rig.write(0x6011, 0, 3, 1), 0U);
  EXPECT_EQ(rig.slope16(0x6010), -660);
  EXPECT_EQ(rig.write(0x6011, 0, 4, 1), inclinometer_slope_code(SdoAbort::value_too_high));
  // The other slopes have parameters of their own.
  EXPECT_EQ(rig.slope16(0x6020), lateral);
  EXPECT_EQ(rig.slope32(0x6110), 1000);
  EXPECT_EQ(rig.write(0x6121, 0, 1, 1), 0U);
  EXPECT_EQ(rig.slope32(0x6120), -lateral);
  EXPECT_EQ(rig.slope16(0x6020), lateral);
}

TEST(Inclinometer, PresetMakesTheSlopeThatValueByItsOffset) {
  for (const auto& objects : protocols::canopen::kSlopes) {
    for (const unsigned operation : {2U, 3U}) {
      InclinometerRig rig;
      rig.boot();
      rig.tilt(10.0 * kDegree, 0.0);
      rig.force.y = rig.force.x;
      rig.measure();
      const bool wide = objects.type == protocols::canopen::DataType::integer32;
      const std::size_t bytes = wide ? 4 : 2;
      const auto at = [&](std::uint16_t part) { return objects.address(part).index; };
      const auto slope = [&] { return wide ? rig.slope32(at(0)) : rig.slope16(at(0)); };
      const int measured = operation == 3U ? -slope() : slope();
      EXPECT_EQ(rig.write(at(4), 0, 50, bytes), 0U);
      EXPECT_EQ(rig.write(at(2), 0, 700, bytes), 0U);
      EXPECT_EQ(rig.write(at(1), 0, operation, 1), 0U);
      EXPECT_EQ(slope(), operation == 3U ? 700 + 2 * measured : 700);
      // Set again with the inversion in force.
      EXPECT_EQ(rig.write(at(2), 0, 700, bytes), 0U);
      EXPECT_EQ(slope(), 700);
      EXPECT_EQ(wide ? rig.slope32(at(3)) : rig.slope16(at(3)), 700 - measured - 50);
    }
  }
}

TEST(Inclinometer, PresetWhoseOffsetDoesNotFitIsRefused) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.resolution_mdeg = 1;
  InclinometerRig rig(settings);
  rig.boot();
  rig.tilt(30.0 * kDegree, 0.0);
  rig.measure();
  EXPECT_EQ(rig.write(0x6012, 0, 0x10000 - 10000, 2),
            inclinometer_slope_code(SdoAbort::value_too_low));
  EXPECT_EQ(rig.write(0x6011, 0, 1, 1), 0U);
  EXPECT_EQ(rig.write(0x6012, 0, 10000, 2), inclinometer_slope_code(SdoAbort::value_too_high));
  EXPECT_EQ(rig.slope16(0x6013), 0);
  EXPECT_EQ(rig.slope16(0x6012), 0);
}

TEST(Inclinometer, SampleThatIsNoNumberDoesNotReachTheFilter) {
  for (int component = 0; component < 3; ++component) {
    InclinometerSettings settings = InclinometerRig::settings();
    settings.filter_step = 2;
    InclinometerRig rig(settings);
    rig.tilt(7.0 * kDegree, 0.0);
    rig.boot();
    const Vector3 well = rig.force;
    (component == 0 ? rig.force.x : component == 1 ? rig.force.y : rig.force.z) = kNoNumber;
    rig.measure();
    EXPECT_EQ(rig.slope16(0x6010), 700);
    EXPECT_EQ(rig.read(0x1001), 1U);
    rig.force = well;
    rig.measure();
    EXPECT_EQ(rig.slope16(0x6010), 700);
    EXPECT_EQ(rig.read(0x1001), 0U);
  }
}

TEST(Inclinometer, HugeForcesLeaveNothingBehind) {
  InclinometerSettings settings = InclinometerRig::settings();
  settings.filter_step = 1;
  InclinometerRig rig(settings);
  rig.boot();
  const double most = std::numeric_limits<double>::max();
  for (const double x : {most, -most, most}) {
    rig.force = {x, most, -most};
    rig.measure();
  }
  rig.tilt(7.0 * kDegree, 0.0);
  EXPECT_EQ(rig.write(0x2043, 0, 0, 1), 0U);
  rig.measure();
  EXPECT_EQ(rig.slope16(0x6010), 700);
  EXPECT_EQ(rig.read(0x1001), 0U);
}

}  // namespace
}  // namespace rigwire::emulators
