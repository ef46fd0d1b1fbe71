// Keys that another key leaves without effect: where both are written they are refused, and where
// one was written over the other they are not; the schema and the reference know of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fields/check.h"
#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "hil/configuration/schema.h"
#include "hil/rig/rig_configuration.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using testing::Not;

enum class Drive { none, motor };
constexpr std::array<fields::Choice<Drive>, 2> kDrives{
    {{Drive::none, "none", "By hand."}, {Drive::motor, "motor", "By itself."}}};

struct Lens {
  double focus_m = 1.0;
};
void visit(fields::Visitor& v, Lens& p) {
  v.number("focus", p.focus_m, fields::in("m").above(0), "Where it is sharp.");
}

struct Camera {
  Drive drive = Drive::none;
  double speed_mps = 0.1;
  std::vector<double> stops{1.0};
  Lens lens;
  bool heated = false;
  double heat_w = 5.0;
};
void visit(fields::Visitor& v, Camera& p) {
  v.choice("drive", p.drive, kDrives, "What moves it.");
  v.only_if(p.drive == Drive::motor, "drive", "drive: motor", [&p](fields::Visitor& w) {
    w.number("speed", p.speed_mps, fields::in("m/s").above(0), "How fast.");
    w.number_list("stops", p.stops, fields::plain(), "Where it stops.");
    w.section("lens", p.lens, "In front of it.");
  });
  v.boolean("heated", p.heated, "Whether it is warm.");
  v.only_if(p.heated, "heated", "heated: true", [&p](fields::Visitor& w) {
    w.number("heat", p.heat_w, fields::plain().above(0), "How much.");
  });
}

class ConditionalKeys : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    std::ofstream(wires_.folder / name) << text;
  }
  /// What is found in camera.yaml; what was read is in `camera_`.
  std::string findings(const std::string& text, const std::vector<std::string>& sets = {}) {
    write("camera.yaml", text);
    Problems problems;
    Origins origins;
    Value document = load_document((wires_.folder / "camera.yaml").string(), problems);
    for (const std::string& set : sets) {
      apply_set(document, set, problems);
    }
    camera_ = {};
    read(document, camera_, problems, origins);
    std::string lines;
    for (const Problem& problem : problems.sorted()) {
      lines += problem.path + ": " + problem.what + "\n";
    }
    return lines;
  }
  rigwire::test::PrivateWires wires_;
  Camera camera_;
};

TEST_F(ConditionalKeys, are_refused_beside_the_choice_that_excludes_them) {
  EXPECT_EQ(findings("drive: motor\nspeed: 2\nlens: {focus: 3}\n"), "");
  EXPECT_EQ(camera_.lens.focus_m, 3.0);
  EXPECT_EQ(findings("drive: none\nspeed: 2\n"),
            "speed: has no effect with drive: none; it needs drive: motor\n");
  EXPECT_EQ(findings("speed: 2\nlens: {focus: 3}\nstops: [1, 2]\n"),
            "speed: has no effect; it needs drive: motor\n"
            "lens: has no effect; it needs drive: motor\n"
            "stops: has no effect; it needs drive: motor\n");
  EXPECT_EQ(camera_.stops, (std::vector<double>{1.0}));
  EXPECT_EQ(findings("heat: 2\nheated: false\n"),
            "heat: has no effect with heated: false; it needs heated: true\n");
  EXPECT_THAT(findings("sped: 2\n"), HasSubstr("sped: unknown key"));
}

TEST_F(ConditionalKeys, that_a_later_layer_switched_off_are_no_slip) {
  write("base.yaml", "drive: motor\nspeed: 2\nlens: {focus: 3}\n");
  EXPECT_EQ(findings("include: base.yaml\ndrive: none\n"), "");
  EXPECT_EQ(findings("drive: motor\nspeed: 2\n", {"drive=none"}), "");
  write("still.yaml", "drive: none\n");
  EXPECT_EQ(findings("include: [base.yaml, still.yaml]\n"), "");
  EXPECT_EQ(findings("include: [still.yaml, base.yaml]\n"), "");
  EXPECT_EQ(camera_.speed_mps, 2.0);
}

TEST_F(ConditionalKeys, that_a_later_layer_writes_in_vain_are_refused) {
  write("still.yaml", "drive: none\n");
  EXPECT_THAT(findings("include: still.yaml\nspeed: 2\n"), HasSubstr("speed: has no effect"));
  EXPECT_THAT(findings("drive: none\n", {"speed=2"}), HasSubstr("speed: has no effect"));
  EXPECT_THAT(findings("drive: none\n", {"speed=2", "drive=none"}),
              HasSubstr("speed: has no effect"));
  write("base.yaml", "lens: {focus: 3}\n");
  EXPECT_THAT(findings("include: [base.yaml, still.yaml]\nlens: {focus: 4}\n"),
              HasSubstr("lens: has no effect"));
}

TEST_F(ConditionalKeys, are_printed_hashed_and_checked_only_with_an_effect) {
  const auto hash = [](const Camera& camera) {
    return hash_text(outline(camera), [](const std::string&, fields::FileKind) { return ""; });
  };
  Camera still;
  still.speed_mps = -1.0;
  EXPECT_EQ(hash(still), hash(Camera{}));
  EXPECT_NO_THROW(fields::check(still));
  EXPECT_THAT(print_yaml(outline(still), Origins{}), Not(HasSubstr("speed")));
  still.drive = Drive::motor;
  EXPECT_THROW(fields::check(still), fields::Refused);
  EXPECT_THAT(reference_text(reference_outline(Camera{})),
              HasSubstr("speed: number in m/s, > 0 m/s, default 0.1 m/s, with drive: motor\n"));
}

TEST_F(ConditionalKeys, are_in_the_schema_under_their_choice) {
  const auto schema = nlohmann::json::parse(schema_of(Camera{}, "a camera"));
  for (const char* key : {"speed", "stops", "lens", "heat"}) {
    EXPECT_TRUE(schema["properties"][key].contains("description")) << key;
  }
  const auto refused_with = [&](const std::string& key, const nlohmann::json& value) {
    std::vector<std::string> keys;
    for (const auto& one : schema["allOf"]) {
      const auto& wanted = one["if"]["properties"];
      if (!wanted.contains(key) ||
          wanted[key].value("const", wanted[key].value("enum", nlohmann::json{{}})[0]) != value) {
        continue;
      }
      for (const auto& [name, rule] : one["then"]["properties"].items()) {
        if (rule == false) {
          keys.push_back(name);
        }
      }
    }
    return keys;
  };
  EXPECT_THAT(refused_with("drive", "none"), testing::ElementsAre("lens", "speed", "stops"));
  EXPECT_THAT(refused_with("drive", "motor"), testing::IsEmpty());
  EXPECT_THAT(refused_with("heated", false), testing::ElementsAre("heat"));
  EXPECT_THAT(refused_with("heated", true), testing::IsEmpty());
}

/// The reader's complaints about a rig with that text.
std::string complaints(const std::string& text) {
  Problems problems;
  Origins origins;
  RigConfiguration rig;
  read(parse_document(text, "rig.yaml", ".", problems), rig, problems, origins);
  std::string lines;
  for (const Problem& problem : problems.sorted()) {
    lines += problem.path + ": " + problem.what + "\n";
  }
  return lines;
}

TEST(ConditionalKeysOfARig, name_the_key_the_choice_and_what_it_needs) {
  const std::string machine = "machine: {type: excavator}\n";
  EXPECT_EQ(complaints("machine: {type: excavator, excavator: {pumps: constant, power_unit: "
                       "{set_speed: 1500 rpm}}}\n"),
            "machine.excavator.power_unit: has no effect with pumps: constant; it needs pumps: "
            "engine\n");
  EXPECT_EQ(complaints(machine + "buses: {can: {wire: gs_usb, ports: 2}}\n"),
            "buses.can.ports: has no effect with wire: gs_usb; it needs wire: slcan or auto\n");
  EXPECT_EQ(complaints(machine + "buses: {can: {wire: socketcan, ports: 2}}\n"),
            "buses.can.ports: has no effect with wire: socketcan; it needs wire: slcan or auto\n");
  EXPECT_EQ(complaints(machine + "buses: {can: {ports: 2}}\n"), "");
  EXPECT_EQ(complaints(machine + "buses: {can: {socketcand: {beacon: true}}}\n"),
            "buses.can.socketcand.beacon: has no effect; it needs a port\n");
  EXPECT_EQ(complaints(machine + "devices: {gnss: {type: ublox-neo-7p, wire: usb, ports: 2}}\n"),
            "devices.gnss.ports: has no effect with wire: usb; it needs wire: pty\n");
  EXPECT_EQ(
      complaints(machine + "devices: {levers: {type: usb-joystick, source: commands, "
                           "script: [{at: 0 s}]}}\n"),
      "devices.levers.script: has no effect with source: commands; it needs source: script\n");
}

}  // namespace
}  // namespace rigwire::hil
