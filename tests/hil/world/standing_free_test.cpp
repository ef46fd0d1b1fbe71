// A machine starts where it can stand.
#include "hil/world/standing_free.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

class StandingFree : public testing::Test {
 protected:
  /// What `rigwire check` finds.
  std::string complaints(const std::string& rig) {
    const std::string file = (wires_.folder / "rig.yaml").string();
    std::ofstream(file) << rig;
    return complaints_of(file, {});
  }
  static std::string complaints_of(const std::string& file, const std::vector<std::string>& sets) {
    try {
      check_start(load_rig(file, sets));
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }
  rigwire::test::PrivateWires wires_;
};

TEST_F(StandingFree, every_type_of_machine_by_itself_in_the_default_scene) {
  for (const MachineType& type : machine_types()) {
    EXPECT_EQ(complaints("machine: {type: " + std::string(type.named.name) + "}\n"), "")
        << type.named.name;
  }
}

TEST_F(StandingFree, every_rig_of_the_project) {
  for (const auto& rig : fs::directory_iterator(fs::path(RIGWIRE_SOURCE_DIR) / "configs/rigs")) {
    EXPECT_EQ(complaints_of(rig.path().string(), {}), "") << rig.path();
  }
}

TEST_F(StandingFree, a_bucket_in_the_heap_is_refused_with_its_depth) {
  EXPECT_THAT(complaints("machine:\n"
                         "  type: excavator\n"
                         "  excavator: {initial: {boom: 0.35 rad}}\n"),
              AllOf(HasSubstr("rig.yaml:2:3: machine: starts with its bucket "),
                    ContainsRegex("bucket [0-9]+\\.[0-9] cm deep in the ground"),
                    HasSubstr("allowed a position and a posture that are free")));
}

TEST_F(StandingFree, a_body_in_an_obstacle_is_refused) {
  EXPECT_THAT(
      complaints("scene:\n"
                 "  terrain: {type: level}\n"
                 "  boxes: [{name: hall, size: [6 m, 6 m, 6 m], position: [2 m, 0 m, 0 m]}]\n"
                 "machine: {type: wheeled}\n"),
      HasSubstr("starts with its body "));
}

// Terrain and obstacles alone were looked at: a crate of 0.36 or 0.86 m was in the truck's way
// between the points of its surface, or in a wheel.
TEST_F(StandingFree, what_lies_loose_is_in_the_way_too) {
  const auto beside = [this](const std::string& size, const std::string& place) {
    return complaints(
        "scene:\n"
        "  terrain: {type: level}\n"
        "  boxes: [{name: crate, loose: true, mass: 300 kg, size: " +
        size + ", position: " + place +
        "}]\n"
        "machine: {include: " +
        std::string(RIGWIRE_SOURCE_DIR) + "/configs/machines/unimog_u5023.yaml}\n");
  };
  const std::string small = "[0.36 m, 0.36 m, 0.36 m]";
  const std::string large = "[0.86 m, 0.86 m, 0.86 m]";
  for (const auto& [size, place] :
       {std::pair{small, "[3.85 m, 0.9 m, 0 m]"}, std::pair{large, "[2 m, 0 m, 0 m]"},
        std::pair{large, "[4.9 m, 0.3 m, 0 m]"}}) {
    EXPECT_THAT(beside(size, place), HasSubstr("deep in 'crate', which lies loose, allowed"))
        << place;
  }
  EXPECT_EQ(beside(large, "[6 m, 0 m, 0 m]"), "");
  EXPECT_EQ(beside("[0.2 m, 0.2 m, 0.2 m]", "[2 m, 0 m, 0 m]"), "");  // Below its frame.
}

// It was put upright, tumbled down and began on its side, metres away, with exit status 0.
TEST_F(StandingFree, an_excavator_stands_on_the_slopes_that_hold_it_and_is_refused_elsewhere) {
  for (const std::string machine : {"excavator_ref18t", "excavator_ref18t_tracks"}) {
    const auto on_slope = [&](const std::string& rise, const std::string& yaw) {
      return complaints(
          "scene:\n"
          "  terrain: {type: level, slope: {rise: " +
          rise +
          "}}\n"
          "  soils: [{name: hard, friction: 0.8}]\n"
          "machine:\n"
          "  include: " +
          std::string(RIGWIRE_SOURCE_DIR) + "/configs/machines/" + machine +
          ".yaml\n"
          "  yaw: " +
          yaw + "\n  excavator: {carrier: moving}\n");
    };
    for (const std::string yaw : {"0 deg", "90 deg", "180 deg"}) {
      for (const std::string rise : {"0.2126", "0.3640"}) {  // 12 and 20 degrees
        EXPECT_EQ(on_slope(rise, yaw), "") << machine << yaw;
      }
    }
    EXPECT_EQ(on_slope("0.57", "0 deg"), "") << machine;
    EXPECT_THAT(on_slope("0.9", "0 deg"),
                AllOf(HasSubstr("machine: cannot stand where it is put: on ground that slopes 4"),
                      HasSubstr("after 5 s, allowed ")))
        << machine;
    EXPECT_THAT(on_slope("0.65", "90 deg"), HasSubstr("tips over")) << machine;
  }
}

TEST_F(StandingFree, a_place_beside_the_terrain_is_refused_with_its_extent) {
  const std::string pit = std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/excavator_pit.yaml";
  EXPECT_THAT(complaints_of(pit, {"machine.position=[61 m, 0 m, 0 m]"}),
              AllOf(HasSubstr("--set machine.position=[61 m, 0 m, 0 m]: machine.position: "),
                    HasSubstr("found [61 m, 0 m], allowed -60 .. 60 m east, -60 .. 60 m north")));
}

TEST_F(StandingFree, a_place_as_maps_have_it_is_out_of_range_of_any_scene) {
  EXPECT_THAT(
      complaints("machine: {type: excavator, position: [410000 m, 5475000 m, 0 m]}\n"),
      AllOf(HasSubstr("machine.position.0: out of range"), HasSubstr("allowed -10000 .. 10000 m")));
}

TEST_F(StandingFree, a_height_that_wheels_do_not_take_is_refused) {
  EXPECT_THAT(complaints("machine: {type: wheeled, position: [0 m, 0 m, 3 m]}\n"),
              HasSubstr("machine.position.2: the machine is placed on the terrain automatically"));
  EXPECT_THAT(complaints("machine: {type: tandem_roller, on_ground: false}\n"),
              HasSubstr("machine.on_ground: the machine is placed on the terrain automatically"));
}

}  // namespace
}  // namespace rigwire::hil
