// The suite j1939 on our engine controller, in its own time: right, with each of its faults, and
// with one thing wrong in what it says or takes.
#include "conform/j1939/j1939_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>

#include "emulators/engine_controller/engine_controller.h"
#include "emulators/openimu/openimu335ri.h"
#include "node_mutant.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using emulators::EngineController;
using testing::IsEmpty;
using testing::Not;
using Change = EmulatedNode::Change;
using Frame = EmulatedNode::Frame;
using Fault = std::function<void(EngineController&)>;

constexpr std::uint8_t kNoAddress = 254;

std::uint8_t source_of(const Frame& frame) {
  return static_cast<std::uint8_t>(frame.id);
}
/// The suite takes the engine's address.
bool contends(const Frame& frame) {
  return group_of(frame) == J1939Trial::kClaim && source_of(frame) == 0 &&
         frame.data == std::array<std::uint8_t, 8>{};
}
class EmulatedEngine final : public EmulatedNode {
 public:
  explicit EmulatedEngine(const Change& saying = {}, const Change& hearing = {},
                          const Fault& fault = {})
      : EmulatedNode(saying, hearing), engine_({}, *this) {
    if (fault) {
      fault(engine_);
    }
    run(kStart + std::chrono::seconds(1));
  }

 private:
  emulators::CanDevice& device() override { return engine_; }
  void feed(SimTime instant) override {
    PowerUnitSample sample;
    sample.time = instant;
    engine_.update(sample);
  }

  EngineController engine_;
};

SuiteResult judge(const J1939Claims& claims, const Change& saying = {}, const Change& hearing = {},
                  const Fault& fault = {}, const std::vector<std::string>& wanted = {}) {
  J1939Device device;
  device.open = [&] { return std::make_unique<EmulatedEngine>(saying, hearing, fault); };
  device.claims = claims;
  return run_j1939_suite(device, {wanted, true, true, true});
}

class EmulatedImu final : public EmulatedNode {
 public:
  explicit EmulatedImu(const Change& saying = {}, const Change& hearing = {})
      : EmulatedNode(saying, hearing), imu_({}, *this) {
    run(kStart + std::chrono::seconds(1));
  }

 private:
  emulators::CanDevice& device() override { return imu_; }
  void feed(SimTime instant) override {
    ImuSample sample;
    sample.time = instant;
    sample.specific_force_mps2 = {0.0, 0.0, 9.81};
    imu_.update(sample);
  }

  emulators::OpenImu imu_;
};

SuiteResult judge_imu(const std::vector<std::string>& wanted, const Change& saying = {},
                      const Change& hearing = {}) {
  J1939Device device;
  device.open = [&] { return std::make_unique<EmulatedImu>(saying, hearing); };
  device.claims.address = 128;
  return run_j1939_suite(device, {wanted, true, true, true});
}

/// What case "How it takes its address back" tells.
std::string way_back(const SuiteResult& result) {
  const auto found = std::ranges::find(result.cases, "j1939-81/lost/5",
                                       [](const CaseResult& each) { return each.identity.id; });
  return found == result.cases.end() ? "not tried" : found->got;
}

J1939Claims claims() {
  J1939Device device;
  device.open = [] { return std::make_unique<EmulatedEngine>(); };
  return survey_j1939(device);
}

TEST(J1939Suite, OurEngineControllerIsRight) {
  const J1939Claims asked = claims();
  EXPECT_EQ(asked.address, 0);
  EXPECT_THAT(asked.periodic,
              testing::Contains(PeriodicGroup{61444, std::chrono::milliseconds(20)}));
  const SuiteResult result = judge(asked);
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_GE(result.count(Verdict::pass), 50U);
}

TEST(J1939Suite, CasesHaveIdentitiesOfTheirOwn) {
  expect_identities(j1939_cases(), 80);
}

TEST(J1939Suite, OurEngineControllerIsCommandedBackToItsAddress) {
  EXPECT_EQ(way_back(judge(claims(), {}, {}, {}, {"j1939-81/lost"})), "by a commanded address");
}

TEST(J1939Suite, OurImuTakesAnotherAddressAndIsContendedBack) {
  const SuiteResult result = judge_imu({"j1939-81"});
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_EQ(way_back(result), "by contending at the address that it had instead");
}

// Our IMU does as its open firmware: it is silent where it has nothing to say.
TEST(J1939Suite, OurImuRefusesNothing) {
  EXPECT_THAT(wrong_ids(judge_imu({"j1939/5.4.4", "j1939/5.4.2", "j1939/5.2"})),
              testing::UnorderedElementsAre("j1939/5.4.4/1", "j1939/5.4.4/2"));
}

TEST(J1939Suite, AnAddressThatNoNodeMayChooseIsNoticed) {
  constexpr std::uint8_t kReserved = 20;
  const SuiteResult result = judge_imu({"j1939-81/lost/1"}, [](const Frame& frame) {
    Frame other = frame;
    const bool moved = static_cast<std::uint8_t>(frame.id) != 128;
    other.id = moved ? (frame.id & 0xFFFFFF00U) | kReserved : frame.id;
    return std::vector{other};
  });
  EXPECT_THAT(wrong_ids(result), testing::ElementsAre("j1939-81/lost/1"));
}

TEST(J1939Suite, WhatIsNotBackAtItsAddressIsSaidToBeLost) {
  // The suite's own broadcasts do not arrive: no address is commanded.
  const Change deaf = without(is_group(J1939Trial::kTransport));
  const SuiteResult result = judge(claims(), {}, deaf, {}, {"j1939-81/lost"});
  EXPECT_EQ(result.cases.front().verdict, Verdict::pass);
  for (std::size_t i = 1; i < result.cases.size(); ++i) {
    EXPECT_EQ(result.cases[i].verdict, Verdict::error);
    EXPECT_THAT(result.cases[i].got, testing::HasSubstr("has to be switched off and on"));
  }
}

TEST(J1939Suite, NoAddressIsTakenWithoutTheOptionForIt) {
  int taken = 0;
  J1939Device device;
  device.open = [&] {
    return std::make_unique<EmulatedEngine>(Change(), [&](const Frame& frame) {
      taken += contends(frame) ? 1 : 0;
      return std::vector{frame};
    });
  };
  device.claims = claims();
  const SuiteResult result = run_j1939_suite(device, {{}, true, true, false});
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(result.count(Verdict::skipped), 5U);
}

TEST(J1939Suite, AProfileIsOfTheAddressThatIsMeant) {
  J1939Device device;
  device.open = [] { return std::make_unique<EmulatedEngine>(); };
  EXPECT_EQ(survey_j1939(device, std::uint8_t{0}).address, 0);
  EXPECT_THROW(static_cast<void>(survey_j1939(device, std::uint8_t{5})), Unreachable);
}

TEST(J1939Suite, ASilentBusIsUnreachable) {
  J1939Device device;
  device.open = [] {
    return std::make_unique<EmulatedEngine>([](const Frame&) { return std::vector<Frame>(); });
  };
  EXPECT_THROW(static_cast<void>(survey_j1939(device)), Unreachable);
}

using Mutant = NodeMutant<EngineController>;

/// Says once that it has lost its address, and goes on with `source`.
Mutant goes_on(const char* name, const char* found_by, std::uint8_t source) {
  struct State {
    Frame claim;
    bool lost = false;
    bool told = false;
  };
  const auto state = std::make_shared<State>();
  const auto saying = [=](const Frame& frame) {
    if (group_of(frame) == J1939Trial::kClaim) {
      state->claim = frame;
    }
    Frame other = frame;
    other.id = (frame.id & 0xFFFFFF00U) | (state->lost ? source : source_of(frame));
    std::vector<Frame> all{other};
    if (state->lost && !state->told) {
      state->told = true;
      state->claim.id |= kNoAddress;
      all.insert(all.begin(), state->claim);
    }
    return all;
  };
  const auto hearing = [=](const Frame& frame) {
    state->lost = state->lost || contends(frame);
    return contends(frame) ? std::vector<Frame>() : std::vector{frame};
  };
  return {name, found_by, saying, hearing};
}
Mutant deaf_behind_the_loss(const char* name, const char* found_by) {
  const auto lost = std::make_shared<bool>(false);
  const auto hearing = [=](const Frame& frame) {
    *lost = *lost || contends(frame);
    return *lost && group_of(frame) == J1939Trial::kRequest ? std::vector<Frame>()
                                                            : std::vector{frame};
  };
  return {name, found_by, {}, hearing};
}

class J1939Mutant : public testing::TestWithParam<Mutant> {};

TEST_P(J1939Mutant, IsNoticed) {
  const auto& [name, found_by, saying, hearing, fault] = GetParam();
  EXPECT_THAT(wrong_in(judge(claims(), saying, hearing, fault, {found_by})), Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(, J1939Mutant,
                         testing::Values(Mutant{"no_claim", "j1939-81/4.2.1",
                                                without(is_group(J1939Trial::kClaim))},
                                         Mutant{"claim_of_priority_3", "j1939-81/4.2.1",
                                                of_group(J1939Trial::kClaim,
                                                         [](Frame& f) {
                                                           f.id = (f.id & 0x03FFFFFFU) | 3U << 26U;
                                                         })},
                                         Mutant{"short_name", "j1939-81/4.2.1",
                                                of_group(J1939Trial::kClaim,
                                                         [](Frame& f) { f.length = 7; })},
                                         Mutant{"changing_name", "j1939-81/4.1.1",
                                                of_group(J1939Trial::kClaim,
                                                         [n = std::make_shared<std::uint8_t>(0)](
                                                             Frame& f) { f.data[0] = ++*n; })},
                                         Mutant{"reserved_bit", "j1939-81/4.1.1",
                                                of_group(J1939Trial::kClaim,
                                                         [](Frame& f) { f.data[6] |= 1U; })},
                                         Mutant{"does_not_defend",
                                                "j1939-81/4.2.2",
                                                {},
                                                without(is_group(J1939Trial::kClaim))},
                                         Mutant{"does_not_refuse", "j1939/5.4.4",
                                                without(is_group(J1939Trial::kAcknowledgement))},
                                         Mutant{"refuses_positively", "j1939/5.4.4",
                                                of_group(J1939Trial::kAcknowledgement,
                                                         [](Frame& f) { f.data[0] = 0; })},
                                         Mutant{"refuses_another_group", "j1939/5.4.4",
                                                of_group(J1939Trial::kAcknowledgement,
                                                         [](Frame& f) { f.data[5] ^= 1U; })},
                                         Mutant{"refuses_somebody", "j1939/5.4.4",
                                                of_group(J1939Trial::kAcknowledgement,
                                                         [](Frame& f) { f.data[4] = 0xFF; })},
                                         Mutant{"answers_for_others",
                                                "j1939/5.4.2",
                                                {},
                                                of_group(J1939Trial::kRequest,
                                                         [](Frame& f) { f.id &= 0xFFFF00FFU; })},
                                         Mutant{"answers_remote_frames",
                                                "j1939/5.2",
                                                {},
                                                [](const Frame& frame) {
                                                  Frame other = frame;
                                                  other.remote = false;
                                                  return std::vector{other};
                                                }},
                                         Mutant{"no_packets", "j1939/5.10.2",
                                                without(is_group(J1939Trial::kPackets))},
                                         Mutant{"a_packet_lost", "j1939/5.10.2",
                                                without(is_group(J1939Trial::kPackets,
                                                                 [](const Frame& f) {
                                                                   return f.data[0] == 2;
                                                                 }))},
                                         Mutant{"packets_counted_from_zero", "j1939/5.10.3",
                                                of_group(J1939Trial::kPackets,
                                                         [](Frame& f) {
                                                           f.data[0] = static_cast<std::uint8_t>(
                                                               f.data[0] - 1);
                                                         })},
                                         Mutant{"one_packet_more_announced", "j1939/5.10.3",
                                                of_group(J1939Trial::kTransport,
                                                         [](Frame& f) {
                                                           f.data[3] = static_cast<std::uint8_t>(
                                                               f.data[3] + 1);
                                                         })},
                                         Mutant{"padded_with_zeros", "j1939/5.10.3",
                                                of_group(J1939Trial::kPackets,
                                                         [](Frame& f) {
                                                           f.data[7] =
                                                               f.data[7] == 0xFF ? 0 : f.data[7];
                                                         })},
                                         Mutant{"never_gives_up", "j1939/5.10.2.4",
                                                without(is_group(J1939Trial::kTransport,
                                                                 [](const Frame& f) {
                                                                   return f.data[0] == 255;
                                                                 }))},
                                         Mutant{"deaf_to_clear_to_send",
                                                "j1939/5.10.3",
                                                {},
                                                without(is_group(J1939Trial::kTransport,
                                                                 [](const Frame& f) {
                                                                   return f.data[0] == 17;
                                                                 }))},
                                         Mutant{"deaf_to_hold",
                                                "j1939/5.10.3",
                                                {},
                                                of_group(J1939Trial::kTransport,
                                                         [](Frame& f) {
                                                           if (f.data[0] == 17 && f.data[1] == 0) {
                                                             f.data[1] = f.data[2] = 1;
                                                           }
                                                         })},
                                         Mutant{"aborts_behind_a_repetition", "j1939/5.10.3/3",
                                                [n = std::make_shared<int>(0)](const Frame& frame) {
                                                  Frame abort = frame;
                                                  abort.id += 1U << 16U;  // Control, not a packet.
                                                  abort.data = {255, 5, 255, 255, 255, 0, 0, 0};
                                                  const bool first =
                                                      group_of(frame) == J1939Trial::kPackets &&
                                                      frame.data[0] == 1;
                                                  *n += first ? 1 : 0;
                                                  return first && *n == 2
                                                             ? std::vector{frame, abort}
                                                             : std::vector{frame};
                                                }},
                                         Mutant{
                                             "deaf_to_an_abort",
                                             "j1939/5.10.3/5",
                                             {},
                                             without(is_group(J1939Trial::kTransport,
                                                              [](const Frame& f) {
                                                                return f.data[0] == 255;
                                                              }))},
                                         Mutant{"every_second_lost", "j1939-71/EEC1",
                                                without(every_second(is_group(61444)))},
                                         Mutant{"seven_bytes", "j1939-71/EEC1",
                                                of_group(61444, [](Frame& f) { f.length = 7; })},
                                         Mutant{
                                             "speed_reserved", "j1939-71/EEC1",
                                             of_group(61444, [](Frame& f) { f.data[4] = 0xFC; })},
                                         Mutant{
                                             "temperature_reserved", "j1939-71/ET1",
                                             of_group(65262, [](Frame& f) { f.data[0] = 0xFB; })},
                                         Mutant{
                                             "last_priority", "j1939-71/EEC2",
                                             of_group(61443, [](Frame& f) { f.id |= 7U << 26U; })},
                                         Mutant{"keeps_its_address",
                                                "j1939-81/lost/1",
                                                {},
                                                without(contends)},
                                         Mutant{"does_not_say_that_it_lost", "j1939-81/lost/1",
                                                without(is_group(J1939Trial::kClaim,
                                                                 [](const Frame& f) {
                                                                   return source_of(f) ==
                                                                          kNoAddress;
                                                                 }))},
                                         goes_on("speaks_with_the_lost_address", "j1939-81/lost/2",
                                                 0),
                                         goes_on("speaks_without_an_address", "j1939-81/lost/3",
                                                 kNoAddress),
                                         deaf_behind_the_loss("deaf_without_an_address",
                                                              "j1939-81/lost/4"),
                                         Mutant{"slow",
                                                "j1939-71/EEC1",
                                                {},
                                                {},
                                                [](EngineController& engine) {
                                                  static_cast<void>(engine.pace().begin(
                                                      {{},
                                                       emulators::SlowNodeFault{.share = 0.4}}));
                                                }}),
                         [](const auto& mutant) { return std::string(mutant.param.name); });

}  // namespace
}  // namespace rigwire::conform
