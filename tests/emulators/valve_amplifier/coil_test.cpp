#include "emulators/valve_amplifier/coil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

constexpr SimTime coil_at(Duration since_start) {
  return kStart + since_start;
}

ValveCoilParameters cold_coil() {
  ValveCoilParameters parameters;
  parameters.thermal_resistance_kpw = 0.0;  // stays coil_at its surroundings
  return parameters;
}

TEST(ValveCoilTest, RisesAlongTheSupplysExponentialUntilTheSetCurrent) {
  ValveCoil coil(cold_coil());
  coil.drive(coil_at(0ms), {500.0, 24.0, false, false, 20.0});
  const double tau_s = 0.2 / 21.0;
  const double end_ma = 24.0 / 21.0 * 1e3;
  for (const Duration t : {1ms, 2ms, 4ms}) {
    EXPECT_NEAR(coil.current_ma(coil_at(t)), end_ma * (1.0 - std::exp(-to_seconds(t) / tau_s)),
                1e-9);
  }
  EXPECT_DOUBLE_EQ(coil.current_ma(coil_at(20ms)), 500.0);
}

TEST(ValveCoilTest, FallsByItsOwnTimeConstantToTheNewSetCurrent) {
  ValveCoil coil(cold_coil());
  coil.drive(coil_at(0ms), {600.0, 24.0, false, false, 20.0});
  coil.drive(coil_at(1s), {100.0, 24.0, false, false, 20.0});
  EXPECT_NEAR(coil.current_ma(coil_at(1s + 5ms)), 600.0 * std::exp(-5e-3 * 21.0 / 0.2), 1e-9);
  EXPECT_DOUBLE_EQ(coil.current_ma(coil_at(2s)), 100.0);
}

TEST(ValveCoilTest, ItsHistoryDoesNotDependOnHowOftenItIsLookedAt) {
  ValveCoil once(cold_coil());
  ValveCoil often(cold_coil());
  const CoilDrive drive{700.0, 24.0, false, false, 20.0};
  once.drive(coil_at(0ms), drive);
  for (int i = 0; i <= 60; ++i) {
    often.drive(coil_at(i * 100us), drive);
  }
  EXPECT_NEAR(once.current_ma(coil_at(6ms)), often.current_ma(coil_at(6ms)), 1e-9);
}

TEST(ValveCoilTest, AWarmCoilTakesLessThanTheSupplyCouldDriveThroughAColdOne) {
  ValveCoil coil(cold_coil());
  coil.drive(coil_at(0ms), {750.0, 18.0, false, false, 120.0});
  const double hot_ohm = 21.0 * (1.0 + 0.00393 * 100.0);
  EXPECT_NEAR(coil.greatest_ma(), 18.0 / hot_ohm * 1e3, 1e-9);
  EXPECT_NEAR(coil.current_ma(coil_at(1s)), 18.0 / hot_ohm * 1e3, 1e-6);
}

TEST(ValveCoilTest, HeatsToWhereCopperLossAndCoolingBalance) {
  const ValveCoilParameters parameters;
  ValveCoil coil(parameters);
  for (int i = 0; i <= 3600; ++i) {  // six time constants
    coil.drive(coil_at(i * 1s), {600.0, 24.0, false, false, 50.0});
  }
  // T = T0 + R_th i^2 R20 (1 + a (T - 20))
  const double c = 4.0 * 0.36 * 21.0;
  const double expected = (50.0 + c * (1.0 - 0.00393 * 20.0)) / (1.0 - 0.00393 * c);
  EXPECT_NEAR(coil.temperature_c(), expected, 0.5);
}

TEST(ValveCoilTest, DitherSwingsAroundTheMeanAndNeedsVoltage) {
  ValveCoil coil(cold_coil());
  coil.drive(coil_at(0ms), {500.0, 24.0, false, false, 20.0});
  const ValveDither dither{40.0, 100.0};
  const double left_v = 24.0 - 0.5 * 21.0;
  EXPECT_DOUBLE_EQ(coil.dither_amplitude_ma(coil_at(1s), dither), 40.0);
  EXPECT_NEAR(coil.dither_ma(coil_at(1s + 2500us), dither), 40.0, 1e-9);
  EXPECT_NEAR(coil.dither_ma(coil_at(1s + 7500us), dither), -40.0, 1e-9);
  const ValveDither fast{500.0, 400.0};
  EXPECT_NEAR(coil.dither_amplitude_ma(coil_at(1s), fast),
              left_v / (2.0 * std::numbers::pi * 400.0 * 0.2) * 1e3, 1e-9);
}

TEST(ValveCoilTest, AnOpenCoilTakesNothingAndAShortedOneWhatTheSensorCanShow) {
  ValveCoil coil(cold_coil());
  coil.drive(coil_at(0ms), {500.0, 24.0, true, false, 20.0});
  EXPECT_EQ(coil.current_ma(coil_at(1s)), 0.0);
  coil.drive(coil_at(1s), {500.0, 24.0, false, true, 20.0});
  EXPECT_EQ(coil.current_ma(coil_at(1s)), 60e3);
  coil.drive(coil_at(2s), {0.0, 24.0, false, true, 20.0});
  EXPECT_EQ(coil.current_ma(coil_at(2s)), 0.0);
}

TEST(ValveCoilTest, AbsurdSuppliesGiveNumbers) {
  ValveCoilParameters parameters;
  parameters.inductance_h = 0.0;
  for (const double volts : {0.0, 1e-9, 60.0}) {
    ValveCoil coil(parameters);
    coil.drive(coil_at(0ms), {65535.0, volts, false, false, -60.0});
    coil.drive(coil_at(10h), {65535.0, volts, false, false, 200.0});
    EXPECT_TRUE(std::isfinite(coil.current_ma(coil_at(11h))));
    EXPECT_TRUE(std::isfinite(coil.temperature_c()));
    EXPECT_GE(coil.current_ma(coil_at(11h)), 0.0);
  }
}

}  // namespace
}  // namespace rigwire::emulators
