// Rocks and crates of a scene's file that lie loose: machines push them, rays and truth follow.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hil/record/truth_tap.h"
#include "hil/rig/rig.h"
#include "private_wires.h"
#include "sim/vehicle/wheeled_vehicle.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using Vector = Eigen::Vector3d;

/// A Unimog at the origin of level ground, with these things in front of it.
class LooseThings : public testing::Test {
 protected:
  [[nodiscard]] RigConfiguration configuration(const std::string& things) const {
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/unimog_u5023.yaml}\n"
                           "scene:\n  terrain: {type: level, size: 80 m, cell: 1 m}\n"
                        << things;
    return load_rig(file.string(), {}).configuration;
  }
  [[nodiscard]] std::string refusal(const std::string& things) const {
    try {
      (void)configuration(things);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  rigwire::test::PrivateWires wires;
};

/// Wants to look at the scene in every slice.
class SteadyViewer final : public WorldSensor {
 public:
  void take(SimTime /*frontier*/, const Shelves& /*requests*/) override {}
};

/// Lines of the truth tap, each 100 ms.
class Lines final : public TruthObserver {
 public:
  Lines(std::span<const sim::TruthField> fields, std::vector<nlohmann::json>& lines)
      : fields_(fields.begin(), fields.end()), lines_(lines) {}
  void record(const TruthRecord& record) override {
    lines_.push_back(nlohmann::json::parse(truth_line(record, calendar_, fields_)));
  }

 private:
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  std::vector<sim::TruthField> fields_;
  std::vector<nlohmann::json>& lines_;
};

// What a lidar sees, where it lies, and what the truth tells of it are one place.
TEST_F(LooseThings, ACrateInTheWayIsPushedAndSeenAndToldWhereItIs) {
  SimulatedWorld world = make_world(configuration(
      "  boxes:\n"
      "    - {name: crate, size: [1 m, 1.2 m, 1.2 m], position: [9 m, 0 m, 0 m], loose: true, "
      "mass: 200 kg}\n"
      "    - {name: aside, size: [1 m, 1 m, 1 m], position: [9 m, 8 m, 0 m], loose: true, "
      "mass: 200 kg}\n"));
  world.add(std::make_unique<SteadyViewer>());
  auto& machine = dynamic_cast<sim::WheeledVehicle&>(world.machine());
  VehicleCommand command;
  command.parking_brake = false;
  machine.command(command);
  machine.start_rolling(5.0);
  std::vector<nlohmann::json> lines;
  world.add_truth_observer(std::make_unique<Lines>(machine.truth_fields(), lines),
                           std::chrono::milliseconds(100));
  SampleBatch batch;
  const auto run = [&](int slices) {
    for (int i = 0; i < slices; ++i) {
      ASSERT_EQ(world.advance({}, batch), std::nullopt);
    }
  };
  /// Along y through the height of a crate's middle: where it is hit, and what.
  const auto seen = [&](double x_m) -> std::string {
    const auto hit = world.scene().cast({x_m, -30.0, 0.6}, Vector::UnitY(), 0.1, 32.0,
                                        *world.scene().slice_end());
    return hit ? world.scene().name(hit->instance) : "";
  };
  run(50);
  EXPECT_EQ(seen(9.0), "crate");
  ASSERT_FALSE(lines.empty());
  EXPECT_FALSE(lines.back().contains("moved"));
  run(1200);
  ASSERT_TRUE(lines.back().contains("moved"));
  const nlohmann::json& moved = lines.back()["moved"];
  ASSERT_EQ(moved.size(), 1U) << "the one aside lies where it lay";
  const double x_m = moved["crate"]["position_m"][0];
  EXPECT_GT(x_m, 10.0);
  EXPECT_EQ(seen(9.0 - 0.4), "") << "where it was";
  EXPECT_EQ(seen(x_m), "crate");
  bool told = false;
  for (const nlohmann::json& line : lines) {
    told = told || (line["contact"]["touching"] == true && line["contact"]["with"] == "crate");
  }
  EXPECT_TRUE(told);
}

// Rocks lie on the ground, and are still there when the run begins.
TEST_F(LooseThings, RocksAreAtRestWhenTheRunBegins) {
  const MachineInScene built = build_machine_in_scene(configuration(
      "  rocks:\n"
      "    - {count: 8, centre: [15 m, 0 m], radius: 6 m, smallest: 0.2 m, largest: 0.6 m, "
      "loose: true, keep_out: []}\n"));
  const sim::LooseBodies& loose = *built.ground->loose();
  ASSERT_EQ(loose.size(), 8U);
  for (std::size_t i = 0; i < loose.size(); ++i) {
    EXPECT_TRUE(loose.movers()[i].rests) << i;
    EXPECT_FALSE(loose.moved(i)) << i;
  }
}

// Keys that would bind nothing, and masses that nothing has.
TEST_F(LooseThings, WhatHasNoEffectOrNoSenseIsRefusedWithWhatIsAllowed) {
  const auto crate = [&](const std::string& keys) {
    return refusal(
        "  boxes:\n    - {name: crate, size: [1 m, 1 m, 1 m], position: [9 m, 0 m, 0 m], " + keys +
        "}\n");
  };
  EXPECT_EQ(crate("loose: true, mass: 200 kg"), "");
  EXPECT_THAT(crate("mass: 200 kg"), HasSubstr("loose: true"));
  EXPECT_THAT(crate("loose: true, mass: 1e-9 kg"), HasSubstr("1 .. 1000000 kg"));
  EXPECT_THAT(crate("loose: true, mass: 1e12 kg"), HasSubstr("1 .. 1000000 kg"));
  EXPECT_THAT(crate("loose: true, mass: .nan"), HasSubstr("mass"));
  EXPECT_THAT(crate("loose: true, friction: -1"), HasSubstr("friction"));
  EXPECT_THAT(refusal("  rocks:\n    - {count: 3, loose: true, density: 1e9 kg/m3}\n"),
              HasSubstr("density"));
}

}  // namespace
}  // namespace rigwire::hil
