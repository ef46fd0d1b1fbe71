#include "emulators/valve_driver/valve_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <stdexcept>

#include "../modbus/modbus_client.h"
#include "emulators/modbus/modbus_service.h"
#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr SimTime valve_map_at(Duration since_start) {
  return kStart + since_start;
}

ValveRegister entry(const char* name, ModbusTable table, std::uint16_t address, ValveSignal signal,
                    bool writable) {
  ValveRegister result;
  result.name = name;
  result.table = table;
  result.address = address;
  result.signal = signal;
  result.writable = writable;
  return result;
}

/// A small map with a bit of everything.
ValveMap small_map() {
  constexpr auto kHolding = ModbusTable::holding_registers;
  constexpr auto kInput = ModbusTable::input_registers;
  ValveMap map;
  map.name = "small";
  ValveRegister key = entry("key", kHolding, 100, ValveSignal::enable, true);
  key.values = {{165, 1}};
  key.initial = 0;
  map.registers.push_back(key);
  ValveRegister set = entry("set", kHolding, 101, ValveSignal::command, true);
  set.count = 4;
  set.unit = "%";
  set.scale = 0.02;
  set.offset = -100.0;
  set.lower = 0;
  set.upper = 10000;
  set.initial = 5000;
  map.registers.push_back(set);
  ValveRegister flow = entry("current", kInput, 10, ValveSignal::coil_current, false);
  flow.count = 2;
  flow.format = RegisterFormat::f32;
  flow.order = WordOrder::low_first;
  flow.unit = "A";
  map.registers.push_back(flow);
  ValveRegister code = entry("code", kInput, 20, ValveSignal::fault_code, false);
  code.values = {{0, 0}, {1000, 1}};
  map.registers.push_back(code);
  ValveRegister name = entry("type", kInput, 30, ValveSignal::text, false);
  name.format = RegisterFormat::text;
  name.count = 3;
  name.content = "EHC-4";
  map.registers.push_back(name);
  ValveRegister stop = entry("stop", ModbusTable::coils, 5, ValveSignal::quick_stop, true);
  stop.format = RegisterFormat::bit;
  map.registers.push_back(stop);
  ValveRegister ready = entry("ready", ModbusTable::discrete_inputs, 0, ValveSignal::ready, false);
  ready.format = RegisterFormat::bit;
  map.registers.push_back(ready);
  return map;
}

class MappedValve : public ::testing::Test {
 protected:
  explicit MappedValve(const ValveMap& map = small_map()) : driver_(settings(map)) {}
  static ValveDriverSettings settings(const ValveMap& map) {
    ValveDriverSettings settings;
    settings.map = map;
    return settings;
  }
  ModbusUnit::Outcome write(Duration now, std::uint16_t address,
                            std::vector<std::uint16_t> values) {
    driver_.advance(valve_map_at(now));
    const auto outcome = driver_.unit().write_registers(valve_map_at(now), address, values);
    if (!outcome) {
      driver_.unit().served(valve_map_at(now));
    }
    return outcome;
  }
  std::vector<std::uint16_t> read(Duration now, RegisterTable table, std::uint16_t address,
                                  std::size_t count) {
    driver_.advance(valve_map_at(now));
    std::vector<std::uint16_t> values(count);
    EXPECT_FALSE(driver_.unit().read_registers(table, address, values));
    return values;
  }
  double opening(std::size_t section) const { return driver_.command().opening[section]; }

  ValveDriver driver_;
};

TEST_F(MappedValve, OnlyTheRightValueEnables) {
  EXPECT_FALSE(write(0ms, 100, {1}));
  EXPECT_FALSE(driver_.enabled());
  write(1ms, 100, {165, 7500, 2500});
  EXPECT_TRUE(driver_.enabled());
  EXPECT_NEAR(opening(0), 0.5, 1e-12);
  EXPECT_NEAR(opening(1), -0.5, 1e-12);
  write(2ms, 100, {164});
  EXPECT_EQ(opening(0), 0.0);
}

TEST_F(MappedValve, ACommandThatEnablingTakesBackReadsAsNeutral) {
  write(0ms, 101, {9000});
  write(1ms, 100, {165});
  EXPECT_THAT(read(1ms, RegisterTable::holding, 101, 1), ElementsAre(5000));
}

TEST_F(MappedValve, FloatsComeWithTheLowWordFirst) {
  write(0ms, 100, {165, 10000});
  const auto words = read(150ms, RegisterTable::input, 10, 4);
  const std::uint32_t raw = (std::uint32_t{words[1]} << 16U) | words[0];
  EXPECT_NEAR(std::bit_cast<float>(raw), 0.75F, 1e-6F);
}

TEST_F(MappedValve, CodesAreTheMakersOwn) {
  write(0ms, 100, {165});
  EXPECT_THAT(read(10s, RegisterTable::input, 20, 1), ElementsAre(1000));
}

TEST_F(MappedValve, TextsAreTwoCharactersPerRegister) {
  EXPECT_THAT(read(0ms, RegisterTable::input, 30, 3), ElementsAre(0x4548, 0x432D, 0x3400));
}

TEST_F(MappedValve, CoilsAndDiscreteInputsWork) {
  write(0ms, 100, {165, 10000});
  BitBlock coil;
  coil.count = 1;
  coil.set(0, true);
  EXPECT_FALSE(driver_.unit().write_coils(valve_map_at(1ms), 5, coil));
  EXPECT_EQ(opening(0), 0.0);
  BitBlock bits;
  bits.count = 1;
  EXPECT_FALSE(driver_.unit().read_bits(BitTable::discrete_inputs, 0, bits));
  EXPECT_TRUE(bits.test(0));
  EXPECT_EQ(driver_.unit().read_bits(BitTable::discrete_inputs, 1, bits),
            ExceptionCode::illegal_data_address);
}

TEST_F(MappedValve, GapsAndReadOnlyRegistersAreException2) {
  std::vector<std::uint16_t> values(2);
  EXPECT_EQ(driver_.unit().read_registers(RegisterTable::input, 20, values),
            ExceptionCode::illegal_data_address);
  EXPECT_EQ(write(0ms, 99, {0, 0}), ExceptionCode::illegal_data_address);
}

class ClippingValve : public MappedValve {
 protected:
  static ValveMap map() {
    ValveMap map = small_map();
    map.clip = true;
    map.watchdog_recovers = true;
    map.always_enabled = true;
    map.registers.erase(map.registers.begin());
    ValveRegister loss =
        entry("loss", ModbusTable::holding_registers, 200, ValveSignal::loss_position, true);
    loss.unit = "%";
    loss.upper = 101;
    loss.initial = 30;
    map.registers.push_back(loss);
    ValveRegister wide =
        entry("wide", ModbusTable::holding_registers, 210, ValveSignal::ramp_up, true);
    wide.format = RegisterFormat::u32;
    wide.upper = 100000;
    wide.unit = "ms";
    map.registers.push_back(wide);
    return map;
  }
  ClippingValve() : MappedValve(map()) {}
};

TEST_F(ClippingValve, ValuesOutOfRangeAreHeldAtTheEnd) {
  EXPECT_FALSE(write(0ms, 101, {65535}));
  EXPECT_EQ(opening(0), 1.0);
  EXPECT_THAT(read(0ms, RegisterTable::holding, 101, 1), ElementsAre(10000));
}

TEST_F(ClippingValve, LossOfCommunicationMovesToItsPositionAndEndsWithTheNextMessage) {
  write(0ms, 101, {10000});
  driver_.advance(valve_map_at(5s));
  EXPECT_DOUBLE_EQ(opening(0), 0.3);
  write(6s, 101, {7500});
  EXPECT_NEAR(opening(0), 0.5, 1e-12);
  EXPECT_EQ(driver_.fault(), ValveFault::none);
  write(6s, 200, {101});  // hold
  driver_.advance(valve_map_at(20s));
  EXPECT_NEAR(opening(0), 0.5, 1e-12);
}

TEST_F(ClippingValve, HalfOfAWideValueIsTakenWithTheOtherHalfAsItWas) {
  write(0ms, 210, {0, 500});
  EXPECT_EQ(driver_.amplifier().parameters().stage[0].ramp_up, 500ms);
  write(1ms, 211, {900});
  EXPECT_EQ(driver_.amplifier().parameters().stage[0].ramp_up, 900ms);
  write(2ms, 210, {1});
  EXPECT_EQ(driver_.amplifier().parameters().stage[0].ramp_up, 66436ms);
}

TEST(ValveMapFaults, AreToldWithTheRegistersName) {
  const auto expect_refused = [](auto change, const char* what) {
    ValveMap map = small_map();
    change(map);
    try {
      validate(map);
      ADD_FAILURE() << what << " was taken";
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(what));
    }
  };
  validate(small_map());
  expect_refused([](ValveMap& m) { m.registers[2].address = 19; }, "belongs to");
  expect_refused([](ValveMap& m) { m.registers.erase(m.registers.begin()); }, "nothing enables");
  expect_refused([](ValveMap& m) { m.registers[1].unit = "bar"; }, "unit");
  expect_refused([](ValveMap& m) { m.registers[1].scale = 0.0; }, "scale");
  expect_refused([](ValveMap& m) { m.registers[1].upper = 70000; }, "range");
  expect_refused([](ValveMap& m) { m.registers[1].initial = 10001; }, "initial");
  expect_refused([](ValveMap& m) { m.registers[1].count = 9; }, "count");
  expect_refused([](ValveMap& m) { m.registers[1].address = 65534; }, "row");
  expect_refused([](ValveMap& m) { m.registers[2].writable = true; }, "inputs");
  expect_refused([](ValveMap& m) { m.registers[4].count = 2; }, "text of");
  expect_refused([](ValveMap& m) { m.registers[5].format = RegisterFormat::u16; }, "format bit");
  expect_refused([](ValveMap& m) { m.vendor = std::string(61, 'x'); }, "vendor");
  expect_refused([](ValveMap& m) { m.registers.clear(); }, "no registers");
  expect_refused(
      [](ValveMap& m) {
        m.registers[3].signal = ValveSignal::bits;
        m.registers[3].bits = {{3, ValveSignal::ready, {}}, {3, ValveSignal::fault, {}}};
      },
      "bit 3");
}

TEST(RegisterCodec, CountsSurviveEveryFormatAndWordOrder) {
  for (const auto format : {RegisterFormat::u16, RegisterFormat::s16, RegisterFormat::u32,
                            RegisterFormat::s32, RegisterFormat::f32}) {
    for (const auto order : {WordOrder::high_first, WordOrder::low_first}) {
      ValveRegister row;
      row.format = format;
      row.order = order;
      for (const double count : {0.0, 1.0, 255.0, 32767.0, row.least(), row.greatest()}) {
        const auto back = decode_count(row, encode_count(row, count));
        ASSERT_TRUE(back);
        EXPECT_NEAR(*back, count, std::abs(count) * 1e-7) << name_of(format);
      }
    }
  }
}

TEST(RegisterCodec, AFloatThatIsNoNumberIsNoCount) {
  ValveRegister row;
  row.format = RegisterFormat::f32;
  EXPECT_FALSE(decode_count(row, {0x7FC0, 0}));
  EXPECT_FALSE(decode_count(row, {0x7F80, 0}));
  EXPECT_FALSE(decode_count(row, {0xFF80, 0}));
}

class ValveByFile : public MappedValve {
 protected:
  static ValveMap map() {
    constexpr auto kHolding = ModbusTable::holding_registers;
    ValveMap map;
    map.functions = {3, 4, 6, 16};
    ValveRegister on = entry("on", kHolding, 0, ValveSignal::enable_section, true);
    on.count = 4;
    map.registers.push_back(on);
    ValveRegister a = entry("a", kHolding, 10, ValveSignal::command_a, true);
    a.count = 4;
    map.registers.push_back(a);
    ValveRegister b = entry("b", kHolding, 20, ValveSignal::command_b, true);
    b.count = 4;
    map.registers.push_back(b);
    ValveRegister gain = entry("gain", kHolding, 30, ValveSignal::gain, true);
    gain.format = RegisterFormat::f32;
    gain.bytes = ByteOrder::low_first;
    gain.unit = "%";
    map.registers.push_back(gain);
    ValveRegister tank =
        entry("tank", ModbusTable::input_registers, 0, ValveSignal::tank_pressure, false);
    tank.unit = "kPa";
    map.registers.push_back(tank);
    ValveRegister live =
        entry("live", ModbusTable::input_registers, 1, ValveSignal::section_enabled, false);
    live.count = 4;
    map.registers.push_back(live);
    return map;
  }
  ValveByFile() : MappedValve(map()) {}
  std::vector<std::uint16_t> float_words(float value) {
    const auto raw = std::bit_cast<std::uint32_t>(value);
    const auto swapped = [](std::uint32_t word) {
      return static_cast<std::uint16_t>(((word & 0xFFU) << 8U) | (word >> 8U & 0xFFU));
    };
    return {swapped(raw >> 16U), swapped(raw & 0xFFFFU)};
  }
};

TEST_F(ValveByFile, SectionsAreEnabledOneByOne) {
  EXPECT_FALSE(driver_.enabled());
  write(0ms, 10, {50, 50, 0, 0});
  EXPECT_EQ(opening(0), 0.0);
  write(1ms, 1, {1});
  EXPECT_TRUE(driver_.enabled());
  EXPECT_EQ(opening(1), 0.0) << "a command given while off is forgotten";
  write(2ms, 10, {50, 40});
  EXPECT_EQ(opening(0), 0.0);
  EXPECT_DOUBLE_EQ(opening(1), 0.4);
  EXPECT_THAT(read(2ms, RegisterTable::input, 1, 4), ElementsAre(0, 1, 0, 0));
  write(3ms, 0, {1, 0});
  EXPECT_EQ(opening(1), 0.0);
  EXPECT_TRUE(driver_.enabled());
  write(4ms, 0, {0});
  EXPECT_FALSE(driver_.enabled());
}

TEST_F(ValveByFile, HalvesOfACommandPullAgainstEachOther) {
  write(0ms, 0, {1, 1, 1, 1});
  write(1ms, 10, {80});
  EXPECT_DOUBLE_EQ(opening(0), 0.8);
  write(2ms, 20, {30});
  EXPECT_DOUBLE_EQ(opening(0), 0.5);
  write(3ms, 10, {0});
  EXPECT_DOUBLE_EQ(opening(0), -0.3);
  EXPECT_THAT(read(3ms, RegisterTable::holding, 20, 1), ElementsAre(30));
  EXPECT_EQ(write(4ms, 10, {101}), ExceptionCode::illegal_data_value);
}

TEST_F(ValveByFile, HalvesThatAreForgottenReadAsZero) {
  write(0ms, 0, {1});
  write(1ms, 10, {80});
  write(2ms, 0, {0});
  write(3ms, 0, {1});
  EXPECT_EQ(opening(0), 0.0);
  EXPECT_THAT(read(3ms, RegisterTable::holding, 10, 1), ElementsAre(0));
  write(4ms, 20, {30});
  EXPECT_DOUBLE_EQ(opening(0), -0.3);
}

TEST_F(ValveByFile, AFloatBeyondWhatTheAmplifierTakesIsRefusedWithoutARange) {
  EXPECT_FALSE(write(0ms, 30, float_words(150.0F)));
  EXPECT_DOUBLE_EQ(driver_.amplifier().parameters().stage[0].gain, 1.5);
  EXPECT_EQ(read(0ms, RegisterTable::holding, 30, 2), float_words(150.0F));
  EXPECT_EQ(write(1ms, 30, float_words(250.0F)), ExceptionCode::illegal_data_value);
}

TEST_F(ValveByFile, TankPressureIsTheReturnLines) {
  ValveSample sample;
  sample.tank_pressure_pa = 3e5;
  driver_.update(sample);
  EXPECT_THAT(read(0ms, RegisterTable::input, 0, 1), ElementsAre(300));
}

TEST_F(ValveByFile, FunctionsThatItHasNotAreException1) {
  ModbusService service(ModbusWire::tcp, {}, 1);
  service.add_unit(1, driver_.unit());
  ModbusAnswer answer;
  const auto exception = [&](std::vector<std::uint8_t> pdu) {
    service.serve(valve_map_at(1ms), 1, pdu, answer);
    const auto bytes = answer.pdu.view();
    return (bytes[0] & 0x80U) != 0 ? bytes[1] : std::uint8_t{0};
  };
  EXPECT_EQ(exception({3, 0, 0, 0, 1}), 0);
  EXPECT_EQ(exception({22, 0, 0, 0, 1, 0, 1}), 1);
  EXPECT_EQ(exception({43, 14, 1, 0}), 1);
  EXPECT_EQ(exception({22}), 1) << "whatever the request";
}

TEST(RangeOfWhatIsWritten, IsTheAmplifiersWhereNoneIsGiven) {
  ValveRegister set = entry("set", ModbusTable::holding_registers, 0, ValveSignal::command, true);
  set.format = RegisterFormat::f32;
  set.unit = "1";
  EXPECT_EQ(set.least(), -1.0);
  EXPECT_EQ(set.greatest(), 1.0);
  set.format = RegisterFormat::s16;
  set.unit = "%";
  set.scale = -0.3;
  EXPECT_EQ(set.least(), -333.0);
  EXPECT_EQ(set.greatest(), 333.0);
  set.writable = false;
  EXPECT_EQ(set.greatest(), 32767.0);
}

}  // namespace
}  // namespace rigwire::emulators
