// Our DBC files read by canmatrix, which shares no line with us: it finds every message and signal,
// and what it decodes from frames of our encoders is what the machine did.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "emulators/dbc_node/dbc_node.h"
#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "hil/files/dbc_node_file.h"
#include "private_wires.h"
#include "protocols/dbc/dbc_reader.h"
#include "protocols/dbc/dbc_writer.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using protocols::can::Frame;
using protocols::can::OwnedMessage;

/// Decodes the frames of a file, one "identifier extended bytes" in each line, and prints an object
/// for the bus and one for each frame.
constexpr const char* kReader = R"py(
import json, sys
import canmatrix.canmatrix as cm, canmatrix.formats
db = canmatrix.formats.loadp_flat(sys.argv[1])
print(json.dumps({"protocol": db.attribute("ProtocolType"), "frames": [
    {"name": f.name, "id": f.arbitration_id.id, "j1939": f.is_j1939, "cycle": f.cycle_time,
     "size": f.size, "signals": [[s.name, s.attributes.get("SPN", 0)] for s in f.signals],
     "sender": f.transmitters} for f in db.frames]}))
for line in open(sys.argv[2]):
    number, extended, data = line.split()
    frame = db.frame_by_id(cm.ArbitrationId(int(number, 16), extended=extended == "1"))
    read = frame.decode(bytes.fromhex(data))
    print(json.dumps({"id": number, "name": frame.name,
                      "values": {k: float(v.phys_value) for k, v in read.items()}}))
)py";

class Dbc : public testing::Test {
 protected:
  /// What canmatrix makes of the messages' file and of the frames: the bus first.
  std::vector<Json> read(const std::vector<OwnedMessage>& messages,
                         const std::vector<Frame>& frames) {
    const auto dbc = wires_.folder / "bus.dbc";
    std::ofstream(dbc) << protocols::dbc::write({"can", 250'000, messages});
    return read_file(dbc.string(), frames);
  }
  /// What canmatrix makes of another DBC file and of the frames.
  std::vector<Json> read_file(const std::string& dbc, const std::vector<Frame>& frames) {
    const auto log = wires_.folder / "frames";
    std::ofstream lines(log);
    for (const Frame& frame : frames) {
      lines << std::hex << frame.id << ' ' << (frame.extended ? 1 : 0) << ' ';
      for (const std::uint8_t byte : frame.payload()) {
        constexpr const char* kDigits = "0123456789abcdef";
        lines << kDigits[byte >> 4U] << kDigits[byte & 0xFU];
      }
      lines << '\n';
    }
    lines.close();
    test::ChildProcess reader({"/usr/bin/python3", "-c", kReader, dbc, log.string()},
                              wires_.folder / "output");
    EXPECT_EQ(reader.wait(), 0) << reader.output();
    std::vector<Json> objects;
    std::istringstream output(reader.output());
    for (std::string line; std::getline(output, line);) {
      if (line.starts_with('{')) {  // the library says which of its formats are missing
        objects.push_back(Json::parse(line));
      }
    }
    EXPECT_EQ(objects.size(), frames.size() + 1) << reader.output();
    return objects;
  }

  test::PrivateWires wires_;
};

/// The last frame of each identifier.
struct LastFrames final : emulators::FrameOutput {
  void send(SimTime, const Frame& frame) override { last[frame.id] = frame; }
  std::map<std::uint32_t, Frame> last;
};

std::uint64_t bits(const Frame& frame, unsigned first, unsigned width) {
  std::uint64_t raw = 0;
  for (unsigned i = 0; i < width; ++i) {
    const unsigned bit = first + i;
    raw |= static_cast<std::uint64_t>((frame.data[bit / 8] >> (bit % 8)) & 1U) << i;
  }
  return raw;
}

TEST_F(Dbc, CanmatrixDecodesADrivingUnimog) {
  LastFrames bus;
  emulators::VehicleGatewaySettings settings;
  settings.source_address = 0x17;
  settings.steering = emulators::SteeringLayout::crab;
  settings.has_position = true;
  settings.engine.reference_torque_nm = 1000.0;
  emulators::VehicleGateway gateway(settings, bus);
  VehicleSample sample;
  sample.engine.speed_radps = 188.5;
  sample.engine.torque_nm = 300.0;
  sample.wheel_radius_m.fill(0.5);
  sample.wheel_rate_radps = {9.0, 10.0, 11.0, 12.0};
  sample.front_steer_rad = 0.2;
  sample.tyre_pressure_pa.fill(300e3);
  sample.odometry = {-5.0, 0.02, -0.05};
  sample.lock = {false, false, true};
  const SamplePlan plan = gateway.sample_plan();
  for (SimTime t = plan.first; t < kStart + 11s; t = plan.next_after(t)) {
    GnssSample fix;
    fix.time = sample.time = t;
    fix.fix = GnssFix::three_d;
    fix.latitude_deg = 46.0;
    fix.longitude_deg = -7.0;
    gateway.observe_fix(fix);
    gateway.update(sample);
  }

  const auto messages = gateway.messages("vehicle");
  std::map<std::uint32_t, const OwnedMessage*> by_id;
  for (const OwnedMessage& message : messages) {
    by_id[message.id] = &message;
  }
  std::vector<Frame> frames;
  for (const auto& [id, frame] : bus.last) {
    if (by_id.contains(id)) {
      frames.push_back(frame);
    }
  }
  EXPECT_GE(frames.size(), 25U);
  const auto objects = read(messages, frames);
  ASSERT_FALSE(objects.empty());

  const Json& matrix = objects[0];
  EXPECT_EQ(matrix.at("protocol"), "J1939");
  ASSERT_EQ(matrix.at("frames").size(), messages.size());
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const Json& frame = matrix.at("frames")[i];
    EXPECT_EQ(frame.at("id"), messages[i].id);
    EXPECT_EQ(frame.at("j1939"), true) << frame;
    EXPECT_EQ(frame.at("cycle"), messages[i].period_ms) << frame;
    EXPECT_EQ(frame.at("signals").size(), messages[i].signals.size()) << frame;
    EXPECT_EQ(frame.at("sender").empty(), messages[i].sender.empty()) << frame;
  }

  // Every signal of every frame.
  std::map<std::string, Json> by_name;
  for (std::size_t i = 0; i < frames.size() && i + 1 < objects.size(); ++i) {
    const Json& values = objects[i + 1].at("values");
    for (const auto& field : by_id.at(frames[i].id)->signals) {
      const auto raw = static_cast<double>(bits(frames[i], field.bit, field.width));
      EXPECT_NEAR(values.at(field.name.substr(0, protocols::dbc::kLongestName)).get<double>(),
                  raw * field.scale + field.offset, std::abs(1e-9 * raw * field.scale) + 1e-9)
          << objects[i + 1].at("name") << ' ' << field.name;
    }
    by_name[objects[i + 1].at("name")] = values;
  }

  // And the truth, in SI units and with the signs of the machine.
  const auto value = [&](const char* message, const char* signal) {
    return by_name.at(message).at(signal).get<double>();
  };
  EXPECT_NEAR(value("eec1", "engine_speed"), 188.5, 0.007);
  EXPECT_NEAR(value("eec1", "actual_torque"), 0.3, 0.005);
  EXPECT_NEAR(value("hrw", "rear_right_wheel"), 6.0, 0.001);
  EXPECT_NEAR(value("ebc2", "front_axle_speed"), 4.75, 0.001);
  EXPECT_NEAR(value("ebc2", "relative_rear_1_left"), 0.75, 0.01);
  EXPECT_NEAR(value("gms", "estimated_curvature"), 0.02, 0.000125 * 1.001);  // left positive
  EXPECT_EQ(value("mss", "machine_selected_direction"), 0.0);
  EXPECT_NEAR(value("mss", "machine_selected_speed"), 5.0, 0.0005);
  EXPECT_NEAR(value("mfs", "slip_angle"), -0.05, 4e-5);
  EXPECT_EQ(value("eac1", "lock_rear_axle_1"), 1.0);
  EXPECT_EQ(value("eac1", "lock_front_axle_1"), 0.0);
  EXPECT_NEAR(value("tire2", "tyre_pressure_extended_range"), 300e3, 500.0);
  EXPECT_NEAR(value("vp", "latitude"), 46.0, 1e-7);
  EXPECT_NEAR(value("vp", "longitude"), -7.0, 1e-7);
}

TEST_F(Dbc, CanmatrixDecodesBigEndianSignedSignals) {
  OwnedMessage rates;
  rates.name = "rate_of_turn";
  rates.id = 0x32;
  rates.length = 6;
  rates.sender = "imu";
  for (std::uint16_t axis = 0; axis < 3; ++axis) {
    protocols::can::OwnedSignal signal;
    signal.name = std::string("xyz").substr(axis, 1);
    signal.bit = static_cast<std::uint16_t>(16 * axis + 7);  // of the first byte of each
    signal.width = 16;
    signal.order = protocols::can::ByteOrder::big_endian;
    signal.is_signed = true;
    signal.scale = 1.0 / 512.0;
    signal.lower = -64.0;
    signal.upper = 63.998046875;
    signal.unit = "rad/s";
    rates.signals.push_back(signal);
  }
  Frame frame;
  frame.id = 0x32;
  frame.length = 6;
  frame.data = {0x02, 0x00, 0x00, 0x01, 0xFE, 0x00};
  const auto objects = read({rates}, {frame});
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[0].at("frames")[0].at("j1939"), false);
  EXPECT_EQ(objects[1].at("values").at("x"), 1.0);
  EXPECT_EQ(objects[1].at("values").at("y"), 1.0 / 512.0);
  EXPECT_EQ(objects[1].at("values").at("z"), -1.0);
}

/// What our codec writes, canmatrix reads: pages, a Motorola number across bytes, a float.
TEST_F(Dbc, CanmatrixDecodesMultiplexedAndFloatingPointSignals) {
  using protocols::can::OwnedSignal;
  OwnedMessage pages;
  pages.name = "pages";
  pages.id = 0x45;
  pages.sender = "unit";
  OwnedSignal signal;
  signal.name = "page";
  pages.signals.push_back(unlimited(signal));
  signal.multiplexor = 0;
  signal.name = "pressure";
  signal.present_at = {{3, 3}};
  signal.bit = 12;
  signal.width = 10;
  signal.scale = 0.5;
  pages.signals.push_back(unlimited(signal));
  signal.name = "angle";
  signal.present_at = {{4, 4}};
  signal.bit = 10;
  signal.width = 12;
  signal.order = protocols::can::ByteOrder::big_endian;
  signal.is_signed = true;
  signal.offset = 100.0;
  pages.signals.push_back(unlimited(signal));
  OwnedSignal speed;
  speed.name = "speed";
  speed.bit = 32;
  speed.width = 32;
  speed.is_signed = speed.is_float = true;
  speed.lower = -1e6;
  speed.upper = 1e6;
  pages.signals.push_back(speed);
  ASSERT_TRUE(well_formed(pages));
  const std::vector<double> third{3, 300.5, -700.5, -1.25};
  const std::vector<double> fourth{4, 300.5, -700.5, 1e9};
  const auto objects = read({pages}, {encode(pages, third), encode(pages, fourth)});
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[1].at("values"), Json({{"page", 3.0}, {"pressure", 300.5}, {"speed", -1.25}}));
  EXPECT_EQ(objects[2].at("values"), Json({{"page", 4.0}, {"angle", -700.5}, {"speed", 1e6}}));
}

// A DBC file that is none of ours: what canmatrix brings along of J1939, 357 messages of many
// hands.
constexpr const char* kPublicFile = "/usr/lib/python3/dist-packages/canmatrix/j1939.dbc";

TEST_F(Dbc, ThePublicJ1939FileIsReadAsCanmatrixReadsIt) {
  std::ifstream file(kPublicFile);
  ASSERT_TRUE(file.good()) << kPublicFile;
  std::ostringstream text;
  text << file.rdbuf();
  const protocols::dbc::Reading reading = protocols::dbc::read(text.str());
  EXPECT_TRUE(reading.findings.empty());
  const auto objects = read_file(kPublicFile, {});
  ASSERT_EQ(objects.size(), 1U);
  const Json& frames = objects[0].at("frames");
  ASSERT_EQ(reading.content.messages.size(), frames.size());
  std::size_t signals = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const OwnedMessage& message = reading.content.messages[i].layout;
    EXPECT_EQ(frames[i].at("id"), message.id) << message.name;
    EXPECT_EQ(frames[i].at("name"), message.name);
    EXPECT_EQ(frames[i].at("size"), message.length) << message.name;
    ASSERT_EQ(frames[i].at("signals").size(), message.signals.size()) << message.name;
    signals += message.signals.size();
  }
  EXPECT_GT(signals, 2000U);
}

TEST_F(Dbc, ANodeOfThePublicFileIsDecodedByCanmatrix) {
  const auto binding = wires_.folder / "slope.yaml";
  std::ofstream(binding) << "dbc: " << kPublicFile << R"yaml(
sends:
  - message: SSI
    period: 10 ms
    priority: 3
    signals:
      - {signal: Pitch_Angle, quantity: inertial.pitch, layout: {scale: 0.002, offset: -64, unit: deg}}
      - {signal: Roll_Angle, quantity: inertial.roll, layout: {scale: 0.002, offset: -64, unit: deg}}
)yaml";
  const hil::DbcNodeDescription device = hil::load_dbc_node(binding.string());
  LastFrames bus;
  emulators::DbcNode<emulators::ImuBackend> node(device.settings, bus);
  ImuSample sample;
  sample.time = kStart + 1ms;
  sample.specific_force_mps2 = {9.80665 * std::sin(0.1), 0.0, 9.80665 * std::cos(0.1)};
  node.update(sample);
  node.advance(kStart + 20ms);
  ASSERT_EQ(bus.last.size(), 1U);
  Frame frame = bus.last.begin()->second;
  EXPECT_EQ(frame.id, 0x0CF01300U) << "the priority that was asked for";
  frame.id = 0x00F01300;  // as the file has it
  const auto objects = read_file(kPublicFile, {frame});
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects[1].at("name"), "SSI");
  const Json& values = objects[1].at("values");  // counts: the file knows no scale
  const auto degrees = [&](const char* name) {
    return values.at(name).get<double>() * 0.002 - 64.0;
  };
  EXPECT_NEAR(degrees("Pitch_Angle"), 0.1 * 180.0 / 3.141592653589793, 0.001);
  EXPECT_NEAR(degrees("Roll_Angle"), 0.0, 0.001);
  EXPECT_EQ(values.at("Pitch_Rate"), 65535.0) << "nobody measures it: not available";
}

TEST_F(Dbc, CanmatrixDecodesTheShippedSlopeSensorByItsOwnFile) {
  const hil::DbcNodeDescription device =
      hil::load_dbc_node(RIGWIRE_SOURCE_DIR "/configs/can/slope_sensor.yaml");
  LastFrames bus;
  emulators::DbcNode<emulators::ImuBackend> node(device.settings, bus);
  ImuSample sample;
  sample.time = kStart;
  sample.temperature_c = 31.0;
  sample.specific_force_mps2 = {-9.80665 * std::sin(0.2), 9.80665 * std::cos(0.2) * std::sin(0.3),
                                9.80665 * std::cos(0.2) * std::cos(0.3)};
  node.update(sample);
  node.advance(kStart + 50ms);
  ASSERT_TRUE(bus.last.contains(0x185));
  const auto objects =
      read_file(RIGWIRE_SOURCE_DIR "/configs/can/slope_sensor.dbc", {bus.last.at(0x185)});
  ASSERT_EQ(objects.size(), 2U);
  const Json& values = objects[1].at("values");
  EXPECT_NEAR(values.at("Pitch").get<double>(), -0.2 * 180.0 / 3.141592653589793, 0.005);
  EXPECT_NEAR(values.at("Roll").get<double>(), 0.3 * 180.0 / 3.141592653589793, 0.005);
  EXPECT_EQ(values.at("Temperature"), 31.0);
  EXPECT_EQ(values.at("State"), 2.0);
  EXPECT_EQ(values.at("Counter"), 2.0);
}

}  // namespace
}  // namespace rigwire
