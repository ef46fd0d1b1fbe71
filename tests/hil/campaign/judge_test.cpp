// Verdicts over truths that are written by hand.
#include "hil/campaign/judge.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Judge : public testing::Test {
 protected:
  ~Judge() override { fs::remove(evidence_.truth); }
  Judge() {
    evidence_.truth = fs::temp_directory_path() / ("rigwire-truth-" + std::to_string(::getpid()));
    evidence_.duration = std::chrono::seconds{100};
    evidence_.report = nlohmann::ordered_json::parse(
        R"({"clock_slips":0,"slipped_s":0.0,"overrun":{"first":[]},
            "devices":{"gnss":{"frames":7,"dropped":2,"lateness_us":{"p99":12.5}}}})");
  }
  /// East along the x axis, a metre in each second, level; touches from `touched_s` on.
  void drive(double seconds, double touched_s = 1e9) const {
    std::ofstream truth(evidence_.truth);
    for (double at = 0.0; at <= seconds; at += 0.5) {
      truth << fmt::format(
          R"({{"sim_s":{},"position_m":[{},0,0],"attitude_wxyz":[1,0,0,0],"velocity_mps":[1,0,0],)"
          R"("joint":[{},{}],"contact":{{"touching":{},"body":"cab","with":"trunk"}}}})"
          "\n",
          at, at, at, -at, at >= touched_s);
    }
  }
  template <class Criterion>
  Verdict verdict(const Criterion& criterion) const {
    Campaign campaign;
    campaign.criteria["c"].test = criterion;
    return judge(campaign, evidence_).verdicts.at("c");
  }

  RunEvidence evidence_;
};

TEST_F(Judge, a_quantity_reaches_a_value_at_an_instant) {
  drive(10);
  const Verdict reached = verdict(ReachesCriterion{"joint.0", true, 3.2, std::chrono::seconds{20}});
  EXPECT_TRUE(reached.passed);
  EXPECT_EQ(reached.at_s, 3.5);
  EXPECT_TRUE(verdict(ReachesCriterion{"joint.1", false, -9.0, std::chrono::seconds{20}}).passed);
  EXPECT_FALSE(verdict(ReachesCriterion{"joint.0", true, 3.2, std::chrono::seconds{3}}).passed);
  EXPECT_EQ(verdict(ReachesCriterion{"joint.0", true, 50, std::chrono::seconds{20}}).detail,
            "at most 10");
}

TEST_F(Judge, a_quantity_stays_until_it_does_not) {
  drive(10);
  EXPECT_TRUE(verdict(StaysCriterion{"joint.0", false, 10.1}).passed);
  const Verdict left = verdict(StaysCriterion{"joint.0", false, 4.0});
  EXPECT_FALSE(left.passed);
  EXPECT_EQ(left.at_s, 4.0);
  EXPECT_EQ(left.detail, "at worst 10");
}

TEST_F(Judge, what_comes_after_the_duration_is_not_looked_at) {
  drive(10);
  evidence_.duration = std::chrono::seconds{3};
  EXPECT_TRUE(verdict(StaysCriterion{"joint.0", false, 4.0}).passed);
}

TEST_F(Judge, derived_quantities_are_those_of_the_motion) {
  std::ofstream(evidence_.truth)
      << R"({"sim_s":0,"position_m":[0,0,0],"attitude_wxyz":[0.7071067811865476,0,0,0.7071067811865476],"velocity_mps":[3,4,0]})"
      << "\n"
      << R"({"sim_s":1,"position_m":[3,4,0],"attitude_wxyz":[0.9659258262890683,0.25881904510252074,0,0],"velocity_mps":[0,0,0]})"
      << "\n"
      << R"({"sim_s":2,"position_m":[3,5,0],"attitude_wxyz":[0.9659258262890683,0,-0.25881904510252074,0],"velocity_mps":[0,0,0]})"
      << "\n";
  const auto at = [&](const char* quantity, double value) {
    return verdict(ReachesCriterion{quantity, true, value - 1e-6, std::chrono::hours{1}}).at_s;
  };
  EXPECT_EQ(at("speed_mps", 5.0), 0.0);
  EXPECT_EQ(at("heading_deg", 90.0), 0.0);
  EXPECT_EQ(at("roll_deg", 30.0), 1.0) << "left side up";
  EXPECT_EQ(at("pitch_deg", 30.0), 2.0) << "nose up";
  EXPECT_EQ(at("travelled_m", 6.0), 2.0);
  EXPECT_EQ(at("travelled_m", 6.1), std::nullopt);
}

TEST_F(Judge, it_arrives_at_a_place_and_not_before_it_may) {
  drive(10);
  ArrivesCriterion there{{6.0, 0.5}, 1.0, Duration{0}};
  EXPECT_EQ(verdict(there).at_s, 5.5);
  there.after = std::chrono::seconds{6};
  EXPECT_EQ(verdict(there).at_s, 6.0);
  there.after = std::chrono::seconds{8};
  EXPECT_FALSE(verdict(there).passed);
}

TEST_F(Judge, a_contact_is_told_with_what_met) {
  drive(10, 7.0);
  const Verdict met = verdict(NoContactCriterion{});
  EXPECT_FALSE(met.passed);
  EXPECT_EQ(met.at_s, 7.0);
  EXPECT_EQ(met.text, "cab hit trunk");
  drive(10);
  EXPECT_TRUE(verdict(NoContactCriterion{}).passed);
}

TEST_F(Judge, a_program_that_was_ended_has_not_ended) {
  drive(1);
  evidence_.program = ProgramEnd{false, 0};
  EXPECT_FALSE(verdict(ProgramExitCriterion{0}).passed);
  evidence_.program = ProgramEnd{true, 4};
  EXPECT_EQ(verdict(ProgramExitCriterion{0}).text, "the program ended with status 4");
  EXPECT_TRUE(verdict(ProgramExitCriterion{4}).passed);
}

TEST_F(Judge, figures_of_devices_and_of_the_clock_are_the_reports) {
  drive(1);
  EXPECT_FALSE(verdict(DeviceCriterion{"gnss", "dropped", false, 1.0}).passed);
  EXPECT_TRUE(verdict(DeviceCriterion{"gnss", "lateness_us.p99", false, 13.0}).passed);
  EXPECT_TRUE(verdict(NoSlipCriterion{}).passed);
  evidence_.report["clock_slips"] = 2;
  evidence_.report["overrun"]["first"] = {{{"sim_s", 0.5}, {"behind_s", 0.2}}};
  EXPECT_EQ(verdict(NoSlipCriterion{}).at_s, 0.5);
}

// A criterion had to name joint_rad.1 where `wait` knows boom.
TEST_F(Judge, words_of_read_are_judged_in_the_unit_that_the_user_wrote) {
  std::ofstream(evidence_.truth)
      << R"({"sim_s":0,"position_m":[0,0,0],"attitude_wxyz":[1,0,0,0],"velocity_mps":[0,0,0],)"
         R"("joint_rad":[0,0.75],"state":{"boom":42.9718346349,"tip height":2.5},)"
         R"("contact":{"touching":false}})"
      << "\n";
  evidence_.quantities = {{"boom", "deg"}, {"tip height", "m"}};
  const auto judged = [&](const char* quantity, const char* value) {
    ReachesCriterion criterion;
    criterion.quantity = quantity;
    criterion.value.text = value;
    return verdict(criterion);
  };
  EXPECT_TRUE(judged("boom", "42.9").passed);
  EXPECT_TRUE(judged("boom", "42.9 deg").passed);
  EXPECT_TRUE(judged("boom", "0.7 rad").passed);
  EXPECT_TRUE(judged("state.boom", "0.7 rad").passed);
  EXPECT_TRUE(judged("joint_rad.1", "42.9 deg").passed);
  EXPECT_TRUE(judged("tip height", "240 cm").passed);
  const Verdict bare = judged("boom", "55");
  EXPECT_FALSE(bare.passed);
  EXPECT_EQ(bare.text, "was never boom above 55 deg");
  EXPECT_EQ(bare.detail, "at most 42.9718 deg");
  const Verdict in_rad = judged("boom", "0.96 rad");
  EXPECT_EQ(in_rad.text, "was never boom above 0.96 rad");
  EXPECT_EQ(in_rad.detail, "at most 0.75 rad");
  EXPECT_THROW((void)judged("boom", "55 m"), std::invalid_argument);
  EXPECT_THROW((void)judged("bom", "55"), std::invalid_argument);
}

TEST_F(Judge, what_the_run_does_not_have_is_refused_with_the_nearest_that_it_has) {
  drive(1);
  const auto refusal = [&](const auto& criterion) -> std::string {
    try {
      static_cast<void>(verdict(criterion));
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(StaysCriterion{"joints.0", true, 0}),
              testing::AllOf(HasSubstr("criteria.c.quantity"), HasSubstr("did you mean joint.0?"),
                             testing::Not(HasSubstr("position_m"))))
      << "without the list of all names";
  EXPECT_THAT(refusal(StaysCriterion{"joint.2", true, 0}), HasSubstr("joint.2"));
  EXPECT_THAT(refusal(DeviceCriterion{"imu", "frames", true, 0}), HasSubstr("allowed gnss"));
  EXPECT_THAT(refusal(DeviceCriterion{"gnss", "lateness_us.p98", true, 0}),
              HasSubstr("did you mean lateness_us.p99?"));
}

TEST_F(Judge, a_truth_that_is_cut_off_is_not_judged) {
  EXPECT_THROW((void)verdict(NoContactCriterion{}), std::runtime_error) << "no file";
  drive(1);
  std::ofstream(evidence_.truth, std::ios::app) << R"({"sim_s":1.5,"posi)";
  EXPECT_THROW((void)verdict(NoContactCriterion{}), std::runtime_error);
}

TEST_F(Judge, a_run_that_ended_before_its_first_record_is_judged_by_the_rest) {
  std::ofstream(evidence_.truth) << "";
  evidence_.program = ProgramEnd{true, 3};
  EXPECT_TRUE(verdict(ProgramExitCriterion{3}).passed);
  EXPECT_FALSE(verdict(StaysCriterion{"joint.0", false, 1}).passed);
  EXPECT_FALSE(verdict(ReachesCriterion{"joint.0", false, 1}).passed);
  EXPECT_FALSE(verdict(NoContactCriterion{}).passed) << "nobody looked";
}

TEST_F(Judge, the_first_failure_is_the_earliest_and_the_track_is_thin) {
  drive(1000, 30.0);
  evidence_.duration = std::chrono::hours{1};
  Campaign campaign;
  campaign.criteria["a_late"].test = StaysCriterion{"joint.0", false, 40};
  campaign.criteria["b_early"].test = NoContactCriterion{};
  campaign.criteria["c_end"].test = ReachesCriterion{"joint.0", true, 1e9};
  const Judgement judgement = judge(campaign, evidence_);
  EXPECT_EQ(judgement.first_failure, "b_early");
  EXPECT_LE(judgement.track.size(), 201u);
  EXPECT_GE(judgement.track.size(), 100u);
  EXPECT_EQ(judgement.track.back()[0], 1000.0);
  EXPECT_EQ(judgement.end_s, 1000.0);
  const double step_s = judgement.track[1][0] - judgement.track[0][0];
  for (std::size_t i = 2; i + 1 < judgement.track.size(); ++i) {
    EXPECT_DOUBLE_EQ(judgement.track[i][0] - judgement.track[i - 1][0], step_s);
  }
}

}  // namespace
}  // namespace rigwire::hil
