// Several programs on one bus of a host without CAN: Debian's python-can, unmodified, on two slcan
// ports and two connections to the socketcand at once. `rigwire run` as a process, in real time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;

/// 60 frames a second: python-can 4.1 loses frames of a socketcand when it is far behind. Each bus
/// is read by a thread of its own. Frames of devices are compared where all buses have them; then
/// each bus sends one frame, and all others must hear it.
constexpr const char* kClient = R"(
import os, sys, threading, time
import can
path, port = sys.argv[1], int(sys.argv[2])
def eventually(what, look):
    end = time.monotonic() + 200
    while not look():
        assert time.monotonic() < end, what
        time.sleep(0.02)
eventually('the second port', lambda: os.path.exists(path + '.1'))
def socketcand(name):
    for _ in range(1000):
        try:
            return can.Bus(interface='socketcand', host='127.0.0.1', port=port, channel=name)
        except OSError:
            time.sleep(0.2)
buses = {
    'slcan': can.Bus(interface='slcan', channel=path, bitrate=250000, sleep_after_open=0),
    'slcan.1': can.Bus(interface='slcan', channel=path + '.1', bitrate=250000, sleep_after_open=0),
    'socketcand': socketcand('can'),
    'socketcand.2': socketcand('vcan0')}
heard = {name: [] for name in buses}
running = True
def listen(name):
    while running:
        message = buses[name].recv(0.1)
        if message is not None:
            heard[name].append((message.arbitration_id, bytes(message.data)))
threads = [threading.Thread(target=listen, args=(name,)) for name in buses]
for thread in threads:
    thread.start()
eventually('frames', lambda: all(len(frames) > 200 for frames in heard.values()))
own = {}
for i, name in enumerate(buses):
    own[name] = 0x18FF5000 + i
    buses[name].send(can.Message(arbitration_id=own[name], is_extended_id=True, data=[i, 1, 2]))
    eventually('what %s sent' % name, lambda: all(
        any(frame[0] == own[name] for frame in heard[other]) for other in buses if other != name))
running = False
for thread in threads:
    thread.join()
def of_devices(name):
    return [frame for frame in heard[name] if frame[0] not in own.values()]
# The middle of what one has heard is in the others' as it is: nothing lost, nothing out of order.
sample = of_devices('slcan')
sample = sample[len(sample) // 3:2 * len(sample) // 3]
print('compared', len(sample) > 60)
for name in buses:
    frames = of_devices(name)
    places = [i for i, frame in enumerate(frames) if frame == sample[0]]
    same = any(frames[i:i + len(sample)] == sample for i in places)
    others = [n for n in own if n != name and any(f[0] == own[n] for f in heard[name])]
    itself = any(f[0] == own[name] for f in heard[name])
    print(name, same, len(others), itself)
    if not same or len(others) != 3:
        print(len(frames), len(sample), others, file=sys.stderr)
for bus in buses.values():
    bus.shutdown()
)";

TEST(CanPorts, FourPythonCansHearTheWholeBusAndEachOther) {
  const test::PrivateWires wires;
  const auto port = test::free_port(SOCK_STREAM);
  const auto rig = wires.folder / "rig.yaml";
  std::ofstream(rig) << "machine: {include: " RIGWIRE_SOURCE_DIR
                        "/configs/machines/gator_855d.yaml}\n"
                        "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                        "buses:\n  can: {wire: slcan, ports: 2, path: "
                     << wires.can() << ", socketcand: {port: " << port
                     << "}}\n"
                        "devices:\n"
                        "  imu: {type: openimu335ri, bus: can, rate: 20 Hz, mount: {link: body}}\n";
  const auto client = wires.folder / "client.py";
  std::ofstream(client) << kClient;
  ChildProcess run({RIGWIRE_BINARY_DIR "/rigwire", "run", rig.string(), "--status", "none"},
                   wires.folder / "rig.log");
  ChildProcess clients({"/usr/bin/python3", client.string(), wires.can(), std::to_string(port)},
                       wires.folder / "clients.log");
  EXPECT_EQ(clients.wait(), 0) << clients.output() << run.output();
  EXPECT_THAT(clients.output(),
              testing::HasSubstr("compared True\nslcan True 3 False\nslcan.1 True 3 False\n"
                                 "socketcand True 3 False\nsocketcand.2 True 3 False\n"));
  run.signal(SIGINT);
  EXPECT_EQ(run.wait(), 130) << run.output();
  EXPECT_FALSE(std::filesystem::is_symlink(wires.can() + ".1"));
}

}  // namespace
}  // namespace rigwire
