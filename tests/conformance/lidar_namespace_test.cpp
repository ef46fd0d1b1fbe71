// The recipe of docs/lidar-network.md: in a network of its own the lidar's packets and its web page
// come from a real sensor's address, so that clients that filter on it work.
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

TEST(LidarNamespace, DriverThatFiltersOnTheSensorsAddressHearsIt) {
  const test::PrivateWires wires;
  const auto rig = wires.folder / "rig.yaml";
  std::ofstream(rig) << "machine: {include: " RIGWIRE_SOURCE_DIR
                        "/configs/machines/gator_855d.yaml}\n"
                        "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                        "devices:\n  lidar:\n    type: velodyne-vlp-16\n"
                        "    allow_remote: true\n    address: 255.255.255.255\n"
                        "    source_address: 192.168.1.201\n"
                        "    web: {address: 192.168.1.201, port: 80}\n"
                        "    mount: {link: body, position: [0 m, 0 m, 2 m]}\n";
  // The client does as a driver: it is bound to all addresses and drops what is not from the
  // sensor. It then sends the stream to itself alone.
  const auto client = wires.folder / "client.py";
  std::ofstream(client) << R"(
import json, socket, subprocess, sys, time, urllib.request
link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
link.bind(('', 2368))
link.settimeout(200)
rig = subprocess.Popen(sys.argv[1:])
def hear(count):
    heard = 0
    while heard < count:
        packet, source = link.recvfrom(2000)
        if source[0] == '192.168.1.201':
            assert len(packet) == 1206
            heard += 1
try:
    hear(100)
    with urllib.request.urlopen('http://192.168.1.201/cgi/settings.json', timeout=200) as answer:
        assert json.loads(answer.read())['host']['addr'] == '255.255.255.255'
    with urllib.request.urlopen('http://192.168.1.201/cgi/setting/host',
                                data=b'addr=192.168.1.100', timeout=200) as answer:
        assert answer.status == 204
    hear(100)
finally:
    rig.terminate()
    rig.wait()
print('heard')
)";
  ChildProcess network(
      {RIGWIRE_SOURCE_DIR "/scripts/lidar-namespace.sh", "run", "/usr/bin/python3", client.string(),
       RIGWIRE_BINARY_DIR "/rigwire", "run", rig.string(), "--status", "none"},
      wires.folder / "network.log");
  EXPECT_EQ(network.wait(), 0) << network.output();
  EXPECT_THAT(network.output(), testing::HasSubstr("heard"));
}

}  // namespace
}  // namespace rigwire
