// Runs with wires of their own: nothing that two of them would fight for stays the rig's.
#include "hil/rig/isolated_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "hil/command_line/config_files.h"
#include "hil/configuration/outline.h"
#include "private_wires.h"
#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcapng.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::Field;
using testing::HasSubstr;
using testing::StartsWith;

class IsolatedRig : public testing::Test {
 protected:
  [[nodiscard]] LoadedRig load(const std::string& text) const {
    const fs::path file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {type: excavator}\n" << text;
    return load_rig(file.string(), {});
  }
  [[nodiscard]] static RigConfiguration isolated(const LoadedRig& rig, const fs::path& folder,
                                                 drivers::LoopbackClaims& claims) {
    return with(rig.configuration, isolating(rig.configuration, rig.origins, folder, claims));
  }

  rigwire::test::PrivateWires wires;
};

/// Every key of the configuration with its value.
std::map<std::string, std::string> values_of(const RigConfiguration& configuration) {
  std::map<std::string, std::string> values;
  const std::function<void(const std::string&, const OutlineNode&)> walk =
      [&](const std::string& at, const OutlineNode& node) {
        for (const OutlineNode& child : node.children) {
          values[at + child.key] = child.canonical;
          walk(at + child.key + ".", child);
        }
      };
  walk("", outline(configuration));
  return values;
}

/// What a wire or a written file is found by, as far as names tell, wherever this clone stands. TCP
/// ports may stay where the address beside them does not.
bool is_place(const std::string& key, const std::string& value) {
  const std::string name = key.substr(key.rfind('.') + 1);
  const bool read = value.starts_with(RIGWIRE_SOURCE_DIR "/configs/");
  return ((value.starts_with("/tmp/") && !read) || value.starts_with("127.") ||
          name == "position_port") &&
         !value.empty();
}

TEST_F(IsolatedRig, TwoRunsOfAnyShippedRigShareNoPlace) {
  for (const ConfigFile& file : config_files("rigs")) {
    const LoadedRig rig = load_rig(file.path, {});
    drivers::LoopbackClaims first_claims;
    drivers::LoopbackClaims second_claims;
    const auto first = values_of(isolated(rig, wires.folder / "1", first_claims));
    const auto second = values_of(isolated(rig, wires.folder / "2", second_claims));
    for (const auto& [key, value] : first) {
      if (is_place(key, value)) {
        EXPECT_NE(second.at(key), value) << file.name << ": " << key;
      }
    }
  }
}

TEST_F(IsolatedRig, NothingElseOfARigChanges) {
  const LoadedRig rig = load_rig(find_rig("excavator_pit"), {});
  drivers::LoopbackClaims claims;
  const std::vector<Replacement> replacements =
      isolating(rig.configuration, rig.origins, wires.folder, claims);
  auto before = values_of(rig.configuration);
  auto after = values_of(with(rig.configuration, replacements));
  for (const Replacement& replacement : replacements) {
    EXPECT_EQ(after[replacement.key], replacement.value);
    before.erase(replacement.key);
    after.erase(replacement.key);
  }
  // What a bus on slcan has no use for.
  before.erase("buses.can.interface");
  before.erase("buses.can.attach");
  EXPECT_EQ(after, before);
}

TEST_F(IsolatedRig, AddressesThatDifferStayDifferentAndEqualOnesEqual) {
  const LoadedRig rig = load(
      "devices:\n"
      "  one: {type: velodyne-vlp-16, address: 127.0.0.1}\n"
      "  two: {type: velodyne-vlp-16, address: 127.9.9.1, port: 2369, position_port: 8309}\n"
      "  three: {type: velodyne-vlp-16, address: 127.0.0.1, port: 2370, position_port: 8310}\n");
  drivers::LoopbackClaims claims;
  const auto values = values_of(isolated(rig, wires.folder, claims));
  EXPECT_EQ(values.at("devices.one.address"), claims.address(1));
  EXPECT_EQ(values.at("devices.three.address"), claims.address(1));
  EXPECT_EQ(values.at("devices.two.address"), claims.address(2));
}

TEST_F(IsolatedRig, AnAddressBeyondThisMachineIsRefusedWithItsPlace) {
  const LoadedRig rig = load(
      "devices:\n"
      "  lidar: {type: velodyne-vlp-16, address: 192.168.1.77, allow_remote: true}\n");
  drivers::LoopbackClaims claims;
  try {
    (void)isolating(rig.configuration, rig.origins, wires.folder, claims);
    FAIL() << "isolated";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("rig.yaml:3:"), HasSubstr("devices.lidar.address"),
                                    HasSubstr("192.168.1.77"), HasSubstr("127.")));
  }
}

TEST_F(IsolatedRig, ABusOfTheHostBecomesAPtyAndAnAdapterIsNotAttached) {
  const LoadedRig rig = load(
      "buses:\n"
      "  host: {wire: socketcan, interface: can7}\n"
      "  adapter: {wire: gs_usb}\n"
      "devices: {}\n");
  drivers::LoopbackClaims claims;
  const auto values = values_of(isolated(rig, wires.folder, claims));
  EXPECT_EQ(values.at("buses.host.wire"), "slcan");
  EXPECT_EQ(values.at("buses.host.path"), (wires.folder / "wires" / "host").string());
  EXPECT_EQ(values.at("buses.adapter.wire"), "gs_usb");
  EXPECT_EQ(values.at("buses.adapter.attach"), "false");
}

TEST_F(IsolatedRig, ABusAndADeviceOfOneNameHaveTwoLinks) {
  const LoadedRig rig = load(
      "buses:\n"
      "  gnss: {wire: slcan}\n"
      "devices:\n"
      "  gnss: {type: ublox-neo-7p, path: /tmp/rigwire/gnss}\n");
  drivers::LoopbackClaims claims;
  const auto values = values_of(isolated(rig, wires.folder, claims));
  EXPECT_NE(values.at("buses.gnss.path"), values.at("devices.gnss.path"));
}

TEST_F(IsolatedRig, WhatADeviceSavesIsACopy) {
  const fs::path saved = wires.folder / "imu.memory";
  std::ofstream(saved) << "saved";
  const LoadedRig rig = load(
      "buses:\n"
      "  can: {wire: slcan}\n"
      "devices:\n"
      "  imu: {type: openimu335ri, bus: can, settings_file: " +
      saved.string() + "}\n");
  drivers::LoopbackClaims claims;
  const auto replacements = isolating(rig.configuration, rig.origins, wires.folder / "own", claims);
  const fs::path copy = wires.folder / "own" / "memory" / "imu";
  EXPECT_THAT(replacements, Contains(AllOf(Field(&Replacement::key, "devices.imu.settings_file"),
                                           Field(&Replacement::value, copy.string()))));
  std::ifstream file(copy);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "saved");
}

TEST_F(IsolatedRig, WhereAReplayedFileCameFromIsNoPlaceOfTheRun) {
  const fs::path log = wires.folder / "a.pcap";
  {
    protocols::pcapng::Bytes bytes;
    protocols::pcapng::append(bytes, protocols::pcapng::Section{});
    protocols::pcapng::append(bytes, protocols::pcapng::Interface{});
    protocols::pcapng::Bytes datagram;
    const std::uint8_t byte = 0x5A;
    protocols::pcapng::append_udp(datagram, {0xC0A801C9, 443}, {0x7F000001, 2368}, {&byte, 1});
    protocols::pcapng::Packet packet;
    packet.bytes = datagram;
    protocols::pcapng::append(bytes, packet);
    std::ofstream(log, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  const LoadedRig rig = load(
      "devices:\n"
      "  one: {type: replay, wire: udp, address: 127.0.0.1, port: 2368, source: {file: " +
      log.string() +
      ", from_address: 192.168.1.201}}\n"
      "  two: {type: replay, wire: udp, address: 127.0.0.9, port: 0, source: {file: " +
      log.string() + "}}\n");
  drivers::LoopbackClaims claims;
  const auto values = values_of(isolated(rig, wires.folder, claims));
  EXPECT_EQ(values.at("devices.one.source.from_address"), "192.168.1.201");
  EXPECT_EQ(values.at("devices.one.address"), claims.address(1));
  EXPECT_NE(values.at("devices.one.port"), "2368");
  EXPECT_EQ(values.at("devices.two.port"), "0") << "as recorded";
}

TEST_F(IsolatedRig, FilesOfTruthAreWrittenIntoTheFolder) {
  const LoadedRig rig = load("truth: {path: /tmp/rigwire/truth.csv}\ndevices: {}\n");
  drivers::LoopbackClaims claims;
  const auto values = values_of(isolated(rig, wires.folder, claims));
  EXPECT_EQ(values.at("truth.path"), (wires.folder / "truth.csv").string());
  EXPECT_EQ(values.at("truth.lidar_path"), "");
}

}  // namespace
}  // namespace rigwire::hil
