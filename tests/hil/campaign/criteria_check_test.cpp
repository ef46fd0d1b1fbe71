// Criteria held against what a rig's runs will have, before any run.
#include "hil/campaign/criteria_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "hil/campaign/bound.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

JudgedRig digger() {
  return {
      .quantities = {{"swing", "deg"}, {"boom", "deg"}, {"tip height", "m"}, {"tipped", ""}},
      .truth = {"sim_s", "joint_rad.0", "joint_rad.1", "pump_flow_m3ps", "tipped", "state.boom"},
      .meets_obstacles = false,
      .devices = {"gnss", "valves"}};
}

/// What is said of one criterion, `c`.
template <class Criterion>
std::vector<std::string> said_of(const Criterion& criterion) {
  LoadedCampaign campaign;
  campaign.campaign.criteria["c"].test = criterion;
  campaign.origins.set("criteria.c", {std::make_shared<const std::string>("camp.yaml"), 7, 11, 0});
  Problems problems;
  check_criteria(campaign, digger(), problems);
  std::vector<std::string> lines;
  for (const Problem& problem : problems.sorted()) {
    lines.push_back(problem.line());
  }
  return lines;
}

std::vector<std::string> said_of_quantity(const std::string& quantity, const std::string& value) {
  ReachesCriterion criterion;
  criterion.quantity = quantity;
  criterion.value.text = value;
  return said_of(criterion);
}

TEST(CriteriaCheck, takes_words_keys_and_derived_quantities) {
  for (const char* quantity : {"boom", "joint_rad.1", "state.boom", "heading_deg", "roll_deg"}) {
    EXPECT_THAT(said_of_quantity(quantity, "0.5"), IsEmpty()) << quantity;
    EXPECT_THAT(said_of_quantity(quantity, "0.5 rad"), IsEmpty()) << quantity;
    EXPECT_THAT(said_of_quantity(quantity, "55 deg"), IsEmpty()) << quantity;
  }
  EXPECT_THAT(said_of_quantity("pump_flow_m3ps", "60 l/min"), IsEmpty());
  EXPECT_THAT(said_of_quantity("speed_mps", "5 km/h"), IsEmpty());
}

TEST(CriteriaCheck, names_the_place_and_a_short_list_of_what_there_is) {
  const std::vector<std::string> said = said_of_quantity("bom", "55");
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(
      said[0],
      AllOf(HasSubstr("camp.yaml:7:11: criteria.c.quantity: the machine has no such quantity, "
                      "found \"bom\", allowed swing (deg), boom (deg)"),
            HasSubstr("did you mean boom?"), Not(HasSubstr("joint_rad"))));
  EXPECT_THAT(said_of_quantity("joint_rad.7", "1"),
              ElementsAre(HasSubstr("did you mean joint_rad.0?")));
}

TEST(CriteriaCheck, names_that_are_several_quantities_are_refused) {
  EXPECT_THAT(said_of_quantity("joint_rad", "1"),
              ElementsAre(HasSubstr("holds several numbers, found \"joint_rad\", allowed "
                                    "joint_rad.0, joint_rad.1")));
  EXPECT_THAT(said_of_quantity("tipped", "1"),
              ElementsAre(HasSubstr("two quantities have this name, found \"tipped\", allowed "
                                    "state.tipped")));
}

TEST(CriteriaCheck, a_unit_of_another_kind_is_refused) {
  EXPECT_THAT(said_of_quantity("boom", "55 m"),
              ElementsAre(HasSubstr("criteria.c.value: wrong unit, found \"55 m\", allowed rad")));
  EXPECT_THAT(said_of_quantity("joint_rad.1", "55 bar"), ElementsAre(HasSubstr("wrong unit")));
  EXPECT_THAT(said_of_quantity("sim_s", "1 min"), IsEmpty());
}

TEST(CriteriaCheck, looks_at_every_type_of_criterion) {
  EXPECT_THAT(said_of(StaysCriterion{"bom", true, 1}), ElementsAre(HasSubstr("bom")));
  EXPECT_THAT(said_of(NoContactCriterion{}),
              ElementsAre(HasSubstr("this machine strikes no obstacles")));
  EXPECT_THAT(said_of(DeviceCriterion{"gns", "dropped", false, 1}),
              ElementsAre(AllOf(HasSubstr("criteria.c.device: the rig has no such device"),
                                HasSubstr("did you mean gnss?"))));
  EXPECT_THAT(said_of(DeviceCriterion{"gnss", "droped", false, 1}),
              ElementsAre(AllOf(HasSubstr("criteria.c.figure: the report has no such figure"),
                                HasSubstr("did you mean dropped?"))));
  EXPECT_THAT(said_of(DeviceCriterion{"gnss", "lateness_us.p99", false, 500}), IsEmpty());
  EXPECT_THAT(said_of(DeviceCriterion{"gnss", "counts.pictures", true, 5}), IsEmpty());
  EXPECT_THAT(said_of(ArrivesCriterion{}), IsEmpty());
}

TEST(CriteriaCheck, what_a_rig_has_is_known_without_a_run) {
  const LoadedRig loaded = load_rig(RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml", {});
  const JudgedRig rig = judged_rig(loaded.configuration);
  std::vector<std::string> words;
  for (const StateQuantity& quantity : rig.quantities) {
    words.push_back(quantity.name);
    EXPECT_EQ(std::ranges::count(rig.truth, quantity.name), 0)
        << quantity.name << " is a key of the truth as well";
  }
  EXPECT_THAT(words, IsSupersetOf({"swing", "boom", "stick", "bucket", "payload", "contact"}));
  EXPECT_THAT(rig.truth, IsSupersetOf({"sim_s", "position_m.2", "joint_rad.1", "dig_depth_m",
                                       "contact.force_n.0", "contact.touching",
                                       "antennas.gnss.height_m", "state.boom"}));
  EXPECT_TRUE(rig.meets_obstacles);
  EXPECT_THAT(rig.devices, testing::Contains("gnss"));
}

TEST(UnitOfKey, is_what_the_key_ends_with) {
  EXPECT_EQ(unit_of_key("joint_rad.1"), "rad");
  EXPECT_EQ(unit_of_key("contact.force_n.2"), "N");
  EXPECT_EQ(unit_of_key("lateness_us.p99"), "us");
  EXPECT_EQ(unit_of_key("pump_flow_m3ps"), "m3/s");
  EXPECT_EQ(unit_of_key("attitude_wxyz.0"), "");
  EXPECT_EQ(unit_of_key("contact.felled"), "");
  EXPECT_EQ(unit_of_key("suspension.3"), "");
}

}  // namespace
}  // namespace rigwire::hil
