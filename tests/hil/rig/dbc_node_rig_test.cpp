// The excavator with CAN devices of a user's own, in process: what its slope sensor says is where
// the boom is, and its valve block moves it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"
#include "emulators/dbc_node/settings.h"
#include "hil/configuration/problems.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using testing::HasSubstr;

constexpr const char* kRigFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_own_can.yaml";

/// A bus that ends here; calls `each` with every frame.
class End final : public drivers::CanBus {
 public:
  void start(Receiver receiver) override { to_the_bus = std::move(receiver); }
  bool deliver(const Frame& frame, Stamp stamp) override {
    each(frame, stamp);
    return true;
  }
  bool send(const Frame& /*frame*/) override { return true; }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {}; }

  Receiver to_the_bus;
  std::function<void(const Frame&, Stamp)> each = [](const Frame&, Stamp) {};
};

double angle_deg(const Frame& frame, std::size_t byte) {
  return 0.01 * static_cast<std::int16_t>(frame.data[byte] | frame.data[byte + 1] << 8);
}
double share(const Frame& frame, std::size_t byte) {
  return 1e-3 * static_cast<std::int16_t>(frame.data[byte] << 8 | frame.data[byte + 1]);
}

class OwnCanRig : public testing::Test {
 protected:
  [[nodiscard]] RigConfiguration configuration(std::vector<std::string> sets = {}) const {
    sets.push_back("buses.can.wire=slcan");
    sets.push_back("buses.can.path=" + wires_.can());
    return load_rig(kRigFile, sets).configuration;
  }
  std::string refusal(const std::vector<std::string>& sets) const {
    try {
      (void)configuration(sets);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }

  boost::asio::io_context io_;
  rigwire::test::PrivateWires wires_;
  End end_;
};

TEST_F(OwnCanRig, TheSlopeSensorSaysHowTheBoomStands) {
  const std::string truth = (wires_.folder / "truth.ndjson").string();
  std::vector<std::pair<drivers::CanBus::Stamp, Frame>> slopes;
  end_.each = [&](const Frame& frame, drivers::CanBus::Stamp stamp) {
    if (frame.id == 0x185) {
      slopes.emplace_back(stamp, frame);
    }
  };
  {
    Rig rig(configuration(), io_, {truth, {}}, nullptr, {.buses = {{"can", &end_}}});
    static_cast<void>(rig.executive().run_free(kStart + 2s));
  }
  ASSERT_NEAR(static_cast<double>(slopes.size()), 100.0, 1.0);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const auto& data = slopes[i].second.data;
    EXPECT_EQ(data[4] >> 4, static_cast<int>(i % 16)) << "counter";
    EXPECT_EQ(data[4] & 0xF, 2) << "Measuring";
    EXPECT_EQ(data[7], emulators::checksum(emulators::DbcChecksum::crc8_j1850, data, 7));
  }
  std::ifstream lines(truth);
  std::string line;
  std::string last;
  while (std::getline(lines, line)) {
    last = line;
  }
  const auto record = nlohmann::json::parse(last);
  // The boom's joint against the upper structure, nose up negative in joint coordinates.
  const double joint_deg = record["joint_rad"][1].get<double>() * 180.0 / 3.14159265358979;
  EXPECT_NEAR(std::abs(angle_deg(slopes.back().second, 0)), std::abs(joint_deg), 1.0)
      << "noise of the accelerometer, filtered, and the carrier's own slope";
}

TEST_F(OwnCanRig, SetPointsMoveTheBoomAndSilenceStopsIt) {
  std::vector<std::pair<drivers::CanBus::Stamp, double>> spools;
  std::uint8_t count = 0;
  drivers::CanBus::Stamp next_set = 200ms;
  end_.each = [&](const Frame& frame, drivers::CanBus::Stamp stamp) {
    if (frame.id != 0x280) {
      return;
    }
    spools.emplace_back(stamp, share(frame, 0));
    if (stamp >= next_set && stamp < 800ms) {
      next_set = stamp + 40ms;
      Frame set;
      set.id = 0x200;
      set.length = 8;
      set.data[0] = 0x01;  // 500 counts of 0.1 %
      set.data[1] = 0xF4;
      set.data[6] = count++;
      set.data[7] = emulators::checksum(emulators::DbcChecksum::xor8, set.data, 7);
      end_.to_the_bus(set);
    }
  };
  Rig rig(configuration(), io_, {}, nullptr, {.buses = {{"can", &end_}}});
  static_cast<void>(rig.executive().run_free(kStart + 1500ms));
  const auto at = [&](drivers::CanBus::Stamp when) {
    double value = 0.0;
    for (const auto& [stamp, spool] : spools) {
      value = stamp <= when ? spool : value;
    }
    return value;
  };
  EXPECT_NEAR(at(190ms), 0.0, 0.005);
  EXPECT_NEAR(at(780ms), 0.5, 0.01);
  EXPECT_NEAR(at(1490ms), 0.0, 0.005) << "100 ms after the last set point, and the spool's way";
}

TEST_F(OwnCanRig, WhatDoesNotFitTheRigIsRefusedWithItsKey) {
  EXPECT_EQ(refusal({}), "");
  EXPECT_THAT(refusal({"devices.valves.file=" RIGWIRE_SOURCE_DIR "/configs/can/slope_sensor.yaml"}),
              HasSubstr("found valves, allowed inertial"));
  EXPECT_THAT(refusal({"devices.slope.attached.mount.link=wing"}), HasSubstr("no such link"));
  EXPECT_THAT(refusal({"devices.valves.attached.sections=[boom, wing]"}), HasSubstr("sections"));
  EXPECT_THAT(refusal({"devices.slope.source_address=3"}), HasSubstr("claims no address"));
  EXPECT_THAT(refusal({"devices.slope.faults=[{type: silent, at: 1 s, message: Slop}]"}),
              HasSubstr("\"Slop\""));
  EXPECT_THAT(refusal({"devices.valves.file=nowhere.yaml"}), HasSubstr("nowhere.yaml"));
}

TEST_F(OwnCanRig, ItsMessagesStandInTheBusesDbcFile) {
  EXPECT_EQ(bus_messages(configuration(), "can").size(), 5U)
      << "Slope, Identity and Ask, SetPoints and Spools";
}

}  // namespace
}  // namespace rigwire::hil
