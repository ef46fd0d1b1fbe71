#include "hil/record/report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

RunReport example() {
  RunReport report;
  report.rig = "example";
  report.seed = 7;
  report.config_hash = "00ff";
  report.clock = {ClockMode::Kind::scaled, 2.0};
  report.outcome.reached = kStart + 10s;
  report.outcome.wall_s = 5.0;
  DeviceReport gnss{"gnss", "/tmp/gnss", 70, {}, {}, {}};
  gnss.statistics.bytes = 5730;
  gnss.statistics.lateness.record(100us);
  report.devices.push_back(gnss);
  return report;
}

TEST(Report, HasTheKeysThatScriptsRelyOn) {
  const auto json = nlohmann::json::parse(to_json(example()));
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["config_hash"], "00ff");
  EXPECT_EQ(json["clock"], "scaled:2");
  EXPECT_EQ(json["sim_s"], 10.0);
  EXPECT_EQ(json["realtime_factor"], 2.0);
  for (const char* stage : {"physics", "ray_casting", "sensors", "encoding", "writing"}) {
    EXPECT_TRUE(json["stages"][stage].is_number()) << stage;
  }
  const auto& gnss = json["devices"]["gnss"];
  EXPECT_EQ(gnss["wire"], "/tmp/gnss");
  EXPECT_EQ(gnss["frames"], 70);
  EXPECT_EQ(gnss["bytes"], 5730);
  EXPECT_EQ(gnss["dropped"], 0);
  EXPECT_EQ(gnss["lateness_us"]["max"], 100.0);
  EXPECT_EQ(gnss["stream_hash"].get<std::string>().size(), 16U);
}

TEST(Report, TheClassesOfLatenessHoldEveryRecordOnce) {
  RunReport report = example();
  report.devices[0].statistics.lateness.record(3s);
  const auto json = nlohmann::json::parse(to_json(report));
  std::uint64_t records = 0;
  for (const auto& [edge, count] :
       json["devices"]["gnss"]["lateness_us"]["histogram"]
           .get<std::vector<std::pair<nlohmann::json, std::uint64_t>>>()) {
    records += count;
    EXPECT_EQ(edge.is_null(), count == 1 && records == 2) << edge;
  }
  EXPECT_EQ(records, 2U);
}

TEST(Report, OverrunsAreToldWithTheirPolicy) {
  RunReport report = example();
  report.overrun = OverrunPolicy::warn;
  report.outcome.overruns = 3;
  report.outcome.first_overruns = {{kStart + 2s, 250ms}};
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["overrun"]["policy"], "warn");
  EXPECT_EQ(json["overrun"]["count"], 3);
  EXPECT_EQ(json["overrun"]["first"][0]["sim_s"], 2.0);
  EXPECT_EQ(json["overrun"]["first"][0]["behind_s"], 0.25);
}

TEST(Report, NamesInMetricsAreQuoted) {
  RunReport report = example();
  report.rig = "a \"b\\\n";
  EXPECT_NE(to_prometheus(report).find(R"(rig="a \"b\\\n")"), std::string::npos);
}

TEST(Report, AnEmptyRunHasNoInfiniteFactor) {
  RunReport report = example();
  report.outcome.wall_s = 0.0;
  EXPECT_EQ(nlohmann::json::parse(to_json(report))["realtime_factor"], 0.0);
}

TEST(Report, HasWhatClientsAskedAndWhichFaultsActed) {
  RunReport report = example();
  report.devices[0].last_request = ClientRequest{kStart + 2500ms, "UBX CFG 0x08"};
  report.faults.push_back({"gnss", "jamming", kStart + 5s, kStart + 10s});
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(json["devices"]["gnss"]["last_request"]["text"], "UBX CFG 0x08");
  EXPECT_EQ(json["devices"]["gnss"]["last_request"]["sim_s"], 2.5);
  EXPECT_EQ(json["faults"][0]["where"], "gnss");
  EXPECT_EQ(json["faults"][0]["type"], "jamming");
  EXPECT_EQ(json["faults"][0]["begin_s"], 5.0);
  EXPECT_EQ(json["faults"][0]["end_s"], 10.0);
  EXPECT_TRUE(
      nlohmann::json::parse(to_json(example()))["devices"]["gnss"]["last_request"].is_null());
}

TEST(Report, ARequestThatIsNotUtf8DoesNotLoseTheReport) {
  RunReport report = example();
  report.devices[0].last_request = ClientRequest{kStart,
                                                 "GET /Stra\xdf"
                                                 "e"};
  EXPECT_EQ(nlohmann::json::parse(to_json(report))["rig"], "example");
}

}  // namespace
}  // namespace rigwire::hil
