// The suite canopen on our encoder, in its own time: right, with each of its faults, and with one
// thing wrong in what it says or takes.
#include "conform/canopen/canopen_suite.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "emulators/canopen/rotary_encoder.h"
#include "emulators/nonvolatile_memory.h"
#include "node_mutant.h"
#include "suite_verdicts.h"

namespace rigwire::conform {
namespace {

using testing::IsEmpty;
using testing::Not;

constexpr std::uint8_t kNode = 0x20;

class EmulatedEncoder final : public EmulatedNode {
 public:
  explicit EmulatedEncoder(const Change& saying = {}, const Change& hearing = {},
                           const std::function<void(emulators::RotaryEncoder&)>& fault = {})
      : EmulatedNode(saying, hearing), encoder_(settings(), memory_, *this) {
    if (fault) {
      fault(encoder_);
    }
    run(kStart + std::chrono::milliseconds(500));
  }

 private:
  static emulators::RotaryEncoderSettings settings() {
    emulators::RotaryEncoderSettings settings;
    settings.node.node_id = kNode;
    return settings;
  }
  emulators::CanDevice& device() override { return encoder_; }
  void feed(SimTime instant) override { encoder_.update({instant, 1.0, 0.0}); }

  emulators::VolatileMemory memory_;
  emulators::RotaryEncoder encoder_;
};

using Change = EmulatedNode::Change;

SuiteResult judge(const CanopenClaims& claims, const Change& saying = {},
                  const Change& hearing = {},
                  const std::function<void(emulators::RotaryEncoder&)>& fault = {},
                  const std::vector<std::string>& wanted = {}) {
  CanopenDevice device;
  device.open = [&] { return std::make_unique<EmulatedEncoder>(saying, hearing, fault); };
  device.claims = claims;
  return run_canopen_suite(device, {wanted, true, true});
}

CanopenClaims claims() {
  CanopenDevice device;
  device.open = [] { return std::make_unique<EmulatedEncoder>(); };
  return survey_canopen(device);
}

TEST(CanopenSuite, OurEncoderIsRight) {
  const CanopenClaims asked = claims();
  EXPECT_EQ(asked.node, kNode);
  EXPECT_TRUE(asked.has({0x6004, 0}));
  const SuiteResult result = judge(asked);
  EXPECT_THAT(wrong_in(result), IsEmpty());
  EXPECT_GE(result.count(Verdict::pass), 100U);
}

TEST(CanopenSuite, NothingIsWrittenWithoutTheOption) {
  int writes = 0;
  CanopenDevice device;
  device.open = [&] {
    return std::make_unique<EmulatedEncoder>(Change(), [&](const Frame& frame) {
      const unsigned specifier = frame.data[0] >> 5U;
      writes += frame.id == 0 || frame.id == 0x80 ||
                (frame.id == 0x600U + kNode && !frame.remote && specifier <= 1);
      return std::vector{frame};
    });
  };
  device.claims = claims();
  const SuiteResult result = run_canopen_suite(device, {});
  EXPECT_GT(result.count(Verdict::skipped), 20U);
  EXPECT_EQ(writes, 0);
}

TEST(CanopenSuite, CasesHaveIdentitiesOfTheirOwn) {
  expect_identities(canopen_cases(), 100);
}

TEST(CanopenSuite, ABusWithoutANodeIsUnreachable) {
  CanopenDevice device;
  device.open = [] {
    return std::make_unique<EmulatedEncoder>([](const Frame&) { return std::vector<Frame>(); });
  };
  EXPECT_THROW(static_cast<void>(survey_canopen(device)), Unreachable);
}

/// Changes answers of SDO.
Change answers(const std::function<void(Frame&)>& change) {
  return changing([](const Frame& frame) { return frame.id == 0x580U + kNode; }, change);
}
/// Drops or changes what has this identifier.
Change with_id(std::uint32_t id, const std::function<std::vector<Frame>(Frame)>& change) {
  return [id, change](const Frame& frame) {
    return frame.id == id ? change(frame) : std::vector{frame};
  };
}
/// An abort gets another code.
Change other_abort() {
  return answers([](Frame& frame) {
    if (frame.data[0] == 0x80) {
      frame.data[4] ^= 0x01U;
    }
  });
}
/// Writing to that object is confirmed and does not arrive.
Change swallowing(std::uint16_t index) {
  return [index](const Frame& frame) {
    Frame other = frame;
    if (frame.id == 0x600U + kNode && frame.data[0] >> 5U == 1 &&
        frame.data[1] == (index & 0xFFU) && frame.data[2] == index >> 8U) {
      other.id = 0x600U + kNode;
      other.data = {0x40, frame.data[1], frame.data[2], frame.data[3]};  // read it instead
    }
    return std::vector{other};
  };
}

using Mutant = NodeMutant<emulators::RotaryEncoder>;

class CanopenMutant : public testing::TestWithParam<Mutant> {};

TEST_P(CanopenMutant, IsNoticed) {
  const auto& [name, found_by, saying, hearing, fault] = GetParam();
  EXPECT_THAT(wrong_in(judge(claims(), saying, hearing, fault, {found_by})), Not(IsEmpty()));
}

const std::vector<Frame> kNoFrames;

INSTANTIATE_TEST_SUITE_P(
    , CanopenMutant,
    testing::
        Values(Mutant{"silent", "canopen/7.2.4.3.5", [](const Frame&) { return kNoFrames; }},
               Mutant{"short_answers", "canopen/7.2.4.3.5",
                      answers([](Frame& f) { f.length = 4; })},
               Mutant{"answers_of_another_object", "canopen/7.2.4.3.5",
                      answers([](Frame& f) { f.data[1] ^= 1U; })},
               Mutant{"no_size", "canopen/7.2.4.3.5",
                      answers([](Frame& f) { f.data[0] = f.data[0] == 0x43 ? 0x42 : f.data[0]; })},
               Mutant{"toggles_wrongly", "canopen/7.2.4.3.6", answers([](Frame& f) {
                        if (f.data[0] >> 5U == 0) {
                          f.data[0] ^= 0x10U;
                        }
                      })},
               Mutant{"announces_one_more", "canopen/7.2.4.3.6", answers([](Frame& f) {
                        if (f.data[0] == 0x41) {
                          f.data[4] = static_cast<std::uint8_t>(f.data[4] + 1);
                        }
                      })},
               Mutant{"other_abort_codes", "canopen/7.2.4.3.17", other_abort()},
               Mutant{"bytes_missing", "canopen/7.5.2",
                      answers([](Frame& f) { f.data[0] = f.data[0] == 0x43 ? 0x4B : f.data[0]; })},
               Mutant{"answers_remote_frames",
                      "canopen/7.2.4.1",
                      {},
                      [](const Frame& frame) {
                        Frame other = frame;
                        if (frame.remote) {
                          other.remote = false;
                          other.data = {0x40, 0x00, 0x10};
                        }
                        return std::vector{other};
                      }},
               Mutant{"answers_extended_frames",
                      "canopen/7.2.4.1",
                      {},
                      [](const Frame& frame) {
                        Frame other = frame;
                        other.extended = false;
                        return std::vector{other};
                      }},
               Mutant{"answers_for_others",
                      "canopen/7.2.4.1",
                      {},
                      with_id(0x601U + kNode,
                              [](Frame frame) {
                                frame.id = 0x600U + kNode;
                                return std::vector{frame};
                              })},
               Mutant{"obeys_for_others",
                      "canopen/7.2.8.3.1.1",
                      {},
                      with_id(0,
                              [](Frame frame) {
                                frame.data[1] = kNode;
                                return std::vector{frame};
                              })},
               Mutant{"obeys_nothing",
                      "canopen/7.2.8.3.1.1",
                      {},
                      with_id(0, [](Frame) { return kNoFrames; })},
               Mutant{"no_boot_up", "canopen/7.2.8.3.1.1",
                      with_id(0x700U + kNode,
                              [](Frame frame) {
                                return frame.data[0] == 0 ? kNoFrames : std::vector{frame};
                              })},
               Mutant{"heartbeats_of_two_bytes", "canopen/7.2.8.3.2.2",
                      with_id(0x700U + kNode,
                              [](Frame frame) {
                                frame.length = 2;
                                return std::vector{frame};
                              })},
               Mutant{"every_heartbeat_twice", "canopen/7.2.8.3.2.2",
                      with_id(0x700U + kNode,
                              [](Frame frame) {
                                return std::vector{frame, frame};
                              })},
               Mutant{"another_state", "canopen/7.2.8.3.1.1",
                      with_id(0x700U + kNode,
                              [](Frame frame) {
                                frame.data[0] = 0x05;
                                return std::vector{frame};
                              })},
               Mutant{"half_of_the_pdos", "canopen/7.2.2",
                      with_id(0x180U + kNode,
                              [odd = std::make_shared<bool>(false)](Frame frame) {
                                *odd = !*odd;
                                return *odd ? kNoFrames : std::vector{frame};
                              })},
               Mutant{"pdo_too_short", "canopen/7.2.2/3",
                      with_id(0x180U + kNode,
                              [](Frame frame) {
                                frame.length = 3;
                                return std::vector{frame};
                              })},
               Mutant{"pdo_of_another_place", "canopen/7.2.2/4",
                      with_id(0x180U + kNode,
                              [](Frame frame) {
                                frame.data[0] ^= 1U;
                                return std::vector{frame};
                              })},
               Mutant{"deaf_to_synchronisation",
                      "canopen/7.2.5",
                      {},
                      with_id(0x80, [](Frame) { return kNoFrames; })},
               Mutant{"pdo_before_start",
                      "canopen/7.2.8.2.1",
                      {},
                      with_id(0,
                              [](Frame frame) {
                                frame.data[0] = frame.data[0] == 0x80 ? 0x01 : frame.data[0];
                                return std::vector{frame};
                              })},
               Mutant{"heartbeat_time_not_set", "canopen/7.2.8.3.2.2", {}, swallowing(0x1017)},
               Mutant{"direction_not_set", "canopen-406/6000", {}, swallowing(0x6000)},
               Mutant{"another_profile", "canopen-406/1000", answers([](Frame& f) {
                        if (f.data[1] == 0 && f.data[2] == 0x10) {
                          f.data[4] ^= 1U;
                        }
                      })},
               Mutant{"position_out_of_range", "canopen-406/6004", answers([](Frame& f) {
                        if (f.data[1] == 0x04 && f.data[2] == 0x60) {
                          f.data[7] = 0x7F;
                        }
                      })},
               Mutant{
                   "slow",
                   "canopen/7.2.2",
                   {},
                   {},
                   [](emulators::RotaryEncoder& encoder) {
                     static_cast<void>(
                         encoder.pace().begin({{}, emulators::SlowNodeFault{.share = 0.4}}));
                   }},
               Mutant{"refuses",
                      "canopen/7.2.8.3.2.2",
                      {},
                      {},
                      [](emulators::RotaryEncoder& encoder) {
                        static_cast<void>(encoder.refusal().begin(emulators::RefusalFault{}));
                      }}),
    [](const auto& mutant) { return std::string(mutant.param.name); });

}  // namespace
}  // namespace rigwire::conform
