// What a campaign's file says, and what is refused of it.
#include "hil/campaign/campaign_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "hil/campaign/csv_table.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class CampaignFile : public testing::Test {
 protected:
  CampaignFile() { fs::create_directories(folder_); }
  ~CampaignFile() override { fs::remove_all(folder_); }

  fs::path file(const std::string& text, const std::string& name = "campaign.yaml") const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string complaints(const std::string& text) const {
    try {
      static_cast<void>(load_campaign(file(text)));
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_ = fs::temp_directory_path() / ("rigwire-campaign-" + std::to_string(::getpid()));
};

const std::string kGood =
    "rig: r\nparameters:\n  a: {type: values, values: [1, 2], keys: [k]}\n"
    "criteria:\n  whole: {type: no_contact}\n";

TEST_F(CampaignFile, is_read_with_its_defaults) {
  const LoadedCampaign loaded = load_campaign(file(kGood));
  EXPECT_EQ(loaded.campaign.clock, "free");
  EXPECT_EQ(loaded.campaign.design, CampaignDesign::grid);
  EXPECT_THAT(loaded.campaign.parameters.at("a").keys, ElementsAre("k"));
}

TEST_F(CampaignFile, comments_do_not_make_it_another_campaign) {
  const std::string hash = load_campaign(file(kGood)).hash;
  EXPECT_EQ(load_campaign(file("# said\n" + kGood)).hash, hash);
  EXPECT_NE(load_campaign(file(kGood + "seed: 2\n")).hash, hash);
}

TEST_F(CampaignFile, what_would_bind_nothing_is_refused) {
  EXPECT_THAT(complaints("rig: r\nparameters: {a: {type: values, values: [1]}}\n"
                         "criteria: {c: {type: no_contact}}\n"),
              HasSubstr("parameters.a.keys: found none, allowed a key of the rig, or {a} in the"));
  EXPECT_THAT(complaints("rig: r\nruns: 5\ncriteria: {c: {type: no_contact}}\n"),
              HasSubstr("runs"));
  EXPECT_THAT(complaints("rig: r\n"), HasSubstr("criteria: found none"));
  EXPECT_THAT(complaints("rig: r\ncriteria: {c: {type: program_exit}}\n"),
              HasSubstr("criteria.c: found program_exit"));
  EXPECT_THAT(complaints("rig: r\ncriteria: {c: {type: no_slip}}\n"), HasSubstr("no_slip"));
  EXPECT_THAT(complaints("rig: r\nprogram: [x]\ncriteria: {c: {type: no_contact}}\n"),
              HasSubstr("clock: found free, allowed real or scaled:X"));
}

TEST_F(CampaignFile, a_value_of_a_criterion_may_have_its_unit) {
  const auto with = [](const std::string& value) {
    return "rig: r\ncriteria: {c: {type: reaches, quantity: boom, value: " + value + "}}\n";
  };
  const LoadedCampaign loaded = load_campaign(file(with("55 deg")));
  EXPECT_EQ(std::get<ReachesCriterion>(loaded.campaign.criteria.at("c").test).value.text, "55 deg");
  EXPECT_EQ(loaded.origins.of("criteria.c.quantity").line, 2);
  EXPECT_EQ(complaints(with("-1.5e3")), "");
  EXPECT_THAT(complaints(with("high")), HasSubstr(":2:"));
  EXPECT_THAT(complaints(with("high")),
              HasSubstr("criteria.c.value: not a number, found \"high\", allowed a number"));
  EXPECT_THAT(complaints(with(".inf")), HasSubstr("criteria.c.value: not a number"));
}

TEST_F(CampaignFile, what_a_design_cannot_have_is_refused) {
  EXPECT_THAT(complaints("rig: r\nparameters: {a: {type: uniform, from: 0, to: 1, keys: [k]}}\n"
                         "criteria: {c: {type: no_contact}}\n"),
              HasSubstr("parameters.a.type: found uniform"));
  EXPECT_THAT(complaints(kGood + "design: sobol\nruns: 100\n"), HasSubstr("a power of two"));
  EXPECT_THAT(complaints(kGood + "design: random\n"), HasSubstr("runs: found 0"));
  EXPECT_THAT(complaints(kGood + "design: randon\n"), HasSubstr("random"));
}

TEST_F(CampaignFile, names_and_keys_that_would_be_two_things_are_refused) {
  EXPECT_THAT(complaints("rig: r\nparameters: {seed: {type: values, values: [1], keys: [k]}}\n"
                         "criteria: {c: {type: no_contact}}\n"),
              HasSubstr("parameters.seed"));
  EXPECT_THAT(complaints("rig: r\nparameters:\n  a: {type: values, values: [1], keys: [k]}\n"
                         "  b: {type: values, values: [1], keys: [k]}\n"
                         "criteria: {c: {type: no_contact}}\n"),
              HasSubstr("parameters.b.keys: found k, allowed each key once"));
}

TEST_F(CampaignFile, values_of_a_file_are_a_column_of_it) {
  file("name,mass\n\"a, b\",1 t\nc,2 t\n", "loads.csv");
  const std::string campaign =
      "rig: r\nparameters: {a: {type: from_file, file: loads.csv, column: COLUMN, keys: [k]}}\n"
      "criteria: {c: {type: no_contact}}\n";
  const auto with = [&](const std::string& column) {
    std::string text = campaign;
    return complaints(text.replace(text.find("COLUMN"), 6, column));
  };
  EXPECT_EQ(with("mass"), "");
  EXPECT_THAT(with("weight"), HasSubstr("no such column, found \"weight\", allowed name, mass"));
}

TEST(CsvTable, is_read_as_it_is_written) {
  const std::vector<std::string> row{"plain", "with, comma", "with \"quotes\"", ""};
  const CsvTable table = parse_csv("# said\na,b,c,d\r\n" + csv_line(row), "t");
  EXPECT_THAT(table.columns, ElementsAre("a", "b", "c", "d"));
  EXPECT_THAT(table.rows, ElementsAre(row));
}

TEST(CsvTable, what_is_no_table_is_refused_with_its_line) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_csv(text, "t"));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal("a,b\n1\n"), HasSubstr("t:2: found 1 fields, allowed 2"));
  EXPECT_THAT(refusal("a\n\"1\n"), HasSubstr("t:2: a quote that does not end"));
  EXPECT_THAT(refusal("a\n"), HasSubstr("no rows"));
  EXPECT_THAT(refusal(""), HasSubstr("no rows"));
  EXPECT_THAT(refusal("a\n\xff\n"), HasSubstr("not UTF-8"));
  EXPECT_THAT(refusal("#"), HasSubstr("no rows"));
}

TEST(Placeholders, are_the_words_in_braces) {
  EXPECT_THAT(placeholders("--at={east},{north}"), ElementsAre("east", "north"));
  EXPECT_THAT(placeholders("{open"), ElementsAre());
  EXPECT_THAT(placeholders("plain"), ElementsAre());
}

}  // namespace
}  // namespace rigwire::hil
