#include "dig_cycle/options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace rigwire::dig_cycle {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using Arguments = std::vector<std::string_view>;

std::string refusal(const Arguments& arguments) {
  try {
    (void)parse_options(arguments);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DigCycleOptions, DefaultsAreTheRigsWires) {
  const Options options = parse_options({});
  EXPECT_EQ(options.gnss, "/tmp/rigwire/gnss");
  EXPECT_EQ(options.lidar_port, 2368);
  EXPECT_EQ(options.can, "auto");
  EXPECT_EQ(options.modbus_port, 1502);
  EXPECT_EQ(options.cycle.cycles, 0U);
}

TEST(DigCycleOptions, TakesValuesBehindASpaceOrAnEqualsSign) {
  const Options options = parse_options(
      Arguments{"--gnss=/dev/ttyACM0", "--modbus", "10.0.0.5:502", "--duration=2.5s", "--cycles",
                "3", "--lidar-mount=1,2,3,90,-5", "--imu-addresses=0x90,0x91,146,0x93", "--wait"});
  EXPECT_EQ(options.gnss, "/dev/ttyACM0");
  EXPECT_EQ(options.modbus_host, "10.0.0.5");
  EXPECT_EQ(options.modbus_port, 502);
  EXPECT_EQ(options.duration, 2500ms);
  EXPECT_EQ(options.cycle.cycles, 3U);
  EXPECT_NEAR(options.lidar_mount.pitch_rad, -5.0 * kDegree, 1e-12);
  EXPECT_THAT(options.imu.addresses, ::testing::ElementsAre(0x90, 0x91, 0x92, 0x93));
  EXPECT_TRUE(options.wait);
}

TEST(DigCycleOptions, TheValvesMayBeOnASerialLine) {
  Options options = parse_options(Arguments{"--modbus", "rtu:/tmp/rigwire/modbus"});
  EXPECT_EQ(options.modbus_path, "/tmp/rigwire/modbus");
  EXPECT_EQ(options.modbus_baud, 115200U);
  options = parse_options(Arguments{"--modbus", "rtu:/dev/ttyUSB0:19200"});
  EXPECT_EQ(options.modbus_path, "/dev/ttyUSB0");
  EXPECT_EQ(options.modbus_baud, 19200U);
  EXPECT_THAT(refusal({"--modbus", "rtu:"}), HasSubstr("rtu:PATH"));
  EXPECT_THAT(refusal({"--modbus", "rtu::9600"}), HasSubstr("rtu:PATH"));
}

TEST(DigCycleOptions, SaysWhatWasFoundAndWhatIsAllowed) {
  EXPECT_THAT(refusal({"--lidar-port", "0"}), HasSubstr("found '0', allowed a port, 1..65535"));
  EXPECT_THAT(refusal({"--lidar-port", "65536"}), HasSubstr("65536"));
  EXPECT_THAT(refusal({"--duration", "-1"}), HasSubstr("seconds, 0 or more"));
  EXPECT_THAT(refusal({"--duration", "nan"}), HasSubstr("seconds, 0 or more"));
  EXPECT_THAT(refusal({"--modbus", "1502"}), HasSubstr("ADDRESS:PORT"));
  EXPECT_THAT(refusal({"--imu-identities", "1,2,3"}), HasSubstr("four identity numbers"));
  EXPECT_THAT(refusal({"--imu-identities", "1,2,3,3"}), HasSubstr("four different values"));
  EXPECT_THAT(refusal({"--lidar-mount", "1,2"}), HasSubstr("X,Y,Z"));
  EXPECT_THAT(refusal({"--gnss"}), HasSubstr("a value is missing"));
  EXPECT_THAT(refusal({"--gnss="}), HasSubstr("the value is empty"));
  EXPECT_THAT(refusal({"--cycle", "1"}), HasSubstr("unknown option '--cycle'"));
}

}  // namespace
}  // namespace rigwire::dig_cycle
