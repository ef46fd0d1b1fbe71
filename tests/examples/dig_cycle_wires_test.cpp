// What the program makes of the bytes on its wires.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "dig_cycle/imu_wire.h"
#include "dig_cycle/lidar_wire.h"
#include "dig_cycle/valve_wire.h"
#include "field/gnss_wire.h"
#include "protocols/j1939/message.h"
#include "protocols/j1939/name.h"
#include "protocols/nmea/writers.h"
#include "protocols/openimu/messages.h"

namespace rigwire::dig_cycle {
namespace {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string gga() {
  protocols::nmea::Epoch epoch;
  epoch.time = protocols::nmea::TimeOfDay{8, 0, 0, 0};
  epoch.fix_dimensions = 3;
  epoch.latitude_deg = 49.5;
  epoch.longitude_deg = -7.25;
  epoch.satellites_used = 7;
  return std::string(protocols::nmea::write_gga(epoch).text());
}

TEST(DigCycleGnssWire, FindsSentencesInPiecesBetweenNoiseAndBinary) {
  int heard = 0;
  field::GnssWire wire([&] { ++heard; });
  const std::string stream = std::string("49,3,A*00\r\n\xB5\x62\x01\x07$\x80", 16) + gga() +
                             "$GPG" + gga() + "\x00\xFF$$" + gga();
  for (const char character : stream) {
    wire.receive(bytes_of({&character, 1}));
  }
  EXPECT_EQ(heard, 3);
  EXPECT_GE(wire.rejected(), 2U);
  EXPECT_NEAR(wire.fix().latitude_deg, 49.5, 1e-6);
  EXPECT_NEAR(wire.fix().longitude_deg, -7.25, 1e-6);
  EXPECT_EQ(wire.fix().satellites, 7);
}

TEST(DigCycleGnssWire, DamagedSentenceIsNotHeard) {
  int heard = 0;
  field::GnssWire wire([&] { ++heard; });
  std::string damaged = gga();
  damaged[10] ^= 1;
  wire.receive(bytes_of(damaged));
  EXPECT_EQ(heard, 0);
}

protocols::can::Frame level(std::uint8_t source) {
  openimu::Acceleration acceleration;
  acceleration.vertical_mps2 = 9.81;
  return openimu::encode(acceleration, source);
}

TEST(DigCycleImuWire, TakesTheFourAddressesAndNobodyElse) {
  Estimator estimator;
  std::vector<Link> heard;
  ImuWire wire(estimator, {}, [&](Link link) { heard.push_back(link); });
  for (const int source : {0x80, 0x84, 0x81, 0x00, 0x83, 0x82}) {
    wire.receive(level(static_cast<std::uint8_t>(source)));
  }
  EXPECT_THAT(heard, ::testing::ElementsAre(chassis_link, boom_link, bucket_link, stick_link));
  EXPECT_FALSE(wire.question().has_value());
}

TEST(DigCycleImuWire, ErrorAndMissingValuesAreNoSignOfLife) {
  Estimator estimator;
  int heard = 0;
  ImuWire wire(estimator, {}, [&](Link) { ++heard; });
  openimu::Acceleration acceleration;
  acceleration.vertical_mps2 = std::numeric_limits<double>::quiet_NaN();
  wire.receive(openimu::encode(acceleration, 0x80));
  acceleration.vertical_mps2 = 9.81;
  acceleration.vertical_merit = openimu::FigureOfMerit::kError;
  wire.receive(openimu::encode(acceleration, 0x80));
  EXPECT_EQ(heard, 0);
  // Merit "not available" is what the 300RI sends all its life.
  acceleration.vertical_mps2 = 9.81;
  acceleration.vertical_merit = openimu::FigureOfMerit::kNotAvailable;
  wire.receive(openimu::encode(acceleration, 0x80));
  EXPECT_EQ(heard, 1);
}

TEST(DigCycleImuWire, LearnsAddressesFromClaimsAndFollowsAChange) {
  Estimator estimator;
  std::vector<Link> heard;
  ImuWireSettings settings;
  settings.identities = {{11, 12, 13, 14}};
  ImuWire wire(estimator, settings, [&](Link link) { heard.push_back(link); });
  ASSERT_TRUE(wire.question().has_value());
  EXPECT_EQ(*j1939::decode_request(*wire.question()), j1939::kAddressClaimedPgn);
  wire.receive(level(0x80));
  EXPECT_TRUE(heard.empty()) << "nobody has claimed that address";
  const auto claim = [&](std::uint8_t source, std::uint32_t identity) {
    wire.receive(j1939::make_address_claim(source, j1939::pack(j1939::Name{.identity = identity})));
  };
  claim(0x90, 11);
  claim(0x91, 12);
  claim(0x92, 13);
  claim(0x93, 14);
  EXPECT_FALSE(wire.question().has_value());
  wire.receive(level(0x92));
  EXPECT_THAT(heard, ::testing::ElementsAre(stick_link));
  claim(0x92, 99);  // a stranger with priority takes the address
  wire.receive(level(0x92));
  EXPECT_EQ(heard.size(), 1U);
  ASSERT_TRUE(wire.question().has_value());
  claim(0xA0, 13);
  wire.receive(level(0xA0));
  EXPECT_THAT(heard, ::testing::ElementsAre(stick_link, stick_link));
}

TEST(DigCycleLidarWire, GarbageIsCountedAndNotHeard) {
  Surroundings surroundings;
  int heard = 0;
  LidarWire wire(
      surroundings, [] { return ArmShape{}; }, [&] { ++heard; });
  std::vector<std::uint8_t> garbage(1206, 0x5A);
  wire.receive(garbage);
  wire.receive({});
  garbage.resize(4000);
  wire.receive(garbage);
  EXPECT_EQ(heard, 0);
  EXPECT_EQ(wire.rejected(), 3U);
  EXPECT_FALSE(wire.time_of_hour_us().has_value());
}

TEST(DigCycleValveWire, CommandsAreTenthsOfAPercentWithinTheRange) {
  const auto written = written_registers(
      {0.5, -1.7, std::numeric_limits<double>::quiet_NaN(), 0.0004}, true, false, 77);
  EXPECT_EQ(written[0], 1);
  EXPECT_EQ(written[1], 500);
  EXPECT_EQ(written[2], 0xFC18) << "-1000";
  EXPECT_EQ(written[3], 0);
  EXPECT_EQ(written[4], 0);
  EXPECT_EQ(written[9], 77);
}

TEST(DigCycleValveWire, DisabledIsNeutralWhateverIsAsked) {
  const auto written = written_registers({1.0, 1.0, 1.0, 1.0}, false, false, 0);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(written[i], 0) << i;
  }
}

TEST(DigCycleValveWire, SwingAngleIsSignedThirtyTwoBitsHighWordFirst) {
  std::array<std::uint16_t, kReadRegisters> registers{};
  registers[0] = 0b0110;
  registers[1] = 1;
  registers[30] = 0xFFFE;  // -90 000 millidegrees = 0xFFFEA070
  registers[31] = 0xA070;
  registers[32] = 0xFF38;  // -200: -2 deg/s
  registers[33] = 4242;
  const ValveState state = read_state(registers);
  EXPECT_FALSE(state.ready);
  EXPECT_TRUE(state.enabled);
  EXPECT_TRUE(state.faulted);
  EXPECT_EQ(state.fault_code, kWatchdogFault);
  EXPECT_NEAR(state.swing_rad, -90.0 * kDegree, 1e-12);
  EXPECT_NEAR(state.swing_rate_radps, -2.0 * kDegree, 1e-12);
  EXPECT_EQ(state.measurement_count, 4242);
}

}  // namespace
}  // namespace rigwire::dig_cycle
