// The rig with CAN devices of a user's own, run as it is shipped, and a controller that knows the
// two DBC files and nothing else: canmatrix encodes and decodes, python-can is on the wire, both
// unmodified. What the controller reads is held to the ground truth.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;
using Json = nlohmann::json;

/// Moves the boom for a second, falls silent, sends set points with a wrong checksum, and asks the
/// sensor who it is. Its clock are the sensor's messages, 50 a second of the rig's time. Prints one
/// object.
constexpr const char* kController = R"py(
import json, os, sys, time
from decimal import Decimal
import can
import canmatrix.canmatrix as cm, canmatrix.formats

folder, path = sys.argv[1], sys.argv[2]
slope = canmatrix.formats.loadp_flat(folder + '/slope_sensor.dbc')
valves = canmatrix.formats.loadp_flat(folder + '/valve_block.dbc')
files = {f.arbitration_id.id: f for db in (slope, valves) for f in db.frames}
while not os.path.exists(path):
    time.sleep(0.1)
bus = can.Bus(interface='slcan', channel=path, bitrate=250000, sleep_after_open=0)

def crc8_j1850(data):
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF

heard = []
slopes_heard = 0
def listen(seconds):
    """Until the sensor has sent what it sends in that time."""
    global slopes_heard
    until = slopes_heard + round(seconds * 50)
    while slopes_heard < until:
        message = bus.recv(200)
        assert message is not None
        frame = files[message.arbitration_id]
        slopes_heard += frame.name == 'Slope'
        values = {k: float(v.phys_value) for k, v in frame.decode(bytes(message.data)).items()}
        heard.append((frame.name, values, bytes(message.data)))

def last(name, signal):
    return [v[signal] for n, v, _ in heard if n == name][-1]

def drive(opening, seconds, broken=0):
    global count
    for _ in range(round(seconds * 50)):
        boom = files[512].signal_by_name('Boom').phys2raw(Decimal(opening))
        data = bytearray(files[512].encode({'Boom': boom, 'Arm': 0, 'Counter': count, 'Checksum': 0}))
        check = 0
        for byte in data[:7]:
            check ^= byte
        data[7] = check ^ broken
        count = (count + 1) % 256
        bus.send(can.Message(arbitration_id=512, is_extended_id=False, data=data))
        listen(0.02)

def until(reached, go_on):
    """A busy machine may hold up the rig, or this program."""
    end = time.monotonic() + 60
    while not reached() and time.monotonic() < end:
        go_on()

count = 0
listen(1.0)
until(lambda: any(name == 'Slope' for name, _, _ in heard), lambda: listen(0.2))
start = last('Slope', 'Pitch')
until(lambda: last('Spools', 'BoomSpool') > 30.0, lambda: drive(40.0, 0.5))
driven = {'spool': last('Spools', 'BoomSpool'), 'echo': last('Spools', 'EchoBoom')}
until(lambda: abs(last('Spools', 'BoomSpool')) < 0.2, lambda: listen(0.3))
silent = last('Spools', 'BoomSpool')
drive(80.0, 0.4, broken=1)
refused = {'spool': last('Spools', 'BoomSpool'), 'echo': last('Spools', 'EchoBoom')}
for code in (1, 2):
    bus.send(can.Message(arbitration_id=901, is_extended_id=False, data=[0, code]))
    listen(0.2)
listen(1.5)
slopes = [(v, data) for n, v, data in heard if n == 'Slope']
print(json.dumps({
    'start_deg': start, 'end_deg': last('Slope', 'Pitch'), 'frames': len(slopes),
    'states': sorted({v['State'] for v, _ in slopes}),
    'gaps': sum((b['Counter'] - a['Counter']) % 16 != 1 for (a, _), (b, _) in zip(slopes, slopes[1:])),
    'wrong': sum(crc8_j1850(data[:7]) != data[7] for _, data in slopes),
    'driven': driven, 'silent': silent, 'refused': refused,
    'identity': [v for n, v, _ in heard if n == 'Identity']}))
bus.shutdown()
)py";

TEST(DbcNodeLive, AControllerThatKnowsTheDbcFilesAloneMovesTheBoom) {
  const test::PrivateWires wires;
  const auto truth = wires.folder / "truth.jsonl";
  ChildProcess run(
      {RIGWIRE_BINARY_DIR "/rigwire", "run", "excavator_own_can", "--status", "none", "--truth",
       truth.string(), "--set", "buses.can.wire=slcan", "--set", "buses.can.path=" + wires.can()},
      wires.folder / "rig.log");
  const auto controller = wires.folder / "controller.py";
  std::ofstream(controller) << kController;
  ChildProcess client(
      {"/usr/bin/python3", controller.string(), RIGWIRE_SOURCE_DIR "/configs/can", wires.can()},
      wires.folder / "controller.log");
  EXPECT_EQ(client.wait(), 0) << client.output() << run.output();
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 130) << run.output();

  // The libraries say on the same stream which formats they lack.
  const auto begin = client.output().find('{');
  ASSERT_NE(begin, std::string::npos) << client.output();
  const Json told =
      Json::parse(client.output().substr(begin, client.output().find('\n', begin) - begin));

  EXPECT_GT(told.at("frames"), 150) << told;
  EXPECT_EQ(told.at("gaps"), 0) << told;
  EXPECT_EQ(told.at("wrong"), 0) << told;
  EXPECT_EQ(told.at("states"), Json::array({2.0})) << told;
  EXPECT_GT(told.at("driven").at("spool"), 30.0) << told;
  EXPECT_EQ(told.at("driven").at("echo"), 40.0) << told;
  EXPECT_NEAR(told.at("silent").get<double>(), 0.0, 0.2) << told;
  EXPECT_NEAR(told.at("refused").at("spool").get<double>(), 0.0, 0.2) << told;
  EXPECT_EQ(told.at("refused").at("echo"), 40.0) << told;
  EXPECT_EQ(told.at("identity"), Json::parse(R"([{"Page": 0.0, "SerialNumber": 4711.0},
                                                 {"Page": 1.0, "Revision": 1.02}])"));

  // The boom stands still at both ends; the sensor is aligned with it.
  std::ifstream lines(truth);
  std::string first;
  std::getline(lines, first);
  std::string last = first;
  for (std::string line; std::getline(lines, line);) {
    last = line;
  }
  const auto boom_deg = [](const std::string& line) {
    return Json::parse(line).at("joint_rad").at(1).get<double>() * 180.0 / std::numbers::pi;
  };
  EXPECT_GT(std::abs(boom_deg(last) - boom_deg(first)), 2.0);
  EXPECT_NEAR(told.at("start_deg").get<double>(), boom_deg(first), 0.05);
  EXPECT_NEAR(told.at("end_deg").get<double>(), boom_deg(last), 0.05);
}

}  // namespace
}  // namespace rigwire
