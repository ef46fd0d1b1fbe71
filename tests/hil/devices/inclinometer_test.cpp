// The inclinometer in a rig: its keys, its node on the bus, and its slopes beside the truth.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "fields/constants.h"
#include "hil/configuration/problems.h"
#include "hil/devices/device_types.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// A utility vehicle that stands across a slope, with one bus.
class InclinometerRig : public testing::Test {
 protected:
  LoadedRig load(const std::string& devices, const std::string& of_bus = "") const {
    const std::string file = (wires_.folder / "rig.yaml").string();
    std::ofstream(file) << "scene:\n  terrain: {type: level, size: 60 m, cell: 1 m, roughness: 0 "
                           "mm, slope: {rise: 0.1}}"
                           "\nmachine: {include: "
                        << RIGWIRE_SOURCE_DIR << "/configs/machines/gator_855d.yaml, yaw: 30 deg}\n"
                        << "buses:\n  can: {wire: slcan, path: " << wires_.can() << of_bus
                        << "}\ndevices:\n"
                        << devices;
    return load_rig(file, {});
  }
  std::string complaints(const std::string& devices, const std::string& of_bus = "") const {
    try {
      (void)load(devices, of_bus);
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  /// Complaints about one inclinometer with these keys.
  std::string complaints_of(const std::string& keys) const {
    return complaints("  boom: {type: cia410-inclinometer, mount: {link: body}, " + keys + "}\n");
  }

  rigwire::test::PrivateWires wires_;
};

/// Slopes in deg as a client of the bus reads them, the latest of each.
class Client final : public EventSource {
 public:
  explicit Client(const std::string& path)
      : line_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    EXPECT_EQ(::write(line_, "O\r", 2), 2);
  }
  ~Client() override { ::close(line_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] SimTime next_event() const override { return next_; }
  [[nodiscard]] SimTime next_wakeup() const override { return next_; }
  void advance(SimTime now) override {
    while (next_ <= now) {
      next_ += 10ms;
    }
    std::array<char, 4096> bytes{};
    for (ssize_t count = ::read(line_, bytes.data(), bytes.size()); count > 0;
         count = ::read(line_, bytes.data(), bytes.size())) {
      text_.append(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  /// Longitudinal and lateral slope of the last TPDO1 of that node, deg.
  [[nodiscard]] std::optional<std::array<double, 2>> slopes_deg(std::string_view id) const {
    const std::size_t at = text_.rfind("t" + std::string(id) + "4");
    if (at == std::string::npos || at + 13 > text_.size()) {
      return std::nullopt;
    }
    const auto slope = [&](std::size_t place) {
      const auto low = std::stoul(text_.substr(at + place, 2), nullptr, 16);
      const auto high = std::stoul(text_.substr(at + place + 2, 2), nullptr, 16);
      return 0.01 * static_cast<std::int16_t>(low | (high << 8U));
    };
    return std::array{slope(5), slope(9)};
  }

 private:
  int line_;
  SimTime next_ = kStart + 10ms;
  std::string text_;
};

/// Mounted turned by `roll` and `pitch` on the body: angles of its axes to the horizontal.
std::array<double, 2> true_slopes_deg(const nlohmann::json& truth, double roll_rad,
                                      double pitch_rad) {
  const auto& q = truth["attitude_wxyz"];
  const Eigen::Quaterniond body(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(),
                                q[3].get<double>());
  const Eigen::Quaterniond sensor = body * Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX());
  return {std::asin((sensor * Eigen::Vector3d::UnitX()).z()) / kDegree,
          std::asin((sensor * Eigen::Vector3d::UnitY()).z()) / kDegree};
}

TEST_F(InclinometerRig, SlopesOfAStandingMachineAreThoseOfTheTruth) {
  const LoadedRig loaded = load(
      "  level: {type: cia410-inclinometer, mount: {link: body}, node_id: 10, filter: 3,\n"
      "    starts_itself: true, transmission_type: 255, event_timer: 50 ms}\n"
      "  tilted: {type: cia410-inclinometer, node_id: 11, filter: 3, starts_itself: true,\n"
      "    transmission_type: 255, event_timer: 50 ms,\n"
      "    mount: {link: body, rotation: {roll: 15 deg, pitch: -25 deg}}}\n");
  const auto file = wires_.folder / "truth.jsonl";
  std::optional<std::array<double, 2>> level;
  std::optional<std::array<double, 2>> tilted;
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {file, {}});
    Client client(wires_.can());
    rig.executive().add(client);
    const RunOutcome outcome = rig.executive().run_free(kStart + 6s);
    ASSERT_FALSE(outcome.fault.has_value()) << *outcome.fault;
    level = client.slopes_deg("18A");
    tilted = client.slopes_deg("18B");
  }
  std::string last;
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    last = line;
  }
  ASSERT_TRUE(level && tilted);
  const auto truth = nlohmann::json::parse(last);
  const auto of_level = true_slopes_deg(truth, 0.0, 0.0);
  const auto of_tilted = true_slopes_deg(truth, 15.0 * kDegree, -25.0 * kDegree);
  EXPECT_GT(std::abs(of_level[0]), 2.0) << "the machine does not stand on a slope";
  EXPECT_GT(std::abs(of_level[1]), 2.0) << "the machine does not stand on a slope";
  constexpr double kHalfCountAndSettling_deg = 0.01;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR((*level)[axis], of_level[axis], kHalfCountAndSettling_deg) << axis;
    EXPECT_NEAR((*tilted)[axis], of_tilted[axis], kHalfCountAndSettling_deg) << axis;
  }
}

TEST_F(InclinometerRig, PlanAndBusKnowIt) {
  const LoadedRig loaded = load(
      "  boom: {type: cia410-inclinometer, mount: {link: body}, node_id: 10,\n"
      "    transmission_type: 255, event_timer: 50 ms, heartbeat: 1 s}\n"
      "  chassis: {type: cia410-inclinometer, mount: {link: body}, node_id: 11,\n"
      "    resolution: 1}\n");
  const RigView rig = view_of(loaded.configuration);
  const DevicePlan timed = loaded.configuration.devices.at("boom")->plan(rig);
  EXPECT_THAT(timed.wire, HasSubstr("node 10"));
  EXPECT_EQ(timed.sends, "21 frames/s");
  EXPECT_EQ(timed.with, "counts of 0.01 deg");
  const DevicePlan asked = loaded.configuration.devices.at("chassis")->plan(rig);
  EXPECT_EQ(asked.sends, "0 frames/s");
  EXPECT_EQ(asked.with, "counts of 0.001 deg, sent after SYNC");
  EXPECT_EQ(bus_messages(loaded.configuration, "can").size(), 8U);
}

TEST(InclinometerDescription, NamesMessagesAndQuantities) {
  const DeviceDescription description = fresh_inclinometer()->describe();
  ASSERT_EQ(description.messages.size(), 5U);
  EXPECT_EQ(description.messages[0].name, "18A inclinometer_slopes");
  ASSERT_EQ(description.quantities.size(), 2U);
  EXPECT_EQ(description.quantities[0].name, "slope_longitudinal");
  EXPECT_THAT(description.document, HasSubstr("CiA 410"));
}

TEST_F(InclinometerRig, WhatItCannotBeIsRefusedWithTheKey) {
  EXPECT_EQ(
      complaints_of("range: 45 deg, heartbeat: 0.5 s, faults: [{type: off, at: 2 s, for: 0.5 s}]"),
      "");
  EXPECT_THAT(complaints_of("resolution: 20"),
              AllOf(HasSubstr("devices.boom.resolution"), HasSubstr("1, 10, 100, 1000")));
  EXPECT_THAT(complaints_of("filter: 5"), HasSubstr("devices.boom.filter"));
  EXPECT_THAT(complaints_of("quadrants: 3"), HasSubstr("devices.boom.quadrants"));
  EXPECT_THAT(complaints_of("range: 181 deg"), HasSubstr("devices.boom.range"));
  EXPECT_THAT(complaints_of("range: 0"), HasSubstr("devices.boom.range"));
  EXPECT_THAT(complaints_of("transmission_type: 241"),
              AllOf(HasSubstr("devices.boom.transmission_type"), HasSubstr("0 .. 240, 254, 255")));
  EXPECT_THAT(complaints_of("node_id: 128"), HasSubstr("devices.boom.node_id"));
  EXPECT_THAT(complaints_of("magnetometer: {present: true}"), HasSubstr("magnetometer"));
  EXPECT_THAT(complaints_of("bus: implement"), HasSubstr("no such bus"));
  EXPECT_THAT(complaints("  boom: {type: cia410-inclinometer, mount: {link: arm}}\n"),
              AllOf(HasSubstr("devices.boom.mount.link"), HasSubstr("no such link")));
}

TEST_F(InclinometerRig, NodeOfAnEncoderOnItsBusIsTaken) {
  const std::string both =
      "  boom: {type: cia410-inclinometer, mount: {link: body}, node_id: 0x20}\n"
      "  wheel: {type: cia406-encoder, node_id: 0x20, base: front_axle, link: front_left_wheel}\n";
  EXPECT_THAT(complaints(both), AllOf(HasSubstr("devices.wheel.node_id"),
                                      HasSubstr("already taken by devices.boom.node_id")));
  EXPECT_EQ(complaints(both, ", duplicate_addresses: true"), "");
}

}  // namespace
}  // namespace rigwire::hil
