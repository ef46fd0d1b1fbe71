// Devices of a running rig are told keys of their configuration: what each does, and what is
// refused.
#include "hil/rig/rig_settings.h"

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "governed_run.h"
#include "hil/configuration/outline.h"
#include "hil/devices/device_types.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using test::Json;
using test::Ran;
using test::run;
using testing::HasSubstr;

/// A key that shows in what its device sends.
struct Told {
  const char* device;
  const char* key;
  const char* value;
};
void PrintTo(const Told& told, std::ostream* out) {
  *out << told.device << " " << told.key << " = " << told.value;
}

/// On wires of their own: every type of device that can be told anything, but cameras, which send
/// nothing without a client.
class RigSettingsOf : public testing::Test {
 protected:
  [[nodiscard]] LoadedRig load(const std::string& rig) const {
    const std::string file = (wires_.folder / "rig.yaml").string();
    std::ofstream out(file);
    if (rig == "excavator") {
      out << "include: " RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_can.yaml\n"
          << "buses:\n  can: {wire: slcan, path: " << wires_.can() << "}\n"
          << "  valves: {wire: slcan, path: " << wires_.can() << "2}\n"
          << "devices:\n  gnss: {path: " << wires_.gnss() << "}\n";
      return close(out, file);
    }
    out << "machine: {include: " RIGWIRE_SOURCE_DIR "/configs/machines/gator_855d.yaml}\n"
        << "buses:\n  can: {wire: slcan, path: " << wires_.can() << "}\n"
        << "devices:\n"
           "  imu: {type: openimu335ri, bus: can, source_address: 0x80, serial: 1, mount: {link: "
           "body}}\n"
           "  tilt: {type: cia410-inclinometer, bus: can, node_id: 9, starts_itself: true, "
           "transmission_type: 255, event_timer: 20, quadrants: 0, mount: {link: body, rotation: "
           "{roll: 0 deg, pitch: 170 deg, yaw: 0 deg}}}\n"
           "  wheel: {type: cia406-encoder, bus: can, node_id: 32, base: front_axle, link: "
           "front_left_wheel, axis: y, offset: 10 deg, starts_itself: true}\n"
           "  vehicle: {type: vehicle-gateway, bus: can, source_address: 0x27, serial: 3}\n"
        << "  gnss: {type: ublox-neo-m8t, baud: 115200, path: " << wires_.gnss()
        << ", mount: {link: body, position: [0.8 m, 0 m, 1.95 m]}}\n"
        << "  lidar: {type: velodyne-vlp-16, port: " << wires_.lidar_port
        << ", position_port: " << wires_.lidar_port + 1
        << ", sensor: {sub_rays: 5}, mount: {link: body, position: [1.2 m, 0 m, 2.05 m]}}\n";
    return close(out, file);
  }
  Ran with(const LoadedRig& rig, const std::vector<Request>& requests, Duration length) const {
    return run(rig.configuration, requests, length);
  }
  Json answer(const std::string& device, const std::string& keys) const {
    return run(load("").configuration, {{SetCommand{device, keys}, 300ms}}, 310ms).answers.at(0);
  }

  rigwire::test::PrivateWires wires_;

 private:
  static LoadedRig close(std::ofstream& out, const std::string& file) {
    out.close();
    return load_rig(file, {});
  }
};

constexpr std::array kTold{
    Told{"imu", "rate", "20 Hz"},
    Told{"imu", "packets", "5"},
    Told{"imu", "rate_filter", "2 Hz"},
    Told{"imu", "acceleration_filter", "2 Hz"},
    Told{"imu", "orientation", "9"},
    Told{"tilt", "transmission_type", "1"},
    Told{"tilt", "event_timer", "50"},
    Told{"tilt", "heartbeat", "100"},
    Told{"tilt", "resolution", "100"},
    Told{"tilt", "filter", "4"},
    Told{"tilt", "quadrants", "1"},
    Told{"wheel", "transmission_type", "1"},
    Told{"wheel", "event_timer", "50"},
    Told{"wheel", "heartbeat", "100"},
    Told{"wheel", "direction", "counter_clockwise"},
    Told{"vehicle", "source_address", "0x30"},
    Told{"engine", "source_address", "0x01"},
    Told{"valves", "source_address", "0x90"},
    Told{"gnss", "rate", "5 Hz"},
    Told{"gnss", "baud", "57600"},
    Told{"gnss", "nmea_sentences", "[GGA]"},
    Told{"gnss", "ubx_messages", "[NAV-PVT]"},
    Told{"lidar", "rate", "300 rpm"},
    Told{"lidar", "return_mode", "last"},
    Told{"lidar", "laser", "false"},
    Told{"lidar", "fov.start", "90"},
    Told{"lidar", "fov.end", "180"},
    Told{"lidar", "phase_lock.enabled", "true"},
};

class EachKeyOf : public RigSettingsOf, public testing::WithParamInterface<const char*> {};

TEST_P(EachKeyOf, ADeviceThatItCanBeToldShowsOnItsWireFromThenOn) {
  const std::string device = GetParam();
  const bool excavator = device == "engine" || device == "valves";
  const LoadedRig rig = load(excavator ? "excavator" : "");
  const Duration length = 4s;
  // A vehicle drives off, so that filters have something to filter.
  std::vector<Request> requests;
  if (!excavator) {
    requests.push_back({SetCommand{"machine", "{parking_brake: false, travel_speed: 2}"}, 1s});
  }
  const Ran without = with(rig, requests, length);
  for (const Told& told : kTold) {
    if (told.device != device) {
      continue;
    }
    SCOPED_TRACE(testing::PrintToString(told));
    const std::string keys = Json{{told.key, told.value}}.dump();
    const std::string text =
        told.value[0] == '[' ? std::string("{") + told.key + ": " + told.value + "}" : keys;
    const auto at = [&](Duration instant) {
      std::vector<Request> all = requests;
      all.push_back({SetCommand{device, text}, instant});
      return all;
    };
    const Ran set = with(rig, at(1500ms), length);
    for (const Json& answer : set.answers) {
      EXPECT_TRUE(answer["ok"].get<bool>()) << answer;
    }
    EXPECT_EQ(set.answers.back()["acts_from_ns"], 1'500'000'000);
    EXPECT_NE(set.streams.at(device), without.streams.at(device)) << "nobody can see it";
    const Ran late = with(rig, at(length), length - 1ns);
    EXPECT_EQ(late.streams, without.streams) << "it acts before its instant";
  }
}

INSTANTIATE_TEST_SUITE_P(, EachKeyOf,
                         testing::Values("imu", "tilt", "wheel", "vehicle", "engine", "valves",
                                         "gnss", "lidar"),
                         [](const auto& test) { return std::string(test.param); });

/// What no type is left out of: a key that is added comes with a row above, or with one here that
/// says who tests it.
TEST(RigSettings, EveryKeyOfEveryTypeIsInTheTable) {
  std::set<std::string> tested;
  for (const Told& told : kTold) {
    tested.insert(told.key);
  }
  tested.insert({"address", "port", "position_port"});  // ALidarSendsWhereItIsTold
  tested.insert({"phase_lock.offset"});                 // velodyne_lidar_test.cpp
  tested.insert({"uart2_messages", "uart2_baud"});      // ublox/live_settings_test.cpp
  tested.insert({"exposure", "exposure_auto", "gain", "gain_auto", "black_level", "throughput",
                 "packet_size"});  // gige_camera/live_settings_test.cpp
  for (const DeviceType& type : device_types()) {
    for (const LiveKey& key : type.fresh()->live_keys()) {
      EXPECT_TRUE(tested.contains(std::string(key.key))) << type.named.name << " " << key.key;
    }
  }
}

/// They are keys of the type, by the name under which its file has them.
TEST(RigSettings, EveryKeyIsOneOfTheTypesConfiguration) {
  for (std::size_t row = 0; row < device_types().size(); ++row) {
    const ConfiguredDevice device(row);
    const OutlineNode outline = reference_outline(device);
    const std::function<bool(const OutlineNode&, std::string_view)> has =
        [&has](const OutlineNode& node, std::string_view path) {
          const std::size_t dot = path.find('.');
          return std::ranges::any_of(node.children, [&](const OutlineNode& child) {
            return child.key == path.substr(0, dot) &&
                   (dot == std::string_view::npos || has(child, path.substr(dot + 1)));
          });
        };
    for (const LiveKey& key : device->live_keys()) {
      EXPECT_TRUE(has(outline, key.key)) << device.type() << " " << key.key;
    }
  }
}

TEST_F(RigSettingsOf, ALidarSendsWhereItIsTold) {
  const LoadedRig rig = load("");
  const std::uint16_t elsewhere = rigwire::test::free_port(SOCK_DGRAM);
  const auto open = [&](std::uint16_t port) {
    const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    return descriptor;
  };
  const int data = open(elsewhere);
  const Ran set =
      with(rig, {{SetCommand{"lidar", "{port: " + std::to_string(elsewhere) + "}"}, 100ms}}, 150ms);
  EXPECT_TRUE(set.answers.at(0)["ok"].get<bool>()) << set.answers.at(0);
  std::array<std::uint8_t, 2000> packet{};
  EXPECT_EQ(::recv(data, packet.data(), packet.size(), 0), 1206);
  ::close(data);
  const Json away = answer("lidar", "{address: 192.0.2.1}");
  EXPECT_FALSE(away["ok"].get<bool>());
  EXPECT_THAT(away.dump(), HasSubstr("allow_remote"));
}

TEST_F(RigSettingsOf, WhatIsWrongIsRefusedAsInAFileAndNothingOfItHolds) {
  const Json nobody = answer("gns", "{rate: 5 Hz}");
  EXPECT_EQ(nobody["path"], "on");
  EXPECT_THAT(nobody["allowed"].get<std::string>(), HasSubstr("machine, air, gnss, imu, lidar"));
  const Json range = answer("lidar", "{rate: 5000 rpm}");
  EXPECT_EQ(range["path"], "rate");
  EXPECT_THAT(range["what"].get<std::string>(), HasSubstr("out of range"));
  const Json step = answer("lidar", "{rate: 610 rpm}");
  EXPECT_FALSE(step["ok"].get<bool>()) << "the motor holds multiples of 60 rpm";
  const Json live = answer("gnss", "{rate: 5 Hz, mount: {link: body}}");
  EXPECT_THAT(live["what"].get<std::string>(), HasSubstr("cannot be changed while it runs"));
  EXPECT_THAT(live["allowed"].get<std::string>(), HasSubstr("rate, baud, nmea_sentences"));
  EXPECT_FALSE(answer("gnss", "{}")["ok"].get<bool>());
  EXPECT_FALSE(answer("gnss", "rate")["ok"].get<bool>());
  EXPECT_FALSE(answer("gnss", "{rate: null}")["ok"].get<bool>());
  EXPECT_FALSE(answer("gnss", "{rate: {hz: 5}}")["ok"].get<bool>());
  EXPECT_FALSE(answer("lidar", "{fov: {}}")["ok"].get<bool>());
  EXPECT_FALSE(answer("lidar", "{fov: 5}")["ok"].get<bool>());
  EXPECT_FALSE(answer("lidar", "{fov.start: 5, fov: {start: 6}}")["ok"].get<bool>());
  // More than the line carries, which the rig's file may not have either.
  EXPECT_THAT(answer("gnss", "{rate: 10 Hz, baud: 9600}")["what"].get<std::string>(),
              HasSubstr("bytes/s"));
  const LoadedRig rig = load("");
  const Ran refused = with(rig, {{SetCommand{"lidar", "{laser: false, rate: 610 rpm}"}, 1s}}, 2s);
  EXPECT_EQ(refused.streams, with(rig, {}, 2s).streams) << "half of a refused request held";
}

TEST_F(RigSettingsOf, GroupsAreWrittenAsInAFileOrWithDots) {
  const LoadedRig rig = load("");
  const Ran dotted = with(rig, {{SetCommand{"lidar", "{fov.start: 90, fov.end: 180}"}, 1s}}, 2s);
  const Ran grouped = with(rig, {{SetCommand{"lidar", "{fov: {start: 90, end: 180}}"}, 1s}}, 2s);
  EXPECT_TRUE(dotted.answers.at(0)["ok"].get<bool>()) << dotted.answers.at(0);
  EXPECT_EQ(dotted.streams, grouped.streams);
}

/// A device without supply does not hear its client, either.
TEST_F(RigSettingsOf, ADeviceWithoutSupplyTakesNothing) {
  const Ran off = with(load(""),
                       {{FaultAddCommand{"imu", "{type: off, for: 1 s}"}, 1s},
                        {SetCommand{"imu", "{rate: 20 Hz}"}, 1500ms},
                        {SetCommand{"imu", "{rate: 20 Hz}"}, 3s}},
                       3100ms);
  EXPECT_FALSE(off.answers.at(1)["ok"].get<bool>()) << off.answers.at(1);
  EXPECT_THAT(off.answers.at(1)["what"].get<std::string>(), HasSubstr("no supply"));
  EXPECT_TRUE(off.answers.at(2)["ok"].get<bool>()) << off.answers.at(2);
}

/// An answer of `read` tells what can be set.
TEST_F(RigSettingsOf, ReadTellsWhatCanBeSet) {
  const Ran read = with(load(""), {{ReadCommand{}, 100ms}}, 110ms);
  EXPECT_EQ(read.answers.at(0)["devices"]["imu"]["settable"],
            Json::parse(R"(["rate", "packets", "rate_filter", "acceleration_filter",
                            "orientation"])"));
}

}  // namespace
}  // namespace rigwire::hil
