// Rows from folders, the tables made of them, and what the report says.
#include "hil/campaign/campaign_report.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "child_process.h"
#include "hil/campaign/collect.h"
#include "hil/campaign/csv_table.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A campaign's folder with runs that are written by hand.
class CampaignRows : public testing::Test {
 protected:
  CampaignRows() { fs::create_directories(folder_ / "runs"); }
  ~CampaignRows() override { fs::remove_all(folder_); }

  /// Parameters: mass, from 0 t on in steps of 1 t, and kind.
  void plan(std::size_t runs) const {
    nlohmann::json plan{{"name", "loads & <ramps>"},
                        {"campaign", "/c.yaml"},
                        {"identity", "0"},
                        {"runs", runs},
                        {"parameters", {"kind", "mass"}},
                        {"criteria", {"whole"}}};
    std::ofstream(folder_ / "plan.json") << plan;
    std::ofstream table(folder_ / "table.csv");
    table << "index,seed,kind,mass\n";
    for (std::size_t i = 0; i < runs; ++i) {
      table << fmt::format("{},{},{},{} t\n", i, 100 + i, i % 2 == 0 ? "even" : "odd", i);
    }
  }
  void run(std::size_t index, bool passed, bool done = true) const {
    const fs::path folder = run_folder(folder_, index);
    fs::create_directories(folder);
    nlohmann::json result{
        {"index", index},
        {"outcome", passed ? "passed" : "failed"},
        {"what", nullptr},
        {"sim_s", 9.5},
        {"first_failure", nullptr},
        {"criteria",
         {{"whole",
           {{"passed", passed}, {"at_s", nullptr}, {"text", "cab hit trunk"}, {"detail", ""}}}}},
        {"track", {{0.0, 1.0, 2.0}, {1.0, 2.0, 3.0}}}};
    if (!passed) {
      result["first_failure"] = "whole";
      result["criteria"]["whole"]["at_s"] = 10.0 - static_cast<double>(index);
    }
    std::ofstream(folder / "result.json") << result;
    if (done) {
      std::ofstream(folder / "DONE") << "done\n";
    }
  }

  fs::path folder_ = fs::temp_directory_path() / ("rigwire-rows-" + std::to_string(::getpid()));
};

TEST_F(CampaignRows, there_is_one_for_each_run_whatever_became_of_it) {
  plan(6);
  run(0, true);
  run(1, false);
  run(2, true, false);  // killed before DONE
  fs::create_directories(run_folder(folder_, 3));
  fs::create_directories(run_folder(folder_, 4));
  std::ofstream(run_folder(folder_, 4) / "result.json") << "{\"outcome\": \"pas";
  const CampaignTable table = read_rows(folder_);
  std::vector<Outcome> outcomes;
  for (const CampaignRow& row : table.rows) {
    outcomes.push_back(row.outcome);
  }
  EXPECT_THAT(outcomes, ElementsAre(Outcome::passed, Outcome::failed, Outcome::unfinished,
                                    Outcome::unfinished, Outcome::crashed, Outcome::missing));
  EXPECT_EQ(table.rows[4].values[1], "4 t") << "also of what cannot be read";
}

TEST_F(CampaignRows, results_of_somebody_else_are_rows_that_crashed) {
  plan(4);
  const auto put = [&](std::size_t index, const std::string& text) {
    fs::create_directories(run_folder(folder_, index));
    std::ofstream(run_folder(folder_, index) / "result.json") << text;
  };
  put(0, R"({"outcome":"splendid","what":null})");
  put(1, R"({"outcome":"failed","what":null,"first_failure":"gone","criteria":{}})");
  put(2, R"([1,2])");
  put(3, R"({"outcome":"passed","what":null,"track":[["a"]]})");
  EXPECT_EQ(read_rows(folder_).count(Outcome::crashed), 4u);
}

TEST_F(CampaignRows, a_result_is_judged_by_its_parts_and_belongs_to_its_run) {
  plan(4);
  run(0, true);
  run(1, true);
  run(2, false);
  const auto change = [&](std::size_t index, const char* key, const nlohmann::json& value) {
    const fs::path file = run_folder(folder_, index) / "result.json";
    nlohmann::json result;
    std::ifstream(file) >> result;
    result[key] = value;
    std::ofstream(file) << result;
  };
  change(0, "index", 3);
  change(2, "outcome", "passed");
  const CampaignTable table = read_rows(folder_);
  EXPECT_EQ(table.rows[0].outcome, Outcome::crashed);
  EXPECT_THAT(table.rows[0].what, HasSubstr("of another run"));
  EXPECT_EQ(table.rows[1].outcome, Outcome::passed);
  EXPECT_EQ(table.rows[2].outcome, Outcome::crashed);
  EXPECT_THAT(table.rows[2].what, HasSubstr("contradicts its criteria"));
}

TEST_F(CampaignRows, a_table_with_one_index_twice_is_refused) {
  plan(2);
  std::ofstream(folder_ / "table.csv") << "index,seed,kind,mass\n1,100,even,0 t\n1,101,odd,1 t\n";
  EXPECT_THROW((void)read_rows(folder_), std::invalid_argument);
}

TEST_F(CampaignRows, tables_are_made_anew_and_read_by_sqlite) {
  plan(4);
  run(0, true);
  run(1, false);
  write_tables(folder_, read_rows(folder_));
  run(2, true);
  write_tables(folder_, read_rows(folder_));
  const CsvTable csv = read_csv(folder_ / "results.csv");
  EXPECT_THAT(csv.column("outcome"), ElementsAre("passed", "failed", "passed", "missing"));
  test::ChildProcess sqlite(
      {"/usr/bin/python3", "-c",
       "import sqlite3,sys\n"
       "db = sqlite3.connect(sys.argv[1])\n"
       "print(db.execute('select sum(mass), count(*) from runs where outcome = "
       "\"passed\"').fetchall(),"
       " db.execute('select run, text, at_s from criteria where not passed').fetchall(),"
       " db.execute('select * from parameters').fetchall(), db.execute('pragma "
       "integrity_check').fetchall())",
       folder_ / "results.sqlite"},
      folder_ / "output");
  ASSERT_EQ(sqlite.wait(std::chrono::seconds{30}).value_or(-1), 0) << sqlite.output();
  EXPECT_EQ(sqlite.output(),
            "[(2.0, 2)] [(1, 'cab hit trunk', 9.0)] [('kind', None), ('mass', 't')] [('ok',)]\n");
}

TEST_F(CampaignRows, a_table_of_another_plan_is_refused) {
  plan(3);
  std::ofstream(folder_ / "table.csv") << "index,seed,kind,mass\n0,1,even,0 t\n";
  EXPECT_THROW((void)read_rows(folder_), std::invalid_argument);
  fs::remove(folder_ / "plan.json");
  EXPECT_THROW((void)read_rows(folder_), std::invalid_argument);
}

TEST_F(CampaignRows, the_report_tells_rate_classes_groups_and_the_worst) {
  plan(8);
  for (std::size_t i = 0; i < 8; ++i) {
    run(i, i < 4);
  }
  const CampaignTable table = read_rows(folder_);
  const std::string text = report_text(table);
  EXPECT_THAT(text, HasSubstr("4 of 8, 50.0 % (21.5 % .. 78.5 %)"));
  EXPECT_THAT(text, HasSubstr("mass  0 .. 1 t: 2 of 2"));
  EXPECT_THAT(text, HasSubstr("mass  6 .. 7 t: 0 of 2"));
  EXPECT_THAT(text, HasSubstr("kind  even: 2 of 4"));
  EXPECT_THAT(text, HasSubstr("4  whole: cab hit trunk (runs 4, 5, 6, 7)"));
  EXPECT_THAT(text, HasSubstr("rigwire campaign run /c.yaml --index 7 -o again"));
  EXPECT_EQ(worst_runs(table).front()->index, 7u) << "it failed first";
  const std::string page = report_page(table, {});
  EXPECT_THAT(page, HasSubstr("loads &amp; &lt;ramps&gt;"));
  EXPECT_THAT(page, Not(HasSubstr("<ramps>")));
  EXPECT_THAT(page, HasSubstr("polyline"));
  EXPECT_THROW((void)report_page(table, {"kind", "mass"}), std::invalid_argument);
}

// Names of quantities were told as position_m.# and pump_flow_m#ps.
TEST_F(CampaignRows, grouped_reasons_mask_numbers_and_keep_names) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"no position_m.0, pump_flow_m3ps or gnss-2 at 12.5 s.",
       "no position_m.0, pump_flow_m3ps or gnss-2 at # s."},
      {"the rig ended by signal 6: 0-19, -1e-05 and 3s, 127.0.0.1:8080",
       "the rig ended by signal #: #, # and #s, #:#"},
      {"/tmp/runs/000017/rig.log: [4]", "/tmp/runs/#/rig.log: [#]"},
      {"no digits - at all...", "no digits - at all..."},
      {"grün 7", "grün #"},
  };
  plan(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    fs::create_directories(run_folder(folder_, i));
    std::ofstream(run_folder(folder_, i) / "result.json")
        << nlohmann::json{{"index", i}, {"outcome", "crashed"}, {"what", cases[i].first}};
  }
  std::vector<std::string> found;
  for (const FailureGroup& group : failure_groups(read_rows(folder_))) {
    found.push_back(group.text);
  }
  std::vector<std::string> expected;
  for (const auto& [reason, grouped] : cases) {
    expected.push_back(grouped);
  }
  EXPECT_THAT(found, testing::UnorderedElementsAreArray(expected));
}

TEST(Wilson, intervals_are_those_of_the_formula_and_never_leave_0_to_1) {
  // E. B. Wilson (1927): share 0.5 of 10.
  const ShareInterval half = wilson_interval(5, 10);
  EXPECT_NEAR(half.lower, 0.2366, 5e-5);
  EXPECT_NEAR(half.upper, 0.7634, 5e-5);
  EXPECT_EQ(wilson_interval(0, 20).lower, 0.0);
  EXPECT_NEAR(wilson_interval(0, 20).upper, 0.1611, 5e-5);
  EXPECT_EQ(wilson_interval(20, 20).upper, 1.0);
  EXPECT_EQ(wilson_interval(0, 0).upper, 1.0);
}

}  // namespace
}  // namespace rigwire::hil
