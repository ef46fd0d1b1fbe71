#include "emulators/valve_amplifier/amplifier.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;

constexpr SimTime at(Duration since_start) {
  return kStart + since_start;
}

ValveRequest enable() {
  ValveRequest request;
  request.enable = true;
  return request;
}
ValveRequest drive(std::initializer_list<double> commands) {
  ValveRequest request = enable();
  std::size_t section = 0;
  for (const double command : commands) {
    request.command[section++] = command;
  }
  return request;
}
ValveRequest reset() {
  ValveRequest request;
  request.fault_reset = true;
  return request;
}
ValveRequest end_of_reset() {
  ValveRequest request;
  request.fault_reset = false;
  return request;
}

ValveAmplifierSettings without_watchdog() {
  ValveAmplifierSettings settings;
  settings.parameters.watchdog = 0ms;
  return settings;
}
ValveAmplifierSettings with(ValveDefect defect) {
  ValveAmplifierSettings settings = without_watchdog();
  settings.defects = {defect};
  return settings;
}
/// From an instant on, for a while or for ever.
ValveDefect defect(decltype(ValveDefect::what) what, Duration start,
                   std::optional<Duration> length = std::nullopt) {
  return {{start, length}, what};
}

ValveSample following(const ValveAmplifier& amplifier, SimTime now) {
  ValveSample sample;
  sample.time = now;
  sample.spool_position = amplifier.command().opening;
  return sample;
}

TEST(ValveAmplifierTest, EightSectionsMoveAtOnce) {
  ValveAmplifierSettings settings = without_watchdog();
  settings.sections = {"a", "b", "c", "d", "e", "f", "g", "h"};
  ValveAmplifier amplifier(settings);
  amplifier.request(at(1ms), drive({0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8}));
  EXPECT_THAT(amplifier.command().opening,
              ::testing::ElementsAre(0.1, -0.2, 0.3, -0.4, 0.5, -0.6, 0.7, -0.8));
}

TEST(ValveAmplifierTest, AFeedAtTheInstantOfExpiryIsTooLate) {
  ValveAmplifier amplifier(ValveAmplifierSettings{});
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.feed(at(200ms) - 1ns);
  EXPECT_EQ(amplifier.next_event(), at(400ms) - 1ns);
  amplifier.feed(at(400ms) - 1ns);
  EXPECT_EQ(amplifier.fault(), ValveFault::watchdog);
}

TEST(ValveAmplifierTest, AFaultThatIsDueAtTheInstantOfAResetIsResetByIt) {
  ValveAmplifier amplifier(ValveAmplifierSettings{});
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.request(at(200ms), reset());
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
  EXPECT_TRUE(amplifier.enabled());
  EXPECT_THAT(amplifier.command().opening, Each(0.0)) << "the command from before came back";
}

TEST(ValveAmplifierTest, QuickStopInTheMiddleOfARampIsNeutralAtOnceAndTheRampBeginsAnew) {
  ValveAmplifierSettings settings = without_watchdog();
  settings.parameters.stage[0].ramp_up = 1s;
  settings.parameters.stage[0].ramp_down = 1s;
  ValveAmplifier amplifier(settings);
  amplifier.request(at(0ms), drive({1.0}));
  amplifier.advance(at(400ms));
  EXPECT_NEAR(amplifier.command().opening[0], 0.4, 1e-9);
  ValveRequest stop;
  stop.quick_stop = true;
  amplifier.request(at(400ms), stop);
  EXPECT_EQ(amplifier.command().opening[0], 0.0);
  EXPECT_EQ(amplifier.next_event(), kNever);
  ValveRequest go = drive({1.0});
  go.quick_stop = false;
  amplifier.request(at(500ms), go);
  amplifier.advance(at(700ms));
  EXPECT_NEAR(amplifier.command().opening[0], 0.2, 1e-9);
}

TEST(ValveAmplifierTest, TheLossPositionIsTakenAtOnceAndKeptUntilTheReset) {
  ValveAmplifierSettings settings;
  settings.parameters.reaction = ValveReaction::position;
  settings.parameters.loss_position = 0.25;
  ValveAmplifier amplifier(settings);
  amplifier.request(at(0ms), drive({0.9, 0.1}));
  amplifier.advance(at(10s));
  EXPECT_EQ(amplifier.command().time, at(200ms));
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.25);
  EXPECT_DOUBLE_EQ(amplifier.command().opening[3], 0.25);
  amplifier.request(at(11s), reset());
  EXPECT_THAT(amplifier.command().opening, Each(0.0));
}

TEST(ValveAmplifierTest, AnOpenCoilStopsTheMachineAtOnceAndIsFault2AfterItsDelay) {
  ValveAmplifier amplifier(with(defect(OpenCoilDefect{2}, 1s)));
  amplifier.request(at(0ms), drive({0.0, 0.0, 0.6}));
  amplifier.advance(at(1s));
  EXPECT_EQ(amplifier.command().opening[2], 0.0);
  EXPECT_EQ(amplifier.set_point(2), 0.6);
  EXPECT_EQ(amplifier.current_ma(at(1s), 2), 0.0);
  amplifier.advance(at(1050ms) - 1ns);
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
  amplifier.advance(at(1050ms));
  EXPECT_EQ(amplifier.fault(), ValveFault::open_coil);
  EXPECT_EQ(amplifier.fault_section(), 2U);
}

TEST(ValveAmplifierTest, AnUndrivenOpenCoilIsNotSeen) {
  ValveAmplifier amplifier(with(defect(OpenCoilDefect{2}, 0s)));
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.advance(at(10s));
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
}

TEST(ValveAmplifierTest, AResetWhileTheCauseIsThereHoldsForOneDelay) {
  ValveAmplifier amplifier(with(defect(OpenCoilDefect{0}, 0s, 5s)));
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.advance(at(1s));
  ASSERT_EQ(amplifier.fault(), ValveFault::open_coil);
  ValveRequest again = drive({0.5});
  again.fault_reset = true;
  amplifier.request(at(2s), again);
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
  amplifier.advance(at(2050ms));
  EXPECT_EQ(amplifier.fault(), ValveFault::open_coil);
  amplifier.request(at(6s), end_of_reset());
  amplifier.request(at(6s), again);
  amplifier.advance(at(10s));
  EXPECT_EQ(amplifier.fault(), ValveFault::none) << "the cause had gone";
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.5);
}

TEST(ValveAmplifierTest, AShortedCoilIsFault3Within2ms) {
  ValveAmplifier amplifier(with(defect(ShortedCoilDefect{1}, 1s)));
  amplifier.request(at(0ms), drive({0.3, 0.3}));
  amplifier.advance(at(1s));
  EXPECT_EQ(amplifier.command().opening[1], 0.0);
  EXPECT_GT(amplifier.current_ma(at(1s), 1), 3000.0);
  amplifier.advance(at(1002ms));
  EXPECT_EQ(amplifier.fault(), ValveFault::over_current);
  EXPECT_EQ(amplifier.command().opening[0], 0.0);
}

TEST(ValveAmplifierTest, ADipOfTheSupplyIsFault4OnlyWhenItLasts) {
  ValveAmplifierSettings settings = without_watchdog();
  settings.defects = {defect(SupplyVoltageDefect{6.0}, 1s, 90ms),
                      defect(SupplyVoltageDefect{6.0}, 2s, 150ms)};
  ValveAmplifier amplifier(settings);
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.advance(at(1950ms));
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
  EXPECT_EQ(amplifier.supply_voltage_v(), 24.0);
  amplifier.advance(at(2099ms));
  EXPECT_EQ(amplifier.supply_voltage_v(), 6.0);
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
  amplifier.advance(at(2100ms));
  EXPECT_EQ(amplifier.fault(), ValveFault::under_voltage);
  EXPECT_FALSE(amplifier.fault_section());
}

TEST(ValveAmplifierTest, ALowSupplyOpensTheValveOnlyAsFarAsItsCurrentGoes) {
  // 9 V over the warm copper: about 409 mA, the current of 32 % opening.
  ValveAmplifier amplifier(with(defect(SupplyVoltageDefect{9.0}, 1s)));
  amplifier.request(at(0ms), drive({-1.0, 0.2}));
  amplifier.advance(at(1s));
  const double warm_ohm = 21.0 * (1.0 + 0.00393 * (amplifier.coil_temperature_c(0) - 20.0));
  EXPECT_NEAR(amplifier.command().opening[0], -(9.0e3 / warm_ohm - 250.0) / 500.0, 1e-9);
  EXPECT_DOUBLE_EQ(amplifier.command().opening[1], 0.2);
  EXPECT_TRUE(amplifier.at_limit());
  EXPECT_TRUE(amplifier.limited(0));
  EXPECT_FALSE(amplifier.limited(1));
}

TEST(ValveAmplifierTest, AStuckSpoolKeepsTheOpeningThatTheMachineSees) {
  ValveAmplifier amplifier(with(defect(StuckSpoolDefect{0}, 1s, 2s)));
  amplifier.request(at(0ms), drive({0.4}));
  amplifier.advance(at(1s));
  amplifier.request(at(1100ms), drive({-0.9}));
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.4);
  EXPECT_DOUBLE_EQ(amplifier.set_point(0), -0.9);
  ValveRequest off;
  off.enable = false;
  amplifier.request(at(1200ms), off);
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.4) << "not even disabling moves it";
  amplifier.advance(at(3s));
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.0);
  EXPECT_EQ(amplifier.command().time, at(3s));
}

TEST(ValveAmplifierTest, AStuckSpoolIsFault5) {
  ValveAmplifier amplifier(with(defect(StuckSpoolDefect{0}, 1s)));
  amplifier.request(at(0ms), drive({0.0}));
  amplifier.advance(at(1s));
  amplifier.request(at(1s), drive({0.8}));
  for (Duration now = 1005ms; now <= 1600ms; now += 5ms) {
    amplifier.update(following(amplifier, at(now)));
  }
  EXPECT_EQ(amplifier.fault(), ValveFault::spool_not_following);
  EXPECT_EQ(amplifier.fault_section(), 0U);
}

TEST(ValveAmplifierTest, ALostSensorAndASampleThatIsNoNumberAreFault6) {
  ValveAmplifier lost(with(defect(LostSensorDefect{3}, 1s)));
  lost.update(following(lost, at(500ms)));
  EXPECT_EQ(lost.fault(), ValveFault::none);
  lost.update(following(lost, at(1s)));
  EXPECT_EQ(lost.fault(), ValveFault::sensor);
  EXPECT_EQ(lost.fault_section(), 3U);

  ValveAmplifier amplifier(without_watchdog());
  ValveSample sample = following(amplifier, at(1s));
  sample.oil_temperature_c = std::numeric_limits<double>::quiet_NaN();
  sample.supply_pressure_pa = std::numeric_limits<double>::infinity();
  amplifier.update(sample);
  EXPECT_EQ(amplifier.fault(), ValveFault::none) << "not the positions";
  EXPECT_EQ(amplifier.measured().supply_pressure_pa, 0.0);
  sample.spool_position[1] = std::numeric_limits<double>::quiet_NaN();
  amplifier.update(sample);
  EXPECT_EQ(amplifier.fault(), ValveFault::sensor);
}

TEST(ValveAmplifierTest, AConnectorThatComesOffTakesCoilAndSensor) {
  ValveAmplifier amplifier(with(defect(ConnectorOffDefect{0}, 1s)));
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.advance(at(1s));
  EXPECT_EQ(amplifier.command().opening[0], 0.0);
  amplifier.update(following(amplifier, at(1005ms)));
  EXPECT_EQ(amplifier.fault(), ValveFault::sensor) << "sooner seen than the coil";
}

TEST(ValveAmplifierTest, TheDriverWarmsByItsLossesAndStopsAtItsLimit) {
  ValveAmplifierSettings settings = with(defect(AmbientTemperatureDefect{90.0}, 10s));
  settings.electronics.thermal_time_constant_s = 10.0;
  ValveAmplifier amplifier(settings);
  EXPECT_DOUBLE_EQ(amplifier.driver_temperature_c(), 32.0 + 4.0 * 2.0);
  amplifier.request(at(0ms), drive({1.0}));
  for (Duration now = 5ms; now < 10s; now += 5ms) {
    amplifier.update(following(amplifier, at(now)));
  }
  const double end_c = 32.0 + 4.0 * (2.0 + 0.75 * 0.75 * 0.3);
  EXPECT_NEAR(amplifier.driver_temperature_c(), end_c - (end_c - 40.0) * std::exp(-1.0), 0.01);
  for (Duration now = 10s; now < 60s; now += 5ms) {
    amplifier.update(following(amplifier, at(now)));
  }
  EXPECT_EQ(amplifier.fault(), ValveFault::over_temperature);
  amplifier.request(at(60s), reset());
  EXPECT_EQ(amplifier.fault(), ValveFault::over_temperature) << "still too hot";
}

TEST(ValveAmplifierTest, ParametersThatContradictEachOtherAreFault8UntilTheyAgree) {
  ValveAmplifier amplifier(without_watchdog());
  amplifier.request(at(0ms), drive({0.5}));
  ValveAmplifierParameters parameters = amplifier.parameters();
  parameters.dither.amplitude_ma = 300.0;  // more than the least current
  amplifier.set_parameters(at(1ms), parameters);
  EXPECT_EQ(amplifier.fault(), ValveFault::configuration);
  EXPECT_THAT(amplifier.command().opening, Each(0.0));
  amplifier.request(at(2ms), reset());
  EXPECT_EQ(amplifier.fault(), ValveFault::configuration);
  parameters.dither.amplitude_ma = 100.0;
  amplifier.set_parameters(at(3ms), parameters);
  EXPECT_EQ(amplifier.fault(), ValveFault::configuration) << "latched";
  amplifier.request(at(4ms), end_of_reset());
  amplifier.request(at(4ms), reset());
  EXPECT_EQ(amplifier.fault(), ValveFault::none);
}

TEST(ValveAmplifierTest, DitherIsInCurrentAndPositionButNotInWhatTheMachineSees) {
  ValveAmplifierSettings settings = without_watchdog();
  settings.parameters.dither = {50.0, 100.0};
  ValveAmplifier amplifier(settings);
  amplifier.request(at(0ms), drive({0.5}));
  amplifier.update(following(amplifier, at(1s)));
  double least = 1e9;
  double greatest = -1e9;
  double ripple = 0.0;
  for (int i = 0; i < 100; ++i) {
    const SimTime now = at(1s + i * 100us);
    least = std::min(least, amplifier.current_ma(now, 0));
    greatest = std::max(greatest, amplifier.current_ma(now, 0));
    ripple = std::max(ripple, std::abs(amplifier.position(now, 0) - 0.5));
  }
  EXPECT_NEAR(least, 450.0, 0.1);
  EXPECT_NEAR(greatest, 550.0, 0.1);
  // 50 mA of 500 mA span through a lag of 30 ms at 100 Hz.
  EXPECT_NEAR(ripple, 0.1 / std::hypot(1.0, 2.0 * 3.14159265 * 100.0 * 0.03), 1e-4);
  EXPECT_DOUBLE_EQ(amplifier.command().opening[0], 0.5);
  EXPECT_EQ(amplifier.command().time, at(0ms));
}

TEST(ValveAmplifierTest, CommandsThatAreNoNumbersAreLeftOutAndOthersAreHeldInRange) {
  ValveAmplifier amplifier(without_watchdog());
  amplifier.request(at(0ms), drive({0.5, 7.0, -1e300}));
  EXPECT_EQ(amplifier.command().opening[1], 1.0);
  EXPECT_EQ(amplifier.command().opening[2], -1.0);
  amplifier.request(at(1ms), drive({std::nan("")}));
  EXPECT_EQ(amplifier.command().opening[0], 0.5);
}

TEST(ValveAmplifierSettingsTest, OutOfRangeIsRefusedByName) {
  const auto expect_refused = [](auto change, const char* name) {
    ValveAmplifierSettings settings;
    change(settings);
    try {
      validate(settings);
      ADD_FAILURE() << name << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
    }
  };
  using Settings = ValveAmplifierSettings;
  expect_refused([](Settings& s) { s.coil.resistance_ohm = 0.0; }, "resistance");
  expect_refused([](Settings& s) { s.coil.inductance_h = std::nan(""); }, "inductance");
  expect_refused([](Settings& s) { s.electronics.under_voltage_v = 25.0; }, "under_voltage");
  expect_refused([](Settings& s) { s.parameters.dither.frequency_hz = 1e9; }, "dither_frequency");
  expect_refused([](Settings& s) { s.parameters.stage[7].polarity = 0.5; }, "polarity");
  expect_refused([](Settings& s) { s.parameters.stage[0].gain = -1.0; }, "gain");
  expect_refused([](Settings& s) { s.defects = {defect(OpenCoilDefect{4}, 0s)}; }, "section");
  expect_refused([](Settings& s) { s.defects = {defect(SupplyVoltageDefect{61.0}, 0s)}; },
                 "value: found 61 V, allowed 0 .. 60 V");
  expect_refused([](Settings& s) { s.defects = {defect(AmbientTemperatureDefect{201.0}, 0s)}; },
                 "value: found 201 degC, allowed -60 .. 200 degC");
  validate(Settings{});
}

}  // namespace
}  // namespace rigwire::emulators
