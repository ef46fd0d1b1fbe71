#include "hil/configuration/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "sample_struct.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string complaints(const Problems& problems) {
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += (text.empty() ? "" : "\n") + problem.line();
  }
  return text;
}

class Files : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / ("rigwire_document_" + std::to_string(::getpid()) + "_" +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const fs::path path = folder_ / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
    return path.string();
  }

  fs::path folder_;
};

TEST_F(Files, included_file_lies_below_the_map_that_includes_it) {
  write("parts/pump.yaml", "pressure: 10 MPa\nport: 7\n");
  const std::string rig = write("rig.yaml", "main:\n  port: 8\n  include: parts/pump.yaml\n");
  Problems problems;
  const Value document = load_document(rig, problems);
  Sample sample;
  Origins origins;
  read(document, sample, problems, origins);
  ASSERT_EQ(complaints(problems), "");
  EXPECT_EQ(sample.main.pressure_pa, 10e6);
  EXPECT_EQ(sample.main.port, 8);
  EXPECT_EQ(origins.of("main.port").line_text(), rig + ":2");
  EXPECT_EQ(origins.of("main.pressure").line_text(), (folder_ / "parts/pump.yaml").string() + ":1");
}

TEST_F(Files, fault_in_an_included_file_is_placed_there) {
  write("pump.yaml", "pressure: 10 mm\n");
  const std::string rig = write("rig.yaml", "main: {include: pump.yaml}\n");
  Problems problems;
  const Value document = load_document(rig, problems);
  Sample sample;
  Origins origins;
  read(document, sample, problems, origins);
  EXPECT_THAT(complaints(problems), HasSubstr("pump.yaml:1:11: main.pressure: wrong unit"));
}

TEST_F(Files, missing_include_names_the_path_tried_and_the_near_name) {
  write("pump.yaml", "");
  const std::string rig = write("rig.yaml", "main: {include: pmup.yaml}\n");
  Problems problems;
  (void)load_document(rig, problems);
  EXPECT_THAT(
      complaints(problems),
      testing::AllOf(HasSubstr(rig + ":1:17: main.include: no such file \"pmup.yaml\", tried " +
                               (folder_ / "pmup.yaml").string() + ", "),
                     HasSubstr("configs/pmup.yaml"),
                     HasSubstr(", did you mean " + (folder_ / "pump.yaml").string() + "?")));
}

TEST_F(Files, include_is_found_in_the_folders_of_configurations) {
  const std::string rig = write("my_rig.yaml",
                                "a: {include: scenes/open_pit.yaml}\n"
                                "b: {include: ../scenes/open_pit.yaml}  # copied from rigs/\n");
  Problems problems;
  const Value document = load_document(rig, problems);
  EXPECT_EQ(complaints(problems), "");
  for (const char* key : {"a", "b"}) {
    ASSERT_NE(document.find(key), nullptr);
    EXPECT_NE(document.find(key)->find("terrain"), nullptr) << key;
  }
}

TEST_F(Files, a_file_beside_the_one_that_includes_it_beats_one_of_the_same_name_elsewhere) {
  fs::create_directories(folder_ / "scenes");
  write("scenes/open_pit.yaml", "own: 1\n");
  const std::string rig = write("my_rig.yaml", "a: {include: scenes/open_pit.yaml}\n");
  Problems problems;
  const Value document = load_document(rig, problems);
  EXPECT_NE(document.find("a")->find("own"), nullptr);
}

TEST_F(Files, circular_include_is_refused) {
  write("b.yaml", "main: {include: a.yaml}\n");
  const std::string a = write("a.yaml", "main: {include: b.yaml}\n");
  Problems problems;
  (void)load_document(a, problems);
  EXPECT_THAT(complaints(problems), HasSubstr("the file includes itself"));
}

TEST_F(Files, missing_file_and_folder_in_place_of_a_file_are_told_apart) {
  write("rig.yaml", "");
  Problems problems;
  (void)load_document((folder_ / "rgi.yaml").string(), problems);
  (void)load_document(folder_.string(), problems);
  EXPECT_EQ(complaints(problems), (folder_ / "rgi.yaml").string() +
                                      ": no such file, did you mean " +
                                      (folder_ / "rig.yaml").string() + "?\n" + folder_.string() +
                                      ": not a regular file, found a directory");
}

TEST(Document, duplicate_key_names_both_lines) {
  Problems problems;
  (void)parse_document("a: 1\nb: 2\na: 3\n", "a.yaml", ".", problems);
  EXPECT_EQ(complaints(problems), "a.yaml:3:1: a: the key is given twice, first in line 1");
}

TEST(Document, syntax_error_has_its_place) {
  Problems problems;
  (void)parse_document("a: [1, 2\nb: 3\n", "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("a.yaml:"));
  EXPECT_THAT(complaints(problems), HasSubstr("not valid YAML: "));
}

TEST(Document, key_that_is_a_list_is_refused) {
  Problems problems;
  (void)parse_document("[1, 2]: 3\n", "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("a key must be a word, found a list"));
}

/// The library's own loop over documents does not end there.
TEST(Document, ACommaIsNoDocumentAndIsToldAtOnce) {
  for (const std::string text : {",", ", a: 1", ",,,,"}) {
    Problems problems;
    (void)parse_document(text, "a.yaml", ".", problems);
    EXPECT_FALSE(problems.empty()) << text;
  }
}

TEST(Document, second_document_is_refused) {
  Problems problems;
  (void)parse_document("a: 1\n---\nb: 2\n", "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("more than one document"));
}

TEST(Document, top_that_is_a_list_is_refused) {
  EXPECT_THAT(findings("- 1\n"), HasSubstr("wrong kind of value, found a list"));
}

TEST(Document, aliases_that_multiply_are_bounded) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
    for (int k = 0; k < 10; ++k) {
      text += (k == 0 ? "" : ", ") + below;
    }
    text += "]\n";
  }
  Problems problems;
  (void)parse_document(text, "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("nested deeper than 64 levels, or more than"));
}

TEST(Document, deep_nesting_and_self_reference_are_bounded) {
  Problems problems;
  (void)parse_document(std::string(3000, '['), "a.yaml", ".", problems);
  EXPECT_FALSE(problems.empty());
  Problems loop;
  (void)parse_document("a: &a [*a]\n", "a.yaml", ".", loop);
  EXPECT_FALSE(loop.empty());
}

TEST(Document, bytes_that_are_no_text_are_refused_without_a_crash) {
  for (const char* text :
       {"\xff\xfe\x00z", "\x00\x01", "{{{", "a: \"\\q\"", "? : :", "%YAML 9\n"}) {
    Problems problems;
    (void)parse_document(text, "a.yaml", ".", problems);
  }
}

TEST(Document, bytes_that_are_not_utf8_are_refused_with_their_place) {
  Problems problems;
  const Value document = parse_document("a: 1\nname: caf\xE9\n", "a.yaml", ".", problems);
  EXPECT_EQ(complaints(problems),
            "a.yaml:2:10: not UTF-8, found byte 0xE9, allowed UTF-8 without control characters");
  EXPECT_TRUE(document.entries.empty());
}

TEST(Document, columns_count_characters) {
  Problems problems;
  (void)parse_document("\u00E4\u00F6: \x1B[2J\n", "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("a.yaml:1:5: a control character, found U+001B"));
}

TEST(Document, a_control_character_spelled_in_quotes_is_refused_too) {
  Problems problems;
  (void)parse_document("a: \"\\x1b[2J\"\n\"\\u009b\": 1\n", "a.yaml", ".", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("a.yaml:1:4: a: a control character, found U+001B"));
  EXPECT_THAT(complaints(problems), HasSubstr("a control character, found U+009B"));
  EXPECT_THAT(complaints(problems), Not(HasSubstr("\u009B"))) << "never shown";
}

TEST(Document, text_of_an_argument_that_is_not_utf8_is_refused) {
  Value document;
  document.kind = Value::Kind::map;
  Problems problems;
  apply_set(document, "name=caf\xE9", problems);
  EXPECT_EQ(complaints(problems),
            "--set name=caf\\xe9: not UTF-8, found byte 0xE9, allowed UTF-8 without control "
            "characters");
  EXPECT_TRUE(document.entries.empty());
}

TEST(Document, an_empty_map_over_a_map_is_refused_for_it_would_change_nothing) {
  Problems problems;
  Value document = parse_document("buses: {can: {ports: 2}}\nlist: [1]\n", "a.yaml", ".", problems);
  apply_set(document, "list=[]", problems);
  apply_set(document, "buses.other={}", problems);
  EXPECT_TRUE(problems.empty()) << complaints(problems);
  EXPECT_TRUE(document.find("list")->items.empty());
  EXPECT_NE(document.find("buses")->find("other"), nullptr) << "a new one has its defaults";
  apply_set(document, "buses={}", problems);
  EXPECT_EQ(complaints(problems),
            "--set buses={}: buses: a map without keys changes nothing, for maps merge, found {}, "
            "allowed keys with their new values");
}

TEST_F(Files, name_of_a_file_that_is_not_utf8_is_refused) {
  Problems problems;
  (void)load_document(write("caf\xE9.yaml", "a: 1\n"), problems);
  EXPECT_THAT(complaints(problems), HasSubstr("caf\\xe9.yaml: the file's name has byte 0xE9"));
}

TEST_F(Files, includes_without_end_are_refused) {
  write("leaf.yaml", "a: 1\n");
  std::string list;
  for (std::size_t i = 0; i < 200; ++i) {
    list += "leaf.yaml, ";
  }
  write("branch.yaml", "include: [" + list + "leaf.yaml]\n");
  std::string branches;
  for (std::size_t i = 0; i < 200; ++i) {
    branches += "branch.yaml, ";
  }
  const std::string rig = write("rig.yaml", "main: {include: [" + branches + "branch.yaml]}\n");
  Problems problems;
  (void)load_document(rig, problems);
  EXPECT_EQ(problems.size(), 1U) << complaints(problems);
  EXPECT_THAT(complaints(problems), HasSubstr("too many includes"));
  EXPECT_THAT(complaints(problems), HasSubstr("allowed 1000 in all"));
}

TEST_F(Files, includes_that_go_too_deep_are_not_called_circular) {
  for (std::size_t i = 0; i <= kMaximumIncludeDepth; ++i) {
    write("f" + std::to_string(i) + ".yaml", "include: f" + std::to_string(i + 1) + ".yaml\n");
  }
  write("f" + std::to_string(kMaximumIncludeDepth + 1) + ".yaml", "a: 1\n");
  Problems problems;
  (void)load_document((folder_ / "f0.yaml").string(), problems);
  EXPECT_THAT(complaints(problems), HasSubstr("includes are nested too deeply"));
  EXPECT_THAT(complaints(problems), Not(HasSubstr("includes itself")));
}

TEST(Document, aliases_count_as_what_they_stand_for) {
  // 200 000 times 10 kB in a file of a megabyte, and nine to the seventh power of values.
  std::string list = "a: &a " + std::string(10'000, 'x') + "\nb: [";
  for (int i = 0; i < 200'000; ++i) {
    list += "*a, ";
  }
  std::string power = "l0: &l0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (int i = 1; i < 7; ++i) {
    const std::string before = "*l" + std::to_string(i - 1);
    power += "l" + std::to_string(i) + ": &l" + std::to_string(i) + " [" + before;
    for (int j = 1; j < 9; ++j) {
      power += ", " + before;
    }
    power += "]\n";
  }
  for (const std::string& text : {list + "1]\n", power}) {
    Problems problems;
    (void)parse_document(text, "a.yaml", ".", problems);
    EXPECT_THAT(complaints(problems), HasSubstr("or more than 1000000 values or 67108864 bytes"));
  }
  Problems problems;
  (void)parse_request(power, "request", problems);
  EXPECT_THAT(complaints(problems), HasSubstr("an anchor or an alias in a request"));
}

TEST(Document, a_request_has_no_aliases_and_is_small) {
  const auto complaint = [](const std::string& text) {
    Problems problems;
    const Value value = parse_request(text, "request", problems);
    EXPECT_TRUE(problems.empty() || value.entries.empty()) << "a tree is made of " << text.size();
    return complaints(problems);
  };
  const auto keys = [](int count) {
    std::string text = "{";
    for (int i = 0; i < count; ++i) {
      text += "k" + std::to_string(i) + ": 1, ";
    }
    return text + "}";
  };
  const auto list = [](int count) {
    std::string text = "{a: [";
    for (int i = 0; i < count; ++i) {
      text += "1, ";
    }
    return text + "]}";
  };
  for (const char* text :
       {"{a: &x 1, b: *x}", "{a: &x [1]}", "&x {a: 1}", "{&x a: 1}", "{a: &x }"}) {
    EXPECT_THAT(complaint(text), HasSubstr("an anchor or an alias in a request")) << text;
  }
  EXPECT_THAT(complaint("{a: *x}"), HasSubstr("not valid YAML")) << "of nothing";
  EXPECT_EQ(complaint("{a: '&x *y', b: x*y}"), "") << "a text may hold the characters";
  EXPECT_EQ(complaint(keys(256)), "");
  EXPECT_THAT(complaint(keys(257)), HasSubstr("too many keys, found more than 256"));
  EXPECT_THAT(complaint(keys(6000)), HasSubstr("too many keys"));
  EXPECT_EQ(complaint(list(1022)), "");
  EXPECT_THAT(complaint(list(1023)), HasSubstr("too many values, found more than 1024"));
  EXPECT_EQ(complaint("{a: " + std::string(15, '[') + std::string(15, ']') + "}"), "");
  EXPECT_THAT(complaint("{a: " + std::string(16, '[') + std::string(16, ']') + "}"),
              HasSubstr("too many levels, found more than 16"));
  EXPECT_THAT(complaint(std::string(60'000, '[')), HasSubstr("too many levels"));
  EXPECT_THAT(complaint("{a: " + std::string(70'000, 'x') + "}"),
              HasSubstr("too long, found 70005 bytes"));
}

TEST(Document, what_a_file_has_is_quoted_in_part) {
  Problems problems;
  const Value document = parse_document(std::string(50'000, 'k') + ": " + std::string(50'000, 'v'),
                                        "a.yaml", ".", problems);
  Sample sample;
  Origins origins;
  read(document, sample, problems, origins);
  EXPECT_LT(complaints(problems).size(), 5000U);
}

TEST(Document, of_fifty_thousand_findings_a_hundred_are_reported_and_the_rest_counted) {
  std::string text;
  for (int i = 0; i < 50'000; ++i) {
    text += "k" + std::to_string(i) + ": 1\n";
  }
  Problems problems;
  Value document = parse_document(text, "a.yaml", ".", problems);
  EXPECT_EQ(document.entries.size(), 50'000U);
  EXPECT_TRUE(problems.empty());
  // Each key once more: 50 000 look-ups that a search along the list would not end.
  overlay(document, parse_document(text, "b.yaml", ".", problems));
  EXPECT_EQ(document.entries.size(), 50'000U);
  Sample sample;
  Origins origins;
  read(document, sample, problems, origins);
  EXPECT_EQ(problems.size(), 50'000U);
  const std::vector<Problem> told = problems.sorted();
  ASSERT_EQ(told.size(), Problems::kMostTold + 1);
  EXPECT_EQ(told.back().what, "and 49900 more");
}

}  // namespace
}  // namespace rigwire::hil
