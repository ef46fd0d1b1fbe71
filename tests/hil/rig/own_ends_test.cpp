// Buses of a rig that end in the test itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::HasSubstr;

class OwnEndsEnd final : public drivers::CanBus {
 public:
  void start(Receiver receiver) override { to_the_bus = std::move(receiver); }
  bool deliver(const Frame& frame, Stamp stamp) override {
    heard.emplace_back(stamp, frame);
    return true;
  }
  bool send(const Frame& /*frame*/) override { return true; }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {}; }

  [[nodiscard]] std::size_t count(std::uint32_t id) const {
    return static_cast<std::size_t>(
        std::ranges::count_if(heard, [id](const auto& one) { return one.second.id == id; }));
  }

  Receiver to_the_bus;
  std::vector<std::pair<Stamp, Frame>> heard;
};

class OwnEndsOfRigs : public testing::Test {
 protected:
  OwnEndsOfRigs() {
    std::ofstream(file_) << "machine: {type: excavator}\n"
                            "buses: {can: {path: "
                         << wires_.can()
                         << "}}\n"
                            "devices: {imu: {type: openimu335ri, bus: can, source_address: 0x81, "
                            "mount: {link: boom}}}\n";
  }
  [[nodiscard]] RigConfiguration configuration(const std::vector<std::string>& sets = {}) const {
    return load_rig(file_.string(), sets).configuration;
  }
  [[nodiscard]] std::string refusal(const std::string& bus, const std::vector<std::string>& sets) {
    try {
      const Rig rig(configuration(sets), io_, {}, nullptr, {.buses = {{bus, &end_}}});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  }

  boost::asio::io_context io_;
  OwnEndsEnd end_;
  rigwire::test::PrivateWires wires_;
  std::filesystem::path file_ = wires_.folder / "rig.yaml";
};

constexpr std::uint32_t kSlope = 0x0CF02981;

TEST_F(OwnEndsOfRigs, HearEachFrameWithItsInstantAndNoWireIsOpened) {
  Rig rig(configuration(), io_, {}, nullptr, {.buses = {{"can", &end_}}});
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.can()));
  static_cast<void>(rig.executive().run_free(kStart + 2s));
  EXPECT_GT(end_.count(kSlope), 150U);
  EXPECT_TRUE(std::ranges::is_sorted(end_.heard, {}, [](const auto& one) { return one.first; }));
  EXPECT_GT(end_.heard.back().first, 1980ms);
  EXPECT_LE(end_.heard.back().first, 2s);
}

TEST_F(OwnEndsOfRigs, AreAnsweredByDevices) {
  Rig rig(configuration(), io_, {}, nullptr, {.buses = {{"can", &end_}}});
  static_cast<void>(rig.executive().run_free(kStart + 1s));
  constexpr std::uint32_t kAddressClaimed = 0x18EEFF81;
  const std::size_t before = end_.count(kAddressClaimed);
  // J1939-21, 5.4.2: request of PGN 60928, to all.
  end_.to_the_bus({.id = 0x18EAFFFE, .extended = true, .length = 3, .data = {0x00, 0xEE, 0x00}});
  static_cast<void>(rig.executive().run_free(kStart + 1100ms));
  EXPECT_EQ(end_.count(kAddressClaimed), before + 1);
}

TEST_F(OwnEndsOfRigs, AreRefusedWhereTheRigHasNoSuchBusOrAsksForMoreWaysOutside) {
  EXPECT_THAT(refusal("cann", {}), HasSubstr("no bus 'cann'"));
  EXPECT_THAT(refusal("can", {"buses.can.ports=2"}), HasSubstr("found 2 ports"));
  EXPECT_THAT(refusal("can", {"buses.can.socketcand.port=29536"}), HasSubstr("29536"));
  EXPECT_EQ(refusal("can", {}), "taken");
}

}  // namespace
}  // namespace rigwire::hil
