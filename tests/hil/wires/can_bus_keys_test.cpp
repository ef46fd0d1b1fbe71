// A bus's keys: nodes, client, faults.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class CanBusKeys : public testing::Test {
 protected:
  /// The excavator pit with this text as its buses.
  RigConfiguration load(const std::string& bus, const std::vector<std::string>& sets = {}) {
    const std::string pit = std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/excavator_pit.yaml";
    std::ofstream(file_) << "include: " << pit << "\nbuses:\n  can:\n" << bus;
    return load_rig(file_, sets).configuration;
  }
  std::string complaints(const std::string& bus, const std::vector<std::string>& sets = {}) {
    try {
      (void)load(bus, sets);
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  rigwire::test::PrivateWires wires_;
  std::string file_ = (wires_.folder / "rig.yaml").string();
};

TEST_F(CanBusKeys, NodesAndClient) {
  const auto bus =
      load(
          "    order: priority\n    one_shot: true\n    restarts: false\n    acknowledger: false\n"
          "    slcan_dialect: kernel\n    wire: slcan\n")
          .buses.at("can");
  EXPECT_EQ(bus.order, emulators::CanQueueOrder::priority);
  EXPECT_TRUE(bus.one_shot);
  EXPECT_FALSE(bus.restarts);
  EXPECT_FALSE(bus.acknowledger);
  EXPECT_EQ(bus.slcan_dialect, drivers::SlcanDialect::kernel);
  EXPECT_EQ(bus.wire, CanWire::slcan);
}

TEST_F(CanBusKeys, PortsAndServer) {
  const auto bus = load(
                       "    ports: 3\n    socketcand: {port: 29536, beacon: true, "
                       "error_mask: 0x1FFFFFFF}\n    faults:\n"
                       "      - {type: unplugged, at: 1 s, device: client.2}\n"
                       "      - {type: unplugged, at: 1 s, device: client.socketcand}\n")
                       .buses.at("can");
  EXPECT_EQ(bus.ports, 3U);
  EXPECT_EQ(bus.socketcand.port, 29536U);
  EXPECT_TRUE(bus.socketcand.beacon);
  EXPECT_EQ(bus.socketcand.error_mask, 0x1FFFFFFFU);
  EXPECT_EQ(BusConfiguration{}.ports, 1U);
  EXPECT_EQ(BusConfiguration{}.socketcand.port, 0U) << "nobody listens unless told to";
}

TEST_F(CanBusKeys, PortsThatAreTakenOrAreNotThereAreRefused) {
  EXPECT_THAT(complaints("    ports: 2\n  other: {path: /tmp/rigwire/can.1}\n"),
              HasSubstr("already taken by"));
  EXPECT_THAT(complaints("    socketcand: {port: 1502}\n"), HasSubstr("already taken by"));
  EXPECT_THAT(complaints("    socketcand: {port: 29536, address: 192.168.1.5}\n"),
              HasSubstr("allow_remote"));
  EXPECT_THAT(complaints("    ports: 2\n    faults:\n"
                         "      - {type: unplugged, at: 1 s, device: client.2}\n"),
              HasSubstr("client.1"));
  EXPECT_THAT(complaints("    faults:\n"
                         "      - {type: unplugged, at: 1 s, device: client.socketcand}\n"),
              HasSubstr("not on this bus"));
  EXPECT_THAT(complaints("    ports: 17\n"), HasSubstr("allowed 1 .. 16"));
}

TEST_F(CanBusKeys, FaultsAsTheBusModelTakesThem) {
  const auto bus = load(R"(    faults:
      - {type: noise, at: 1 s, for: 2 s, bit_error_rate: 0.001}
      - {type: disturbance, at: 1 s}
      - {type: disturbance, at: 1 s, bit: 20}
      - {type: short, at: 1 s}
      - {type: wrong_rate, at: 1 s, device: imu_boom, bitrate: 500000}
      - {type: unplugged, at: 1 s, device: client}
      - {type: inserted, at: 1 s, frame: 18EAFFFE#00EE00, period: 5 ms}
      - {type: masquerade, at: 1 s, address: 0x81, name: 0x8000830066E12345}
)")
                       .buses.at("can");
  using namespace emulators;
  const auto& faults = bus.faults;
  EXPECT_NO_THROW(validate(CanBusFaults{faults}));
  ASSERT_EQ(faults.size(), 8U);
  EXPECT_EQ(faults[0].when, (FaultPeriod{std::chrono::seconds(1), std::chrono::seconds(2)}));
  EXPECT_EQ(std::get<DisturbanceFault>(faults[1].what).bit, -1);
  EXPECT_EQ(std::get<DisturbanceFault>(faults[2].what).bit, 20);
  EXPECT_TRUE(std::holds_alternative<ShortCircuitFault>(faults[3].what));
  EXPECT_EQ(node_of(faults[4]), "imu_boom");
  EXPECT_EQ(std::get<WrongRateFault>(faults[4].what).bit_rate_bps, 500'000U);
  EXPECT_EQ(node_of(faults[5]), kCanOutsideName);
  const auto& intruder = std::get<IntruderFault>(faults[6].what);
  EXPECT_EQ(frame_of(intruder).id, 0x18EAFFFEU);
  EXPECT_EQ(intruder.period, std::chrono::milliseconds(5));
  const auto claim = frame_of(std::get<DuplicateAddressFault>(faults[7].what));
  EXPECT_EQ(claim.id, 0x18EEFF81U);
  EXPECT_EQ(claim.data,
            (std::array<std::uint8_t, 8>{0x45, 0x23, 0xE1, 0x66, 0x00, 0x83, 0x00, 0x80}));
}

TEST_F(CanBusKeys, FaultOfADeviceThatIsNotOnTheBus) {
  EXPECT_THAT(complaints("    faults: [{type: unplugged, at: 1 s, device: imu_bom}]\n"),
              HasSubstr("buses.can.faults.0.device: not on this bus"));
  EXPECT_THAT(complaints("    faults: [{type: unplugged, at: 1 s, device: gnss}]\n"),
              HasSubstr("buses.can.faults.0.device: not on this bus"));
}

TEST_F(CanBusKeys, DeviceNamedAsTheClientsNodeIsRefusedBeforeTheRun) {
  EXPECT_THAT(
      complaints("    wire: slcan\n", {"devices.client={type: openimu335ri, bus: can, "
                                       "source_address: 0x90, serial: 90, mount: {link: boom}}"}),
      HasSubstr("devices.client: the name of a client's node on its bus"));
}

TEST_F(CanBusKeys, IntruderWithoutAFrame) {
  EXPECT_THAT(complaints("    faults: [{type: inserted, at: 1 s, frame: hello}]\n"),
              AllOf(HasSubstr("buses.can"), HasSubstr("frame"), HasSubstr("hello")));
}

TEST_F(CanBusKeys, OneAddressTwiceIsAnErrorUnlessItIsWanted) {
  const std::vector<std::string> twice{"devices.imu_boom.source_address=0x80"};
  EXPECT_THAT(complaints("    queue: 64\n", twice), HasSubstr("already taken"));
  EXPECT_EQ(complaints("    duplicate_addresses: true\n", twice), "");
}

TEST_F(CanBusKeys, MoreFramesThanTheRateCarries) {
  EXPECT_THAT(complaints("    bitrate: 100000\n"), HasSubstr("buses.can.bitrate"));
}

}  // namespace
}  // namespace rigwire::hil
