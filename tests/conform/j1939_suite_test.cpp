// The suite j1939 on our engine controller, in its own time: right, with each of its faults, and
// with one thing wrong in what it says or takes.
#include "conform/j1939/j1939_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "emulated_node.h"
#include "emulators/engine_controller/engine_controller.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using emulators::EngineController;
using testing::IsEmpty;
using testing::Not;
using Change = EmulatedNode::Change;
using Frame = EmulatedNode::Frame;
using Fault = std::function<void(EngineController&)>;

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
  return run_j1939_suite(device, {wanted, true, true});
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

std::uint32_t group_of(const Frame& frame) {
  const std::uint32_t pgn = frame.id >> 8U & 0x3FFFFU;
  return (pgn >> 8U & 0xFFU) < 240U ? pgn & 0x3FF00U : pgn;
}
/// Frames of that group get changed.
Change of_group(std::uint32_t pgn, const std::function<void(Frame&)>& change) {
  return [pgn, change](const Frame& frame) {
    Frame other = frame;
    if (frame.extended && group_of(frame) == pgn) {
      change(other);
    }
    return std::vector{other};
  };
}
/// Frames of that group for which it holds are lost.
Change without(std::uint32_t pgn, const std::function<bool(const Frame&)>& lost) {
  return [pgn, lost](const Frame& frame) {
    const bool drops = frame.extended && group_of(frame) == pgn && lost(frame);
    return drops ? std::vector<Frame>() : std::vector{frame};
  };
}
bool always(const Frame&) {
  return true;
}

struct Mutant {
  const char* name;
  const char* found_by;
  Change saying = {};
  Change hearing = {};
  Fault fault = {};
};
void PrintTo(const Mutant& mutant, std::ostream* out) {
  *out << mutant.name;
}

class J1939Mutant : public testing::TestWithParam<Mutant> {};

TEST_P(J1939Mutant, IsNoticed) {
  const auto& [name, found_by, saying, hearing, fault] = GetParam();
  EXPECT_THAT(wrong_in(judge(claims(), saying, hearing, fault, {found_by})), Not(IsEmpty()));
}

INSTANTIATE_TEST_SUITE_P(, J1939Mutant,
                         testing::Values(Mutant{"no_claim", "j1939-81/4.2.1",
                                                without(J1939Trial::kClaim, always)},
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
                                                without(J1939Trial::kClaim, always)},
                                         Mutant{"does_not_refuse", "j1939/5.4.4",
                                                without(J1939Trial::kAcknowledgement, always)},
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
                                                without(J1939Trial::kPackets, always)},
                                         Mutant{"a_packet_lost", "j1939/5.10.2",
                                                without(J1939Trial::kPackets,
                                                        [](const Frame& f) {
                                                          return f.data[0] == 2;
                                                        })},
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
                                                without(J1939Trial::kTransport,
                                                        [](const Frame& f) {
                                                          return f.data[0] == 255;
                                                        })},
                                         Mutant{"deaf_to_clear_to_send",
                                                "j1939/5.10.3",
                                                {},
                                                without(J1939Trial::kTransport,
                                                        [](const Frame& f) {
                                                          return f.data[0] == 17;
                                                        })},
                                         Mutant{"deaf_to_hold",
                                                "j1939/5.10.3",
                                                {},
                                                of_group(J1939Trial::kTransport,
                                                         [](Frame& f) {
                                                           if (f.data[0] == 17 && f.data[1] == 0) {
                                                             f.data[1] = f.data[2] = 1;
                                                           }
                                                         })},
                                         Mutant{"every_second_lost", "j1939-71/EEC1",
                                                without(61444,
                                                        [odd = std::make_shared<bool>(false)](
                                                            const Frame&) {
                                                          *odd = !*odd;
                                                          return *odd;
                                                        })},
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
