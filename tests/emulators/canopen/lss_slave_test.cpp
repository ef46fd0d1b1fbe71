// Layer setting services as a master uses them on an encoder: selecting it, giving it a node-ID,
// finding it when it has none.
#include "emulators/canopen/lss_slave.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "encoder_rig.h"
#include "protocols/canopen/lss.h"

namespace rigwire::emulators {
namespace {

using protocols::canopen::kNoNodeId;
using protocols::canopen::LssCommand;
using protocols::canopen::LssPayload;
using protocols::canopen::NetworkCommand;
using protocols::canopen::NodeState;
using testing::ElementsAre;
namespace canopen = protocols::canopen;

constexpr std::uint32_t kVendor = 0x1234;
constexpr std::uint32_t kSerial = 0xCAFE0007;
constexpr std::uint32_t kProduct = 13;  // bits of its resolution
constexpr std::uint32_t kRevision = 0x00010000;

class LssRig : public testing::Test {
 protected:
  static RotaryEncoderSettings settings(std::uint8_t node_id) {
    RotaryEncoderSettings settings = EncoderRig::settings();
    settings.node.node_id = node_id;
    settings.node.bit_rate_bps = 250'000;
    settings.vendor = kVendor;
    settings.serial = kSerial;
    return settings;
  }
  void start(std::uint8_t node_id) {
    rig_.emplace(settings(node_id));
    rig_->boot();
  }
  /// The answer, if there was one.
  std::optional<LssPayload> ask(LssCommand command, std::uint32_t number = 0, std::uint8_t six = 0,
                                std::uint8_t seven = 0, std::uint8_t eight = 0) {
    LssPayload payload{static_cast<std::uint8_t>(command)};
    protocols::store_little<std::uint32_t>(payload, 1, number);
    payload[5] = six;
    payload[6] = seven;
    payload[7] = eight;
    const std::size_t before = rig_->output.with_id(0x7E4).size();
    rig_->receive(0x7E5, payload);
    const auto answers = rig_->output.with_id(0x7E4);
    if (answers.size() == before) {
      return std::nullopt;
    }
    EXPECT_EQ(answers.size(), before + 1);
    return answers.back().second.data;
  }
  bool select(std::uint32_t serial = kSerial) {
    EXPECT_FALSE(ask(LssCommand::select_vendor, kVendor));
    EXPECT_FALSE(ask(LssCommand{0x41}, kProduct));
    EXPECT_FALSE(ask(LssCommand{0x42}, kRevision));
    const auto answer = ask(LssCommand::select_serial, serial);
    return answer && (*answer)[0] == 0x44;
  }
  /// Error code of a configuration service.
  int configure(LssCommand command, std::uint32_t number = 0) {
    const auto answer = ask(command, number);
    return answer && (*answer)[0] == static_cast<std::uint8_t>(command) ? (*answer)[1] : -1;
  }
  void global(bool configuration) {
    EXPECT_FALSE(ask(LssCommand::switch_state_global, configuration ? 1 : 0));
  }
  void power_cycle() {
    EncoderRig next(settings(0x20));
    next.memory = rig_->memory;
    next.boot();
    booted_as_ = next.output.frames.empty() ? 0 : next.output.frames[0].second.id - 0x700;
  }

  std::optional<EncoderRig> rig_;
  std::uint32_t booted_as_ = 0;
};

TEST_F(LssRig, OnlyTheNodeWithTheWholeIdentityIsSelected) {
  start(0x20);
  EXPECT_FALSE(select(kSerial + 1));
  EXPECT_EQ(configure(LssCommand::configure_node_id, 5), -1) << "it was not meant";
  EXPECT_TRUE(select());
  EXPECT_EQ(configure(LssCommand::configure_node_id, 5), 0);
  global(false);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 6), -1);
}

TEST_F(LssRig, SerialNumberAloneSelectsNobody) {
  start(0x20);
  EXPECT_FALSE(ask(LssCommand::select_serial, kSerial));
  EXPECT_FALSE(ask(LssCommand::select_vendor, kVendor));
  EXPECT_FALSE(ask(LssCommand::select_serial, kSerial)) << "product and revision are missing";
}

TEST_F(LssRig, ConfiguredNodeIdActsAfterTheNextResetOfCommunication) {
  start(0x20);
  global(true);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 0x33), 0);
  EXPECT_EQ((*ask(LssCommand::inquire_node_id))[1], 0x20) << "in force until then";
  global(false);
  EXPECT_EQ(rig_->read(0x1018, 4), kSerial) << "still answers at 20";
  rig_->command(NetworkCommand::reset_communication);
  rig_->run(300ms);
  ASSERT_EQ(rig_->output.with_id(0x733).size(), 1U) << "boots up as 33";
  // Its SDO server, its default identifiers and its messages are those of node 33.
  rig_->command(NetworkCommand::start, 0x33);
  EXPECT_EQ(rig_->output.with_id(0x1B3).size(), 1U);
  rig_->output.frames.clear();
  rig_->receive(0x633, canopen::make_upload({0x1014, 0}));
  ASSERT_EQ(rig_->output.frames.size(), 1U);
  EXPECT_EQ(rig_->output.frames[0].second.id, 0x5B3U);
  EXPECT_EQ(protocols::load_little<std::uint32_t>(rig_->output.frames[0].second.data, 4), 0xB3U);
}

TEST_F(LssRig, NodeIdIsForgottenUnlessItIsStored) {
  start(0x20);
  global(true);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 0x33), 0);
  power_cycle();
  EXPECT_EQ(booted_as_, 0x20U);
  EXPECT_EQ(configure(LssCommand::store_configuration), 0);
  power_cycle();
  EXPECT_EQ(booted_as_, 0x33U);
}

TEST_F(LssRig, StoredNodeIdAndSavedParametersDoNotTouchEachOther) {
  start(0x20);
  global(true);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 0x33), 0);
  EXPECT_EQ(configure(LssCommand::store_configuration), 0);
  global(false);
  EXPECT_EQ(rig_->write(0x1017, 0, 100, 2), 0U);
  EXPECT_EQ(rig_->write(0x1010, 1, 0x65766173, 4), 0U);
  EncoderRig next(settings(0x20));
  next.memory = rig_->memory;
  next.run(1s);
  EXPECT_EQ(next.output.with_id(0x733).size(), 9U)
      << "boot-up at 200 ms, then a heartbeat each 100 ms";
}

TEST_F(LssRig, ImpossibleNodeIdsAndBitRatesAreRefused) {
  start(0x20);
  global(true);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 0), 1);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 128), 1);
  EXPECT_EQ(configure(LssCommand::configure_bit_timing, 3U << 8U), 0) << "250 kbit/s, the bus's";
  EXPECT_EQ(configure(LssCommand::configure_bit_timing, 2U << 8U), 1) << "500 kbit/s";
  EXPECT_EQ(configure(LssCommand::configure_bit_timing, 9U << 8U), 1) << "automatic";
  EXPECT_EQ(configure(LssCommand::configure_bit_timing, (3U << 8U) | 1U), 1) << "another table";
}

TEST_F(LssRig, SaysItsIdentityWhenItIsInquired) {
  start(0x20);
  EXPECT_FALSE(ask(LssCommand::inquire_vendor)) << "waiting";
  global(true);
  const auto number = [&](std::uint8_t command) {
    const auto answer = ask(LssCommand{command});
    return answer ? protocols::load_little<std::uint32_t>(*answer, 1) : 0U;
  };
  EXPECT_EQ(number(0x5A), kVendor);
  EXPECT_EQ(number(0x5B), kProduct);
  EXPECT_EQ(number(0x5C), kRevision);
  EXPECT_EQ(number(0x5D), kSerial);
}

TEST_F(LssRig, IsSilentWhileTheBusChangesItsRate) {
  start(0x20);
  EXPECT_EQ(rig_->write(0x1017, 0, 10, 2), 0U);
  global(true);
  const std::size_t before = rig_->output.with_id(0x720).size();
  EXPECT_FALSE(ask(LssCommand::activate_bit_timing, 100));
  rig_->run(199ms);
  EXPECT_EQ(rig_->output.with_id(0x720).size(), before);
  rig_->run(100ms);
  EXPECT_NEAR(static_cast<double>(rig_->output.with_id(0x720).size() - before), 10.0, 1.0);
}

TEST_F(LssRig, AnswersIdentificationWithinItsRanges) {
  start(0x20);
  const auto identify = [&](std::uint32_t least_serial, std::uint32_t greatest_serial) {
    EXPECT_FALSE(ask(LssCommand::identify_vendor, kVendor));
    EXPECT_FALSE(ask(LssCommand{0x47}, kProduct));
    EXPECT_FALSE(ask(LssCommand{0x48}, kRevision));
    EXPECT_FALSE(ask(LssCommand{0x49}, kRevision));
    EXPECT_FALSE(ask(LssCommand{0x4A}, least_serial));
    return ask(LssCommand{0x4B}, greatest_serial);
  };
  EXPECT_TRUE(identify(kSerial - 5, kSerial));
  EXPECT_FALSE(identify(kSerial + 1, kSerial + 5));
  EXPECT_FALSE(ask(LssCommand::identify_unconfigured)) << "it has a node-ID";
}

TEST_F(LssRig, NodeWithoutNodeIdSaysNothingUntilLssGivesItOne) {
  start(kNoNodeId);
  rig_->run(2s);
  EXPECT_TRUE(rig_->output.frames.empty());
  rig_->command(NetworkCommand::start, 0);
  EXPECT_TRUE(rig_->output.frames.empty());
  EXPECT_EQ((*ask(LssCommand::identify_unconfigured))[0], 0x50);
  global(true);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 7), 0);
  global(false);
  rig_->run(300ms);
  EXPECT_EQ(rig_->output.with_id(0x707).size(), 1U) << "boots up by itself";
  EXPECT_EQ(rig_->encoder.node().state(), NodeState::pre_operational);
}

TEST_F(LssRig, FastscanFindsTheIdentityBitByBit) {
  start(kNoNodeId);
  EXPECT_EQ((*ask(LssCommand::fastscan, 0, canopen::kFastscanReset))[0], 0x4F);
  std::array<std::uint32_t, 4> found{};
  for (std::uint8_t part = 0; part < 4; ++part) {
    for (int bit = 31; bit >= 0; --bit) {
      // Without an answer the bit is 1: the master asks for 0 first.
      if (!ask(LssCommand::fastscan, found[part], static_cast<std::uint8_t>(bit), part, part)) {
        found[part] |= 1U << static_cast<unsigned>(bit);
      }
    }
    const std::uint8_t next = part == 3 ? 0 : static_cast<std::uint8_t>(part + 1);
    EXPECT_TRUE(ask(LssCommand::fastscan, found[part], 0, part, next)) << int{part};
  }
  EXPECT_THAT(found, ElementsAre(kVendor, kProduct, kRevision, kSerial));
  EXPECT_EQ(configure(LssCommand::configure_node_id, 9), 0) << "the last match selects it";
}

TEST_F(LssRig, ConfiguredNodeDoesNotAnswerFastscan) {
  start(0x20);
  EXPECT_FALSE(ask(LssCommand::fastscan, 0, canopen::kFastscanReset));
}

TEST_F(LssRig, ShortFramesAreCountedAndChangeNothing) {
  start(0x20);
  rig_->receive(0x7E5, std::array<std::uint8_t, 2>{0x04, 0x01});
  EXPECT_EQ(rig_->encoder.node().received().malformed, 1U);
  EXPECT_EQ(configure(LssCommand::configure_node_id, 5), -1);
}

}  // namespace
}  // namespace rigwire::emulators
