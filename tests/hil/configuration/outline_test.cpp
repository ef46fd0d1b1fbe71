#include "hil/configuration/outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/files/file_content.h"
#include "sample_struct.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;

constexpr const char* kFull =
    "name: \"a: b # c\"\n"
    "mesh: CMakeLists.txt\n"
    "angle: 30 deg\n"
    "flavour: sour\n"
    "step: 1.5 ms\n"
    "start: 2026-06-01T08:00:00.5Z\n"
    "weights: [0.1, 1e-9]\n"
    "stones: [{size: 1050 mm}, {position: [1, 2, 3.3 mm]}]\n"
    "main: {pressure: 35.7 MPa}\n"
    "gadgets:\n"
    "  b: {type: lamp, rate: 3 Hz}\n"
    "  a: {type: pump, enabled: false}\n";

std::string hash_of(const std::string& yaml, const std::vector<std::string>& sets = {}) {
  Sample sample;
  EXPECT_EQ(findings(yaml, sample, sets), "");
  return hash_text(outline(sample), file_content);
}

TEST(Outline, printed_configuration_loads_to_the_same_values) {
  Sample sample;
  Origins origins;
  ASSERT_EQ(findings(kFull, sample, {}, &origins), "");
  const std::string printed = print_yaml(outline(sample), origins);
  Sample again;
  ASSERT_EQ(findings(printed, again), "") << printed;
  EXPECT_EQ(hash_text(outline(again), file_content), hash_text(outline(sample), file_content))
      << printed;
  EXPECT_EQ(again.name, "a: b # c");
  EXPECT_EQ(again.angle_rad, sample.angle_rad);
  EXPECT_EQ(std::get<Lamp>(again.gadgets.at("b").settings).period,
            std::get<Lamp>(sample.gadgets.at("b").settings).period);
}

TEST(Outline, printed_configuration_says_where_each_value_came_from) {
  Sample sample;
  Origins origins;
  ASSERT_EQ(findings("angle: 30 deg\nmain: {port: 9}\n", sample, {"main.port=10"}, &origins), "");
  const std::string printed = print_yaml(outline(sample), origins);
  EXPECT_THAT(printed, testing::ContainsRegex("angle: 30 deg +# a.yaml:1\n"));
  EXPECT_THAT(printed, testing::ContainsRegex("  port: 10 +# --set main.port=10\n"));
  EXPECT_THAT(printed, testing::ContainsRegex("name: sample +# default\n"));
}

TEST(Outline, hash_ignores_order_comments_units_and_layer) {
  const std::string hash = hash_of("angle: 90 deg\nmain: {pressure: 20 MPa}\n");
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(hash_of("# words\nmain: {pressure: 200 bar}\nangle: 90\n"), hash);
  EXPECT_EQ(hash_of("main: {pressure: 20}\n", {"angle=90 deg"}), hash);
  EXPECT_EQ(hash_of("angle: 90\nname: sample\nmain: {pressure: 20}\n"), hash);
}

TEST(Outline, hash_changes_with_any_value) {
  const std::string hash = hash_of(kFull);
  for (const char* set : {"name=x", "mesh=README.md", "angle=31", "flavour=sweet", "step=2 ms",
                          "weights=[1]", "words=[]", "words=[\"one\", two, three]", "stones=[]",
                          "stones.1.position=[0, 0, 0]", "main.port=7", "gadgets.b.rate=4",
                          "gadgets.a.enabled=true", "start=2027-01-01T00:00:00Z"}) {
    if (std::string(set).starts_with("mesh")) {
      EXPECT_NE(hash_of(kFull, {"mesh=\"\""}), hash) << set;
    } else {
      EXPECT_NE(hash_of(kFull, {set}), hash) << set;
    }
  }
}

TEST(Outline, hash_is_the_same_in_every_version_and_on_every_machine) {
  EXPECT_EQ(fnv1a(""), 0xcbf29ce484222325u);
  EXPECT_EQ(fnv1a("a"), 0xaf63dc4c8601ec8cu);  // FNV reference test vector
  EXPECT_EQ(fnv1a("foobar"), 0x85944171f73967e8u);
}

TEST(Outline, every_documented_key_can_be_set_to_its_printed_value) {
  Sample sample;
  ASSERT_EQ(findings(kFull, sample), "");
  const OutlineNode tree = outline(sample);
  const std::string hash = hash_text(tree, file_content);
  int leaves = 0;
  const auto walk = [&](auto&& self, const OutlineNode& node, const std::string& path) -> void {
    for (const OutlineNode& child : node.children) {
      const std::string below = path.empty() ? child.key : path + "." + child.key;
      if (child.kind == OutlineNode::Kind::scalar || child.kind == OutlineNode::Kind::flow_list) {
        EXPECT_EQ(hash_of(kFull, {below + "=" + child.value}), hash) << below;
        ++leaves;
      }
      self(self, child, below);
    }
  };
  walk(walk, tree, "");
  EXPECT_EQ(leaves, 21);
}

TEST(Outline, reference_names_type_unit_range_and_default) {
  const std::string text = reference_text(outline(Sample{}));
  EXPECT_THAT(text, HasSubstr("angle: number in deg, -180 .. 180 deg, default"));
  EXPECT_THAT(text, HasSubstr("  port: whole number, 1 .. 65535, default 502\n"));
  EXPECT_THAT(text, HasSubstr("flavour: choice, sweet, sour, default sweet\n    Taste.\n"));
}

}  // namespace
}  // namespace rigwire::hil
