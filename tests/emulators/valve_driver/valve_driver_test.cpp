#include "emulators/valve_driver/valve_driver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>

#include "valve_driver_fixture.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;
namespace reg = valve_registers;
using reg::FaultCode;
using ::testing::DoubleNear;
using ::testing::Each;

constexpr SimTime at(Duration since_start) {
  return kStart + since_start;
}

TEST_F(ValveDriverTest, WakesUpNeutralReadyAndDisabled) {
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  EXPECT_THAT(driver_.command().floating, Each(false));
  EXPECT_EQ(input(kStart, reg::kStatus), reg::kStatusReady);
  EXPECT_EQ(holding(kStart, reg::kWatchdog), 200);
  EXPECT_EQ(driver_.next_event(), kNever);
  EXPECT_EQ(driver_.sample_plan(), (SamplePlan{kStart, 5ms}));
}

TEST_F(ValveDriverTest, CommandsReachTheOutputAtTheInstantOfTheRequest) {
  EXPECT_EQ(write(at(7ms), 0, {1, 250, -1000, 0, 1000}), done(0, 5));
  EXPECT_DOUBLE_EQ(opening(0), 0.25);
  EXPECT_DOUBLE_EQ(opening(1), -1.0);
  EXPECT_DOUBLE_EQ(opening(2), 0.0);
  EXPECT_DOUBLE_EQ(opening(3), 1.0);
  EXPECT_EQ(driver_.command().time, at(7ms));
  EXPECT_EQ(input(at(8ms), reg::kStatus),
            reg::kStatusReady | reg::kStatusEnabled | reg::kStatusAtLimit);
}

TEST_F(ValveDriverTest, ACommandOutOfRangeIsRefusedAndNothingOfTheRequestHappens) {
  write(kStart, 0, {1, 100, 100, 100, 100});
  for (const int bad : {1001, -1001, 32767, -32768}) {
    EXPECT_EQ(write(at(1ms), 0, {0, 200, 200, bad, 200}),
              refused(ExceptionCode::illegal_data_value));
    EXPECT_EQ(ask(at(1ms), WriteRegister{1, static_cast<std::uint16_t>(bad)}),
              refused(ExceptionCode::illegal_data_value, 6));
  }
  EXPECT_THAT(read(at(2ms), RegisterTable::holding, 0, 5),
              ::testing::ElementsAre(1, 100, 100, 100, 100));
  EXPECT_DOUBLE_EQ(opening(0), 0.1);
  EXPECT_EQ(driver_.command().time, kStart);
}

TEST_F(ValveDriverTest, SectionsThatAreNotFittedTakeOnlyZero) {
  EXPECT_EQ(write(kStart, 0, {1, 0, 0, 0, 0, 0, 0, 0, 0, 1}), done(0, 10));
  EXPECT_EQ(write(kStart, 5, {1}), refused(ExceptionCode::illegal_data_value));
  EXPECT_EQ(write(kStart, 20 + 6 * 4, {0}), refused(ExceptionCode::illegal_data_address));
}

TEST_F(ValveDriverTest, ACommandWrittenWhileDisabledHasNoEffectEvenLater) {
  EXPECT_EQ(write(kStart, 1, {500}), done(1, 1));
  EXPECT_EQ(holding(kStart, 1), 500);
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  write(at(1ms), 0, {1});
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
  EXPECT_EQ(holding(at(1ms), 1), 0);
  write(at(2ms), 1, {500});
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
}

TEST_F(ValveDriverTest, DisablingGoesToNeutral) {
  write(kStart, 0, {1, 500});
  write(at(1ms), 0, {0});
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  EXPECT_EQ(driver_.command().time, at(1ms));
  EXPECT_EQ(driver_.next_event(), kNever) << "the watchdog runs only while enabled";
}

TEST_F(ValveDriverTest, WithoutSupplyItHearsNothingAndAfterItIsAsDelivered) {
  driver_.supply().begin({{10ms, 20ms}, NoSupplyFault{}});
  write(kStart, 0, {1, 500});
  write(kStart, reg::kWatchdog, {1000});
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  driver_.advance(at(10ms));
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  EXPECT_EQ(driver_.command().time, at(10ms));
  const std::size_t answers = output_.sent.size();
  server_.receive(at(15ms), 1, adu_of(WriteRegister{1, 100}, 1, 1));
  EXPECT_EQ(output_.sent.size(), answers) << "it is dead";
  EXPECT_EQ(input(at(30ms), reg::kStatus), reg::kStatusReady);
  EXPECT_EQ(holding(at(30ms), 0), 0);
  EXPECT_EQ(holding(at(30ms), 1), 0);
  EXPECT_EQ(holding(at(30ms), reg::kWatchdog), 200);
  write(at(31ms), 0, {1, 250});
  EXPECT_DOUBLE_EQ(opening(0), 0.25);
}

TEST_F(ValveDriverTest, AFaultThatWasLatchedDoesNotOutliveTheSupply) {
  write(kStart, 0, {1, 500});
  driver_.advance(at(1s));
  EXPECT_EQ(driver_.fault(), ValveFault::watchdog);
  driver_.supply().begin({{1100ms, 20ms}, NoSupplyFault{}});
  EXPECT_EQ(input(at(1200ms), reg::kStatus), reg::kStatusReady);
}

ValveSample sample_at(SimTime time) {
  ValveSample sample;
  sample.time = time;
  sample.spool_position = {0.25, -0.5, 1.0, -1.0, 0, 0, 0, 0};
  sample.port_a_pressure_pa = {1e7, 2.5e7, 0, 1e5, 0, 0, 0, 0};
  sample.port_b_pressure_pa = {5e6, 0, 3e7, 1.234e5, 0, 0, 0, 0};
  sample.supply_pressure_pa = 2.8e7;
  sample.swing_angle_rad = -std::numbers::pi;
  sample.swing_rate_radps = 0.5;
  sample.oil_temperature_c = -12.34;
  return sample;
}

TEST_F(ValveDriverTest, MeasurementsAreReadWithinOneCount) {
  driver_.update(sample_at(at(5ms)));
  const auto in = read(at(5ms), RegisterTable::input, 0, reg::kInputEnd);
  const auto s = [&](std::size_t i) { return static_cast<std::int16_t>(in[i]); };
  EXPECT_EQ(s(2), 250);
  EXPECT_EQ(s(3), -500);
  EXPECT_EQ(s(4), 1000);
  EXPECT_EQ(s(5), -1000);
  EXPECT_EQ(in[reg::kSupplyVoltage], 2400);
  EXPECT_EQ(in[reg::kDriverTemperature], 400);
  const auto angle = static_cast<std::int32_t>((std::uint32_t{in[30]} << 16U) | in[31]);
  EXPECT_EQ(angle, -180000);
  EXPECT_EQ(s(32), 2865);  // 28.6479 deg/s
  EXPECT_EQ(in[33], 1);
  EXPECT_EQ(in[40], 1000);
  EXPECT_EQ(in[41], 2500);
  EXPECT_EQ(in[50], 500);
  EXPECT_EQ(in[53], 12);
  EXPECT_EQ(in[60], 2800);
  EXPECT_EQ(s(61), -123);
}

TEST_F(ValveDriverTest, InputsAreReadableAsHoldingRegistersAt1000ButNotWritable) {
  driver_.update(sample_at(kStart));
  EXPECT_EQ(read(kStart, RegisterTable::holding, 1000, reg::kInputEnd),
            read(kStart, RegisterTable::input, 0, reg::kInputEnd));
  EXPECT_EQ(write(kStart, 1002, {1}), refused(ExceptionCode::illegal_data_address));
  EXPECT_EQ(ask(kStart, ReadRegisters{RegisterTable::holding, 999, 2}),
            refused(ExceptionCode::illegal_data_address, 3));
}

TEST_F(ValveDriverTest, AddressesEndWhereTheMapEnds) {
  EXPECT_EQ(ask(kStart, ReadRegisters{RegisterTable::input, 61, 2}),
            refused(ExceptionCode::illegal_data_address, 4));
  EXPECT_EQ(ask(kStart, ReadRegisters{RegisterTable::holding, 43, 2}),
            refused(ExceptionCode::illegal_data_address, 3));
  EXPECT_EQ(ask(kStart, ReadRegisters{RegisterTable::holding, 1061, 2}),
            refused(ExceptionCode::illegal_data_address, 3));
  EXPECT_EQ(write(kStart, 14, {0}), refused(ExceptionCode::illegal_data_address));
  EXPECT_EQ(write(kStart, 13, {800, 0}), refused(ExceptionCode::illegal_data_address));
  EXPECT_EQ(holding(kStart, 13), 750) << "a refused request wrote its first register";
  EXPECT_EQ(ask(kStart, ReadBits{BitTable::coils, 0, 1}),
            refused(ExceptionCode::illegal_function, 1));
}

// A malformed request of a function that it does not have was answered with exception 03.
TEST_F(ValveDriverTest, WithoutCoilsItHasNoFunctionOfThem) {
  for (const std::uint8_t function : std::array<std::uint8_t, 4>{1, 2, 5, 15}) {
    EXPECT_FALSE(driver_.unit().has_function(function)) << unsigned{function};
  }
  for (const std::uint8_t function : std::array<std::uint8_t, 8>{3, 4, 6, 16, 17, 22, 23, 43}) {
    EXPECT_TRUE(driver_.unit().has_function(function)) << unsigned{function};
  }
}

TEST_F(ValveDriverTest, APlcCycleWritesCommandsAndReadsStatusInOneRequest) {
  const std::uint16_t written[] = {1, 300, 0, 0, 0, 0, 0, 0, 0, 17};
  const auto answer = ask(kStart, ReadWriteRegisters{1000, 22, 0, make_registers(written)});
  const auto in = std::get<RegistersResponse>(answer).registers;
  EXPECT_EQ(in.values[0], reg::kStatusReady | reg::kStatusEnabled);
  EXPECT_EQ(in.values[10], 0) << "the coil's current has only begun to rise";
  EXPECT_EQ(input(at(100ms), 10), 250 + 150);  // 250 mA + 0.3 * 500 mA
  EXPECT_EQ(in.values[11], 0);
  EXPECT_EQ(in.values[20], 17);
}

TEST_F(ValveDriverTest, ASpoolThatDoesNotFollowLatchesFault5AfterItsDelay) {
  write(kStart, reg::kWatchdog, {0});
  write(kStart, 0, {1, 800});
  ValveSample stuck;
  for (int i = 1; i <= 100; ++i) {
    stuck.time = at(i * 5ms);
    driver_.update(stuck);
  }
  EXPECT_EQ(driver_.fault(), FaultCode::none);
  stuck.time = at(505ms);
  driver_.update(stuck);
  EXPECT_EQ(driver_.fault(), FaultCode::spool_not_following);
  EXPECT_EQ(driver_.command().time, at(505ms));
  EXPECT_DOUBLE_EQ(opening(0), 0.0);
}

TEST_F(ValveDriverTest, ASpoolSensorThatGivesNoNumberLatchesFault6AndKeepsTheRegister) {
  driver_.update(sample_at(at(5ms)));
  ValveSample broken = sample_at(at(10ms));
  broken.spool_position[1] = std::numeric_limits<double>::quiet_NaN();
  broken.swing_angle_rad = std::numeric_limits<double>::infinity();
  driver_.update(broken);
  EXPECT_EQ(driver_.fault(), FaultCode::sensor);
  EXPECT_EQ(static_cast<std::int16_t>(input(at(10ms), 3)), -500);
  EXPECT_EQ(input(at(10ms), 30), 0xFFFD);
}

TEST_F(ValveDriverTest, IdentifiesItself) {
  const auto id = std::get<ServerIdResponse>(ask(kStart, ReportServerId{}));
  EXPECT_EQ(std::string(id.data.begin(), id.data.begin() + static_cast<std::ptrdiff_t>(id.size)),
            "Rigwire RW-HVD8 1.0\xFF");
  const auto objects = std::get<DeviceIdentificationResponse>(
      ask(kStart, ReadDeviceIdentification{IdentificationAccess::regular, 0}));
  EXPECT_EQ(objects.find(0), "Rigwire");
  EXPECT_EQ(objects.find(4), "Hydraulic valve driver");
}

TEST_F(ValveDriverTest, AMegabyteOfGarbageMovesNothing) {
  std::mt19937 random(7);  // a fixed stream, the same in every run
  Bytes garbage(1U << 20U);
  for (auto& byte : garbage) {
    byte = static_cast<std::uint8_t>(random());
  }
  ConnectionId id = 2;
  server_.connected(kStart, id);
  for (std::size_t i = 0; i < garbage.size(); i += 1024) {
    server_.receive(kStart, id, std::span(garbage).subspan(i, 1024));
    if (!output_.closed.empty() && output_.closed.back().connection == id) {
      server_.disconnected(kStart, id);
      server_.connected(kStart, ++id);
    }
  }
  EXPECT_GT(id, 500U) << "garbage should soon have an impossible length";
  EXPECT_EQ(driver_.received().accepted, 0U);
  EXPECT_EQ(server_.received().bytes, 1U << 20U);
  EXPECT_THAT(driver_.command().opening, Each(0.0));
  EXPECT_EQ(write(kStart, 0, {1, 100}), done(0, 2));
}

TEST_F(ValveDriverTest, QuantitiesComeFromTheMap) {
  const auto quantities = driver_.quantities();
  const auto found = std::ranges::find(quantities, "swing_angle", &Quantity::name);
  ASSERT_NE(found, quantities.end());
  EXPECT_EQ(found->unit, "deg");
  EXPECT_DOUBLE_EQ(found->resolution, 0.001);
}

TEST(ValveDriverDocumentation, ThePageHoldsEveryRowOfTheMap) {
  std::ifstream file(std::string(RIGWIRE_SOURCE_DIR) + "/docs/devices/valve-driver.md");
  std::stringstream page;
  page << file.rdbuf();
  for (const ValveRegister& entry : reg::map().registers) {
    EXPECT_THAT(page.str(), ::testing::HasSubstr(markdown_row(entry)));
  }
}

TEST(ValveDriverMap, OfEveryNumberOfSectionsIsValid) {
  for (std::size_t sections = 1; sections <= kValveSections; ++sections) {
    EXPECT_NO_THROW(validate(reg::map(sections)));
  }
}

TEST(ValveDriverSettingsTest, OutOfRangeIsRefusedByName) {
  const auto expect_refused = [](auto change, const char* name) {
    ValveDriverSettings settings;
    change(settings);
    try {
      validate(settings);
      ADD_FAILURE() << name << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
    }
  };
  using Settings = ValveDriverSettings;
  expect_refused([](Settings& s) { s.amplifier.sections.clear(); }, "sections");
  expect_refused([](Settings& s) { s.amplifier.sections.assign(9, "x"); }, "sections");
  expect_refused([](Settings& s) { s.amplifier.sections = {"a", "a"}; }, "sections");
  expect_refused([](Settings& s) { s.amplifier.parameters.watchdog = 10ms; }, "watchdog");
  expect_refused([](Settings& s) { s.amplifier.parameters.watchdog = 20'500us; }, "watchdog");
  expect_refused([](Settings& s) { s.sample_period = 0ms; }, "rate: found a period of 0 s");
  expect_refused([](Settings& s) { s.amplifier.electronics.supply_voltage_v = std::nan(""); },
                 "electronics.supply_voltage: found nan V");
  expect_refused([](Settings& s) { s.amplifier.parameters.current_start_ma = 800; },
                 "coil_current_start");
  expect_refused(
      [](Settings& s) {
        s.map = reg::map();
        s.map->vendor = "";
      },
      "vendor");
  validate(Settings{});
}

}  // namespace
}  // namespace rigwire::emulators
