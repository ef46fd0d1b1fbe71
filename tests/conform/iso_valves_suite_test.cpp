// The suite iso11783-valves on our block of valves, in its own time: right, with each of its
// faults, and with one thing wrong in what it says or takes.
#include "conform/iso_valves/iso_valves_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>

#include "emulators/iso_valve/iso_valves.h"
#include "node_mutant.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using emulators::IsoValves;
using std::chrono::milliseconds;
using testing::Contains;
using testing::IsEmpty;
using Change = EmulatedNode::Change;
using Frame = EmulatedNode::Frame;
using Frames = std::vector<Frame>;
using T = J1939Trial;
using Fault = std::function<void(IsoValves&)>;

class EmulatedValves final : public EmulatedNode {
 public:
  explicit EmulatedValves(const Change& saying = {}, const Change& hearing = {},
                          const Fault& fault = {}, const emulators::IsoValveSettings& settings = {})
      : EmulatedNode(saying, hearing), valves_(settings, *this) {
    if (fault) {
      fault(valves_);
    }
    run(kStart + std::chrono::seconds(1));
  }

 private:
  emulators::CanDevice& device() override { return valves_; }
  /// Spools that follow at once.
  void feed(SimTime instant) override {
    ValveSample sample;
    sample.time = instant;
    sample.spool_position = valves_.command().opening;
    valves_.update(sample);
  }

  IsoValves valves_;
};

IsoValveClaims claims() {
  IsoValveDevice device;
  device.open = [] { return std::make_unique<EmulatedValves>(); };
  IsoValveClaims claims = survey_iso_valves(device);
  claims.command_timeout = milliseconds(300);
  return claims;
}

constexpr bool kWithWrites = true;
constexpr bool kRobustness = true;
constexpr bool kMoves = true;

SuiteResult judge(const Change& saying = {}, const Change& hearing = {}, const Fault& fault = {},
                  const std::vector<std::string>& wanted = {}) {
  IsoValveDevice device;
  device.open = [&] { return std::make_unique<EmulatedValves>(saying, hearing, fault); };
  device.claims = claims();
  return run_iso_valve_suite(device, {wanted, kWithWrites, kRobustness, kMoves});
}

TEST(IsoValveSuite, OurValvesAreRight) {
  const SuiteResult result = judge();
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_EQ(result.count(Verdict::pass), result.cases.size());
}

TEST(IsoValveSuite, CasesHaveIdentitiesOfTheirOwn) {
  expect_identities(iso_valve_cases(), 37);
}

TEST(IsoValveSuite, AProfileIsWhatTheBlockSays) {
  emulators::IsoValveSettings settings;
  settings.source_address = 0x85;
  settings.function = 30;
  settings.first_valve = 12;
  IsoValveDevice device;
  device.open = [&] {
    return std::make_unique<EmulatedValves>(Change(), Change(), Fault(), settings);
  };
  const IsoValveClaims found = survey_iso_valves(device);
  EXPECT_EQ(found.address, 0x85);
  EXPECT_EQ(found.function, 30);
  EXPECT_EQ(found.first_valve, 12U);
  EXPECT_EQ(found.valves, 4U);
  EXPECT_TRUE(found.measured_flow);
  EXPECT_EQ(found.command_timeout, milliseconds(0));
}

TEST(IsoValveSuite, ASilentBusIsUnreachable) {
  IsoValveDevice device;
  device.open = [] {
    return std::make_unique<EmulatedValves>([](const Frame&) { return Frames(); });
  };
  EXPECT_THROW(static_cast<void>(survey_iso_valves(device)), Unreachable);
}

TEST(IsoValveSuite, ATimeOutThatIsLongerThanClaimedIsNoticed) {
  emulators::IsoValveSettings settings;
  settings.command_timeout = std::chrono::seconds(2);
  IsoValveDevice device;
  device.open = [&] {
    return std::make_unique<EmulatedValves>(Change(), Change(), Fault(), settings);
  };
  device.claims = claims();
  const SuiteResult result =
      run_iso_valve_suite(device, {{"iso11783-valves/AVC"}, kWithWrites, kRobustness, kMoves});
  EXPECT_THAT(wrong_ids(result),
              testing::UnorderedElementsAre("iso11783-valves/AVC/12", "iso11783-valves/AVC/13",
                                            "iso11783-valves/AVC/15"));
}

constexpr std::uint32_t kEstimate = 65'040;
constexpr std::uint32_t kMeasurement = 65'056;
constexpr std::uint32_t kCommand = 65'072;
constexpr std::uint32_t kFunctionalities = 64'654;
constexpr std::uint32_t kTroubles = 65'226;

bool is_of_valves(std::uint32_t valve_0, const Frame& frame) {
  const std::uint32_t group = group_of(frame);
  return group >= valve_0 && group < valve_0 + 16;
}

/// The suite on our valves without what is asked for by an option: commands that reach them.
struct Commanded {
  int at_all = 0;
  int to_move = 0;
  SuiteResult result;
};
Commanded commanded(bool writes, bool moves) {
  Commanded found;
  IsoValveDevice device;
  device.open = [&] {
    return std::make_unique<EmulatedValves>(Change(), [&](const Frame& frame) {
      if (is_of_valves(kCommand, frame)) {
        ++found.at_all;
        found.to_move += frame.data[0] != 0 || (frame.data[2] & 0x0FU) != 0 ? 1 : 0;
      }
      return Frames{frame};
    });
  };
  device.claims = claims();
  found.result = run_iso_valve_suite(device, {{}, writes, kRobustness, moves});
  return found;
}

TEST(IsoValveSuite, NothingIsCommandedWithoutAnOption) {
  const Commanded found = commanded(false, false);
  EXPECT_EQ(found.at_all, 0);
  EXPECT_EQ(found.result.count(Verdict::skipped), 16U);
}

TEST(IsoValveSuite, NothingMovesWithoutTheOptionForIt) {
  const Commanded found = commanded(true, false);
  EXPECT_GT(found.at_all, 0);
  EXPECT_EQ(found.to_move, 0);
  EXPECT_EQ(found.result.count(Verdict::skipped), 14U);
  EXPECT_GT(commanded(true, true).to_move, 0);
}

/// Frames of valves' groups, from that of valve 0 on, get changed.
Change of_valves(std::uint32_t valve_0, const std::function<void(Frame&)>& change) {
  return changing([=](const Frame& frame) { return is_of_valves(valve_0, frame); }, change);
}
Change estimates(const std::function<void(Frame&)>& change) {
  return of_valves(kEstimate, change);
}
Change measurements(const std::function<void(Frame&)>& change) {
  return of_valves(kMeasurement, change);
}
Change commands(const std::function<void(Frame&)>& change) {
  return of_valves(kCommand, change);
}
std::function<void(Frame&)> writing(std::size_t at, std::uint8_t value) {
  return [=](Frame& frame) { frame.data.at(at) = value; };
}
/// Commands of one state reach the valve as those of another.
Change taking(unsigned state, unsigned as) {
  return commands([=](Frame& frame) {
    if ((frame.data[2] & 0x0FU) == state) {
      frame.data[2] = static_cast<std::uint8_t>((frame.data[2] & 0xF0U) | as);
    }
  });
}
/// Commands with one flow reach the valve with another.
Change flowing(std::uint8_t flow, std::uint8_t as) {
  return commands(
      [=](Frame& frame) { frame.data[0] = frame.data[0] == flow ? as : frame.data[0]; });
}
/// Commands of neutral with a flow reach it as those without.
void forgiving(Frame& frame) {
  frame.data[0] = (frame.data[2] & 0x0FU) == 0 ? 0 : frame.data[0];
}
/// Commands of one valve reach another one, too.
Frames doubled(const Frame& frame) {
  Frame other = frame;
  other.id += 1U << 8U;
  return is_of_valves(kCommand, frame) ? Frames{frame, other} : Frames{frame};
}
/// What it says of its state; all else as it is.
Change saying_state(unsigned state) {
  return estimates([=](Frame& frame) {
    frame.data[2] = static_cast<std::uint8_t>((frame.data[2] & 0xF0U) | state);
  });
}
/// Before any command with a flow, one of neutral.
Frames neutral_before(const Frame& frame) {
  Frame other = frame;
  other.data[0] = 0;
  other.data[2] &= 0xF0U;
  return is_of_valves(kCommand, frame) ? Frames{other, frame} : Frames{frame};
}

using Mutant = NodeMutant<IsoValves>;

class IsoValveMutant : public testing::TestWithParam<Mutant> {};

TEST_P(IsoValveMutant, IsNoticed) {
  const auto& [name, found_by, saying, hearing, fault] = GetParam();
  EXPECT_THAT(wrong_ids(judge(saying, hearing, fault, {found_by})), Contains(found_by));
}

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): a literal that stands within literals.
#define SUITE "iso11783-valves/"

INSTANTIATE_TEST_SUITE_P(
    , IsoValveMutant,
    testing::Values(
        Mutant{"estimates_seldom", SUITE "AVEF/1", without(every_second(is_group(kEstimate)))},
        Mutant{"estimates_short", SUITE "AVEF/2", estimates([](Frame& f) { f.length = 5; })},
        Mutant{"estimates_of_priority_7", SUITE "AVEF/3",
               estimates([](Frame& f) { f.id |= 7U << 26U; })},
        Mutant{"state_9", SUITE "AVEF/4", saying_state(9)},
        Mutant{"fail_safe_error", SUITE "AVEF/5", estimates(writing(2, 0xB0))},
        Mutant{"flow_reserved", SUITE "AVEF/6", estimates(writing(0, 0xFC))},
        Mutant{"both_ports", SUITE "AVEF/7",
               estimates([](Frame& f) { f.data[0] = f.data[1] = 20; })},
        Mutant{"flow_in_neutral", SUITE "AVEF/8", estimates(writing(0, 20))},
        Mutant{"limit_4", SUITE "AVEF/9", estimates(writing(3, 0x9F))},
        Mutant{"zeros_unused", SUITE "AVEF/10", estimates(writing(7, 0))},
        Mutant{"measurements_seldom", SUITE "AVMF/1", without(every_second(is_group(kMeasurement)))},
        Mutant{"measurements_short", SUITE "AVMF/2", measurements([](Frame& f) { f.length = 7; })},
        Mutant{"measured_flow_reserved", SUITE "AVMF/3", measurements(writing(1, 0xFC))},
        Mutant{"measured_limit_5", SUITE "AVMF/4", measurements(writing(7, 0xBF))},
        Mutant{"limits_differ", SUITE "AVMF/5", measurements(writing(7, 0xDF))},
        Mutant{"no_estimate_beside", SUITE "AVMF/5", without(is_group(kEstimate))},
        Mutant{"measurements_of_priority_7", SUITE "AVMF/6",
               measurements([](Frame& f) { f.id |= 7U << 26U; })},
        Mutant{"industry_of_ships", SUITE "NAME/1", of_group(T::kClaim, writing(7, 0xC0))},
        Mutant{"one_address_alone", SUITE "NAME/2",
               of_group(T::kClaim, [](Frame& f) { f.data[7] &= 0x7FU; })},
        Mutant{"function_of_another", SUITE "NAME/3", of_group(T::kClaim, writing(5, 1))},
        Mutant{"no_claim", SUITE "NAME/3", without(is_group(T::kClaim))},
        Mutant{"no_functionality", SUITE "FUNC/1", of_group(kFunctionalities, writing(1, 0))},
        Mutant{"another_functionality_first", SUITE "FUNC/1",
               of_group(kFunctionalities, writing(2, 13))},
        Mutant{"functionalities_silent", SUITE "FUNC/1", without(is_group(kFunctionalities))},
        Mutant{"no_troubles", SUITE "DM1/1", without(is_group(kTroubles))},
        Mutant{"says_float_in_neutral", SUITE "AVC/1", saying_state(3)},
        Mutant{"exit_reason_in_neutral", SUITE "AVC/2", estimates(writing(4, 0xC5))},
        Mutant{"deaf", SUITE "AVC/3", {}, taking(1, 0)},
        Mutant{"half_of_the_flow", SUITE "AVC/3", {}, flowing(50, 25)},
        Mutant{"flow_of_the_other_port", SUITE "AVC/4",
               estimates([](Frame& f) { std::swap(f.data[0], f.data[1]); })},
        Mutant{"retract_taken_as_extend", SUITE "AVC/4", {}, taking(2, 1)},
        Mutant{"float_taken_as_neutral", SUITE "AVC/5", {}, taking(3, 0)},
        Mutant{"moves_the_next", SUITE "AVC/6", {}, doubled},
        Mutant{"no_flow_taken_as_some", SUITE "AVC/7", {}, flowing(0xFF, 50)},
        Mutant{"reserved_flow_taken_as_all", SUITE "AVC/8", {}, flowing(0xFC, 250)},
        Mutant{"state_9_taken_as_extend", SUITE "AVC/9", {}, taking(9, 1)},
        Mutant{"contradiction_not_told", SUITE "AVC/10", {}, commands(forgiving)},
        Mutant{"short_commands_taken", SUITE "AVC/11", {},
               commands([](Frame& f) { f.length = 8; })},
        Mutant{"time_out_not_told", SUITE "AVC/13", estimates(writing(4, 0xC0))},
        Mutant{"gives_up_meanwhile", SUITE "AVC/14", {},
               [n = std::make_shared<int>(0)](const Frame& frame) {
                 *n += is_of_valves(kCommand, frame) ? 1 : 0;
                 return is_of_valves(kCommand, frame) && *n > 10 ? Frames() : Frames{frame};
               }},
        Mutant{"moves_behind_a_time_out", SUITE "AVC/15", {}, neutral_before},
        Mutant{"anybody_commands", SUITE "AVC/16", {},
               commands([](Frame& f) { f.id = (f.id & ~0xFFU) | T::kOwnAddress; })},
        Mutant{"refuses", SUITE "AVC/3", {}, {},
               [](IsoValves& valves) {
                 static_cast<void>(
                     valves.refusal().begin(emulators::RefusalFault{}));
               }},
        Mutant{"slow", SUITE "AVEF/1", {}, {},
               [](IsoValves& valves) {
                 static_cast<void>(
                     valves.pace().begin({{}, emulators::SlowNodeFault{.share = 0.4}}));
               }}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

}  // namespace
}  // namespace rigwire::conform
