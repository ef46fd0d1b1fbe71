// Each kind of bad input gives its one message; the messages are compared word by word.
#include "hil/configuration/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fields/check.h"
#include "fields/units.h"
#include "hil/control/commands.h"
#include "sample_struct.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;

TEST(Reader, empty_document_keeps_every_default) {
  Sample sample;
  EXPECT_EQ(findings("", sample), "");
  EXPECT_EQ(sample.name, "sample");
  EXPECT_EQ(sample.stones.size(), 1u);
}

TEST(Reader, units_convert_to_the_member_with_one_rounding) {
  Sample sample;
  EXPECT_EQ(findings("stones: [{size: 1050 mm, position: [1 km, -5 cm, 3]}]\n"
                     "main: {pressure: 350 bar, port: 0x1f6}\n"
                     "angle: 1 rad\nstep: 20 us\nweights: [1e-3]\n",
                     sample),
            "");
  EXPECT_EQ(sample.stones.at(0).size_m, 1.05);
  EXPECT_EQ(sample.stones.at(0).position_m, (Vector3{1000.0, -0.05, 3.0}));
  EXPECT_EQ(sample.main.pressure_pa, 35e6);
  EXPECT_EQ(sample.main.port, 502);
  EXPECT_EQ(sample.angle_rad, 1.0);
  EXPECT_EQ(sample.step, std::chrono::microseconds(20));
  EXPECT_EQ(sample.weights, std::vector<double>{1e-3});
}

TEST(Reader, bare_number_is_in_the_unit_of_the_field) {
  Sample sample;
  EXPECT_EQ(findings("main: {pressure: 20}\nangle: 180\n", sample), "");
  EXPECT_EQ(sample.main.pressure_pa, 20e6);
  EXPECT_EQ(sample.angle_rad, 3.14159265358979323846);
}

TEST(Reader, unknown_key_is_refused_with_the_near_name) {
  EXPECT_EQ(findings("nmae: x\n"), "a.yaml:1:1: nmae: unknown key, did you mean name?");
}

TEST(Reader, unknown_key_without_a_near_name_lists_all) {
  EXPECT_EQ(findings("main:\n  zebra: 1\n"),
            "a.yaml:2:3: main.zebra: unknown key, allowed pressure, port");
}

TEST(Reader, wrong_unit_names_the_right_ones) {
  EXPECT_EQ(findings("main: {pressure: 20 mm}\n"),
            "a.yaml:1:18: main.pressure: wrong unit, found \"20 mm\", allowed Pa, kPa, MPa, bar");
}

TEST(Reader, unit_in_wrong_case_is_suggested) {
  EXPECT_EQ(findings("main: {pressure: 20 mpa}\n"),
            "a.yaml:1:18: main.pressure: wrong unit, found \"20 mpa\", allowed Pa, kPa, MPa, bar, "
            "did you mean MPa?");
}

TEST(Reader, not_a_number_and_infinity_are_refused) {
  for (const char* text : {".nan", "nan", "NaN", ".inf", "-.inf", "inf", "1e999"}) {
    EXPECT_EQ(findings(std::string("angle: ") + text + "\n"),
              std::string("a.yaml:1:8: angle: not a finite number, found \"") + text +
                  "\", allowed rad, mrad, deg (-180 .. 180 deg)");
  }
}

TEST(Reader, word_in_place_of_a_number_is_refused) {
  for (const char* text : {"fast", "infinite", "nano", "--5", "+-5", "mm"}) {
    EXPECT_THAT(findings(std::string("angle: ") + text + "\n"),
                HasSubstr("a.yaml:1:8: angle: not a number, found"))
        << text;
  }
}

TEST(Reader, negative_and_zero_rate_are_out_of_range) {
  EXPECT_EQ(findings("gadgets: {a: {type: lamp, rate: -5 Hz}, b: {type: lamp, rate: 0}}\n"),
            "a.yaml:1:33: gadgets.a.rate: out of range, found \"-5 Hz\", allowed above 0 .. 1000 "
            "Hz\n"
            "a.yaml:1:63: gadgets.b.rate: out of range, found \"0\", allowed above 0 .. 1000 Hz");
}

TEST(Reader, whole_number_out_of_range_or_broken_is_refused) {
  EXPECT_EQ(findings("main: {port: 65536}\n"),
            "a.yaml:1:14: main.port: out of range, found \"65536\", allowed 1 .. 65535");
  EXPECT_EQ(findings("main: {port: 5.5}\n"),
            "a.yaml:1:14: main.port: not a whole number, found \"5.5\", allowed 1 .. 65535");
  EXPECT_THAT(findings("main: {port: 99999999999999999999}\n"), HasSubstr("out of range"));
}

TEST(Reader, choice_is_refused_with_the_near_name) {
  EXPECT_EQ(findings("flavour: sower\n"),
            "a.yaml:1:10: flavour: unknown value, found \"sower\", allowed sweet, sour, did you "
            "mean sour?");
}

TEST(Reader, type_of_a_named_thing_chooses_its_fields) {
  Sample sample;
  EXPECT_EQ(
      findings("gadgets:\n  l: {type: lamp, rate: 4 Hz}\n  p: {type: pump, port: 9}\n", sample),
      "");
  EXPECT_EQ(std::get<Lamp>(sample.gadgets.at("l").settings).period, std::chrono::milliseconds(250));
  EXPECT_EQ(std::get<Pump>(sample.gadgets.at("p").settings).port, 9);
}

TEST(Reader, unknown_type_is_one_finding_and_its_fields_are_not_judged) {
  EXPECT_EQ(findings("gadgets: {l: {type: lmap, rate: 4 Hz}}\n"),
            "a.yaml:1:21: gadgets.l.type: unknown type, found \"lmap\", allowed pump, lamp, did "
            "you mean lamp?");
}

TEST(Reader, missing_type_is_a_finding) {
  EXPECT_EQ(findings("gadgets:\n  l: {enabled: true}\n"),
            "a.yaml:2:6: gadgets.l.type: missing key (pump, lamp)");
}

TEST(Reader, field_of_another_type_is_an_unknown_key) {
  EXPECT_EQ(findings("gadgets: {l: {type: lamp, port: 4}}\n"),
            "a.yaml:1:27: gadgets.l.port: unknown key, allowed enabled, type, rate");
}

TEST(Reader, wrong_kind_of_node_is_named) {
  EXPECT_EQ(findings("main: 5\nstones: x\nname: [1]\ngadgets: [a]\nweights: 5\n"),
            "a.yaml:1:7: main: wrong kind of value, found \"5\", allowed a map of keys\n"
            "a.yaml:2:9: stones: wrong kind of value, found \"x\", allowed a list\n"
            "a.yaml:3:7: name: wrong kind of value, found a list, allowed a single value\n"
            "a.yaml:4:10: gadgets: wrong kind of value, found a list, allowed a map of keys\n"
            "a.yaml:5:10: weights: wrong kind of value, found \"5\", allowed a list");
}

TEST(Reader, key_without_a_value_is_a_finding) {
  EXPECT_THAT(findings("name:\n"), HasSubstr("name: the key has no value"));
}

TEST(Reader, vector_of_wrong_length_is_refused) {
  EXPECT_EQ(findings("stones: [{position: [1, 2]}]\n"),
            "a.yaml:1:21: stones.0.position: wrong number of elements, found 2, allowed 3");
}

TEST(Reader, missing_file_names_the_path_tried_and_the_near_name) {
  EXPECT_EQ(findings("mesh: CMakeList.txt\n"),
            "a.yaml:1:7: mesh: no such file \"CMakeList.txt\", tried " RIGWIRE_SOURCE_DIR
            "/CMakeList.txt, did you mean " RIGWIRE_SOURCE_DIR "/CMakeLists.txt?");
}

TEST(Reader, a_text_in_place_of_a_map_is_told_of_include) {
  EXPECT_EQ(findings("main: excavator_ref18t\n"),
            "a.yaml:1:7: main: wrong kind of value, found \"excavator_ref18t\", allowed a map of "
            "keys, or of `include: FILE` for those of a file");
}

TEST(Reader, a_request_as_a_whole_has_no_line_and_column) {
  Location place{std::make_shared<const std::string>("the request"), 1, 1, 0};
  EXPECT_EQ(place.text(), "the request");
  place.column = 9;
  EXPECT_EQ(place.text(), "the request:1:9");
  place.column = 1;
  place.source = std::make_shared<const std::string>("rig.yaml");
  EXPECT_EQ(place.text(), "rig.yaml:1:1");
}

TEST(Reader, a_missing_key_of_a_request_tells_its_form) {
  FaultAddCommand command;
  Problems problems;
  const Value document = parse_request("on: tilt", "the request", problems);
  Origins origins;
  read(document, command, problems, origins);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_THAT(problems.sorted()[0].line(),
              testing::AllOf(testing::StartsWith("the request: fault: missing key (Its keys as in "
                                                 "a rig's file"),
                             testing::EndsWith(")")));
}

TEST(Reader, a_bare_number_among_the_units_is_not_called_1) {
  EXPECT_EQ(fields::allowed_units(fields::Dimension::ratio), "a bare number, %, ppm");
}

TEST(Reader, date_that_does_not_exist_is_refused) {
  EXPECT_THAT(findings("start: 2026-02-30T00:00:00Z\n"), HasSubstr("a.yaml:1:8: start: "));
  EXPECT_THAT(findings("start: yesterday\n"), HasSubstr("allowed UTC like 2026-06-01T08:00:00Z"));
}

TEST(Reader, duration_outside_its_range_is_refused) {
  EXPECT_EQ(findings("step: 2 s\n"),
            "a.yaml:1:7: step: out of range, found \"2 s\", allowed 1 us .. 1 s");
  EXPECT_THAT(findings("step: 1e30 h\n"), HasSubstr("out of range"));
}

TEST(Reader, validation_of_a_section_is_reported_at_the_section) {
  EXPECT_EQ(findings("main:\n  port: 13\n"), "a.yaml:2:3: main: port 13 brings bad luck");
}

TEST(Reader, every_finding_of_a_file_comes_in_one_pass_in_order) {
  EXPECT_EQ(findings("nmae: x\n"
                     "angle: .nan\n"
                     "main:\n"
                     "  pressure: 20 mm\n"
                     "gadgets:\n"
                     "  l: {type: lamp, rate: -1 Hz}\n"
                     "  m: {type: lmap}\n"),
            "a.yaml:1:1: nmae: unknown key, did you mean name?\n"
            "a.yaml:2:8: angle: not a finite number, found \".nan\", allowed rad, mrad, deg (-180 "
            ".. 180 deg)\n"
            "a.yaml:4:13: main.pressure: wrong unit, found \"20 mm\", allowed Pa, kPa, MPa, bar\n"
            "a.yaml:6:25: gadgets.l.rate: out of range, found \"-1 Hz\", allowed above 0 .. 1000 "
            "Hz\n"
            "a.yaml:7:13: gadgets.m.type: unknown type, found \"lmap\", allowed pump, lamp, did "
            "you mean lamp?");
}

TEST(Reader, set_beats_the_file_and_says_so_when_it_is_wrong) {
  Sample sample;
  EXPECT_EQ(findings("gadgets: {l: {type: lamp}}\n", sample, {"gadgets.l.rate=5", "angle=90 deg"}),
            "");
  EXPECT_EQ(std::get<Lamp>(sample.gadgets.at("l").settings).period, std::chrono::milliseconds(200));
  EXPECT_EQ(findings("gadgets: {l: {type: lamp}}\n", sample, {"gadgets.l.ratte=5"}),
            "--set gadgets.l.ratte=5: gadgets.l.ratte: unknown key, did you mean rate?");
  EXPECT_EQ(findings("gadgets: {lamp: {type: lamp}}\n", sample, {"gadgets.lmap.rate=5"}),
            "--set gadgets.lmap.rate=5: gadgets.lmap: no such gadget, found \"lmap\", allowed "
            "lamp, did you mean lamp?");
  EXPECT_EQ(findings("gadgets: {l: {type: lamp}}\n", sample, {"gadgets.l.rate=-5 Hz"}),
            "--set gadgets.l.rate=-5 Hz: gadgets.l.rate: out of range, found \"-5 Hz\", allowed "
            "above 0 .. 1000 Hz");
}

TEST(Reader, set_reaches_into_lists) {
  Sample sample;
  EXPECT_EQ(findings("stones: [{size: 1}, {size: 2}]\n", sample, {"stones.1.size=7"}), "");
  EXPECT_EQ(sample.stones.at(1).size_m, 7.0);
  EXPECT_EQ(findings("stones: [{size: 1}]\n", sample, {"stones.3.size=7"}),
            "--set stones.3.size=7: stones.3.size: no such list element, found 3, allowed 0 .. 0");
}

TEST(Reader, set_that_is_no_assignment_is_refused) {
  Sample sample;
  for (const char* text : {"name", "=5", ".name=5", "name.=5", "a..b=5"}) {
    EXPECT_EQ(findings("", sample, {text}), std::string("--set ") + text +
                                                ": not an assignment, found " + text +
                                                ", allowed key.path=value");
  }
  EXPECT_THAT(findings("", sample, {"weights=[1, 2"}), HasSubstr("the value is not valid YAML"));
  EXPECT_THAT(findings("name: x\n", sample, {"name.first=1"}),
              HasSubstr("there is nothing below this key"));
}

struct Rotor {
  double rate_radps = 60.0;
  double blinks_hz = 1.0;
  double least = 1.0;
  double most = 2.0;

  friend void validate(const Rotor& rotor) {
    fields::check(rotor);
    fields::require(rotor.least <= rotor.most, "least", fields::shortest(rotor.least), "<= most");
  }
};

void visit(fields::Visitor& v, Rotor& rotor) {
  v.number("rate", rotor.rate_radps, fields::in("rpm").between(300, 1200), "Speed.");
  v.number("blinks", rotor.blinks_hz, fields::in("Hz").between(0, 100), "Lamp.");
  v.number("least", rotor.least, fields::plain().between(0, 10), "Not above `most`.");
  v.number("most", rotor.most, fields::plain().between(0, 10), "Not below `least`.");
}

std::string findings_of_rotor(const std::string& yaml, const std::vector<std::string>& sets = {}) {
  Problems problems;
  Value document = parse_document(yaml, "a.yaml", RIGWIRE_SOURCE_DIR, problems);
  for (const std::string& set : sets) {
    apply_set(document, set, problems);
  }
  Rotor rotor;
  Origins origins;
  read(document, rotor, problems, origins);
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += problem.line();
  }
  return text;
}

TEST(Reader, turns_per_second_are_suggested_as_revolutions_per_minute) {
  EXPECT_THAT(findings_of_rotor("rate: 20 Hz\n"), HasSubstr("did you mean 1200 rpm?"));
  EXPECT_THAT(findings_of_rotor("blinks: 600 rpm\n"), HasSubstr("did you mean 10 Hz?"));
}

TEST(Reader, an_argument_is_blamed_for_what_it_breaks_not_the_file) {
  EXPECT_EQ(findings_of_rotor("least: 1\nmost: 2\n", {"most=0.5"}),
            "--set most=0.5: least: found 1, allowed <= most, together with a.yaml:1");
  EXPECT_EQ(findings_of_rotor("least: 3\nmost: 2\n"),
            "a.yaml:1:8: least: found 3, allowed <= most");
}

TEST(Reader, a_name_of_two_lines_is_refused) {
  EXPECT_EQ(findings("name: \"a\\nb\"\n"),
            "a.yaml:1:7: name: a control character, found U+000A, allowed text of one line");
}

}  // namespace
}  // namespace rigwire::hil
