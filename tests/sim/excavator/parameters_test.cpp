#include "sim/excavator/parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace rigwire::sim {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::function<void(ExcavatorParameters&)>& spoil) {
  ExcavatorParameters parameters;
  spoil(parameters);
  try {
    validate(parameters);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ExcavatorParameters, DefaultsAreValid) {
  EXPECT_NO_THROW(validate(ExcavatorParameters{}));
}

TEST(ExcavatorParameters, MasslessLinksAndImpossibleInertiasAreRefused) {
  EXPECT_THAT(refusal([](auto& p) { p.stick.mass_kg = 0.0; }),
              HasSubstr("stick.mass: found 0 kg, allowed 0.01 .. 1000000 kg"));
  EXPECT_THAT(
      refusal([](auto& p) { p.boom.principal_inertia_kgm2.y() = 0.0; }),
      HasSubstr("boom.principal_inertia.1: found 0 kg m2, allowed 1e-06 .. 1000000000 kg m2"));
  EXPECT_THAT(
      refusal([](auto& p) { p.boom.principal_inertia_kgm2.x() = 9e3; }),
      HasSubstr("boom.principal_inertia.0: found 9000 kg m2, allowed at most the sum of the other "
                "two, 6550 kg m2"));
}

TEST(ExcavatorParameters, CylindersThatTheirPinsCannotReachAreRefused) {
  EXPECT_THAT(
      refusal([](auto& p) { p.boom_cylinder.length_max_m = 2.9; }),
      HasSubstr("boom_cylinder.length_max: not reachable with these pins, found 2.9 m, allowed "));
  EXPECT_THAT(
      refusal([](auto& p) { p.stick_cylinder.length_min_m = 1.0; }),
      HasSubstr("stick_cylinder.length_min: not reachable with these pins, found 1 m, allowed "));
  // 2.289209 m is the dead centre itself.
  EXPECT_THAT(
      refusal([](auto& p) { p.bucket_cylinder.length_max_m = 2.2892; }),
      HasSubstr("bucket_cylinder.length_max: not reachable with these pins, found 2.2892 m, "));
  EXPECT_EQ(refusal([](auto& p) { p.bucket_cylinder.length_max_m = 2.27; }), "accepted");
  EXPECT_THAT(refusal([](auto& p) { p.bucket_linkage.idler_length_m = 5.0; }),
              HasSubstr("bucket_cylinder.length_min: "));
}

TEST(ExcavatorParameters, DrivesTooStiffForTheStepAreRefusedWithTheStepThatWouldDo) {
  const std::string text = refusal([](auto& p) { p.drives.bucket_stiffness_npm *= 1e6; });
  EXPECT_THAT(text, HasSubstr("drives: found stiffnesses with a mode of"));
  EXPECT_THAT(text, HasSubstr("a step of at most"));
  EXPECT_EQ(refusal([](auto& p) { p.drives.bucket_stiffness_npm *= 1e4; }), "accepted");
}

TEST(ExcavatorParameters, ValuesThatAreNotNumbersAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refusal([&](auto& p) { p.boom_length_m = nan; }),
              HasSubstr("boom_length: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.drives.damping_ratio = nan; }),
              HasSubstr("drives.damping_ratio: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.initial.swing_rad = nan; }),
              HasSubstr("initial.swing: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.supply.relief_pressure_pa = nan; }),
              HasSubstr("supply.relief_pressure: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.bucket_linkage.lug_angle_rad = nan; }),
              HasSubstr("bucket_linkage.lug_angle: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.bucket_spool.flow_max_m3ps = nan; }),
              HasSubstr("bucket_spool.flow_max: found nan"));
  EXPECT_THAT(refusal([&](auto& p) { p.step_s = nan; }), HasSubstr("step: found nan"));
}

TEST(ExcavatorParameters, APoseOutsideTheStrokeIsRefused) {
  EXPECT_THAT(refusal([](auto& p) { p.initial.bucket_rad = 1.5; }),
              HasSubstr("initial.bucket: found 85.9436693 deg, allowed -138.86"));
}

TEST(ExcavatorParameters, HydraulicsOutOfRangeAreRefused) {
  EXPECT_THAT(refusal([](auto& p) { p.supply.pump_flow_m3ps = -1.0; }),
              HasSubstr("supply.pump_flow: found -60000 l/min, allowed 0.001 .. 1000000 l/min"));
  EXPECT_THAT(refusal([](auto& p) { p.stick_cylinder.rod_m = 0.2; }),
              HasSubstr("stick_cylinder.rod: found 200 mm, allowed below bore"));
  EXPECT_THAT(refusal([](auto& p) { p.boom_spool.dead_band = 0.9; }),
              HasSubstr("boom_spool.dead_band: found 0.9, allowed 0 .. 0.5"));
}

}  // namespace
}  // namespace rigwire::sim
