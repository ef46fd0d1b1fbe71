#include "emulators/canopen/canopen_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "encoder_rig.h"
#include "supply_cuts.h"

namespace rigwire::emulators {
namespace {

using protocols::canopen::NetworkCommand;
using protocols::canopen::NodeState;
using protocols::canopen::SdoAbort;
using testing::ElementsAre;
namespace canopen = protocols::canopen;

std::uint32_t code(SdoAbort abort) {
  return static_cast<std::uint32_t>(abort);
}

TEST(CanopenNode, BootsUpOnceAndWaitsPreOperational) {
  EncoderRig rig;
  rig.run(199ms);
  EXPECT_TRUE(rig.output.frames.empty());
  rig.run(1s);
  ASSERT_EQ(rig.output.frames.size(), 1U);
  EXPECT_EQ(rig.output.frames[0].first, kStart + 200ms + 200us);
  EXPECT_EQ(rig.output.frames[0].second.id, 0x720U);
  EXPECT_THAT(rig.output.frames[0].second.payload(), ElementsAre(0x00));
  EXPECT_EQ(rig.encoder.node().state(), NodeState::pre_operational);
}

TEST(CanopenNode, ObeysItsMasterAndNotCommandsForOthers) {
  EncoderRig rig;
  rig.boot();
  rig.command(NetworkCommand::start, 0x21);
  EXPECT_EQ(rig.encoder.node().state(), NodeState::pre_operational);
  rig.command(NetworkCommand::start, 0);
  EXPECT_EQ(rig.encoder.node().state(), NodeState::operational);
  rig.command(NetworkCommand::stop);
  EXPECT_EQ(rig.encoder.node().state(), NodeState::stopped);
  const std::size_t before = rig.output.frames.size();
  rig.receive(0x620, canopen::make_upload({0x1000, 0}));  // no SDO when stopped
  rig.run(100ms);
  EXPECT_EQ(rig.output.frames.size(), before);
  rig.command(NetworkCommand::reset_node);
  rig.run(300ms);
  EXPECT_EQ(rig.output.with_id(0x720).size(), 2U);
}

TEST(CanopenNode, StartsItselfWhenToldSo) {
  RotaryEncoderSettings settings = EncoderRig::settings();
  settings.node.starts_itself = true;
  EncoderRig rig(settings);
  rig.run(1200ms);
  EXPECT_EQ(rig.encoder.node().state(), NodeState::operational);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), 51U);  // at the start, then every 20 ms
}

TEST(CanopenNode, HeartbeatSaysTheState) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x1017, 0, 100, 2), 0U);
  rig.run(1s);
  auto beats = rig.output.with_id(0x720);
  ASSERT_EQ(beats.size(), 11U);
  EXPECT_EQ(beats[2].first - beats[1].first, 100ms);
  EXPECT_EQ(beats.back().second.data[0], 0x7F);
  rig.command(NetworkCommand::stop);
  rig.run(100ms);
  EXPECT_EQ(rig.output.with_id(0x720).back().second.data[0], 0x04);
}

TEST(CanopenNode, EventTimerInhibitAndChange) {
  EncoderRig rig;
  rig.start();
  rig.run(1s);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), 51U);
  EXPECT_EQ(rig.write(0x1800, 5, 0, 2), 0U);
  EXPECT_EQ(rig.write(0x1800, 2, 254, 1), 0U);
  const std::size_t before = rig.output.with_id(0x1A0).size();
  rig.run(100ms);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), before);  // stands still
  rig.angle_rad = 0.1;
  rig.run(100ms);
  EXPECT_EQ(rig.output.with_id(0x1A0).size(), before + 1);
  // Inhibit time: only while the PDO does not exist.
  EXPECT_EQ(rig.write(0x1800, 3, 500, 2), code(SdoAbort::not_in_this_state));
  EXPECT_EQ(rig.write(0x1800, 1, 0xC00001A0, 4), 0U);
  EXPECT_EQ(rig.write(0x1800, 3, 500, 2), 0U);  // 50 ms
  EXPECT_EQ(rig.write(0x1800, 1, 0x400001A0, 4), 0U);
  const std::size_t again = rig.output.with_id(0x1A0).size();
  for (int i = 0; i < 100; ++i) {
    rig.angle_rad += 0.01;
    rig.run(10ms);
  }
  EXPECT_NEAR(static_cast<double>(rig.output.with_id(0x1A0).size() - again), 20.0, 1.0);
}

TEST(CanopenNode, SynchronousPdoAfterEachNthSync) {
  EncoderRig rig;
  rig.start();
  EXPECT_EQ(rig.write(0x1801, 2, 3, 1), 0U);
  for (int i = 0; i < 9; ++i) {
    rig.receive(0x80, {});
  }
  EXPECT_EQ(rig.output.with_id(0x2A0).size(), 3U);
  EXPECT_EQ(rig.write(0x1801, 2, 0, 1), 0U);  // acyclic: on SYNC, if changed
  rig.receive(0x80, {});
  EXPECT_EQ(rig.output.with_id(0x2A0).size(), 3U);
  rig.angle_rad = 1.0;
  rig.run(10ms);
  rig.receive(0x80, {});
  EXPECT_EQ(rig.output.with_id(0x2A0).size(), 4U);
}

TEST(CanopenNode, MappingIsChangedTheStandardsWay) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x1A00, 0, 0, 1), code(SdoAbort::not_in_this_state));  // PDO exists
  EXPECT_EQ(rig.write(0x1800, 1, 0xC00001A0, 4), 0U);
  EXPECT_EQ(rig.write(0x1A00, 2, 0x60300110, 4), code(SdoAbort::not_in_this_state));
  EXPECT_EQ(rig.write(0x1A00, 0, 0, 1), 0U);
  EXPECT_EQ(rig.write(0x1A00, 2, 0x60000010, 4), code(SdoAbort::not_mappable));
  EXPECT_EQ(rig.write(0x1A00, 2, 0x60300120, 4), code(SdoAbort::not_mappable));  // 32 bits of 16
  EXPECT_EQ(rig.write(0x1A00, 2, 0x60300110, 4), 0U);
  EXPECT_EQ(rig.write(0x1A00, 3, 0x60040020, 4), 0U);
  EXPECT_EQ(rig.write(0x1A00, 0, 3, 1), code(SdoAbort::mapping_too_long));
  EXPECT_EQ(rig.write(0x1A00, 0, 2, 1), 0U);
  EXPECT_EQ(rig.write(0x1800, 1, 0x400001A0, 4), 0U);
  rig.command(NetworkCommand::start);
  EXPECT_EQ(rig.output.with_id(0x1A0).back().second.length, 6);
}

TEST(CanopenNode, AbortCodesAreExact) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x6004, 0, 1, 4), code(SdoAbort::write_of_read_only));
  EXPECT_EQ(rig.write(0x6005, 0, 1, 4), code(SdoAbort::no_such_object));
  EXPECT_EQ(rig.write(0x1800, 4, 1, 1), code(SdoAbort::no_such_subindex));
  EXPECT_EQ(rig.write(0x1017, 0, 1, 4), code(SdoAbort::too_long));
  EXPECT_EQ(rig.write(0x1017, 0, 1, 1), code(SdoAbort::too_short));
  EXPECT_EQ(rig.write(0x6000, 0, 6, 2), code(SdoAbort::value_too_high));
  EXPECT_EQ(rig.write(0x6001, 0, 0, 4), code(SdoAbort::value_too_low));
  EXPECT_EQ(rig.write(0x1800, 2, 250, 1), code(SdoAbort::value_range));
  EXPECT_EQ(rig.write(0x1800, 1, 0x400001A1, 4), code(SdoAbort::value_range));  // while it exists
  EXPECT_EQ(rig.write(0x1010, 1, 0x11111111, 4), code(SdoAbort::cannot_store));
  const auto error_field = rig.ask(canopen::make_upload({0x1003, 1}));
  EXPECT_EQ(protocols::load_little<std::uint32_t>(error_field.data, 4), code(SdoAbort::no_data));
  const auto segment = rig.ask(canopen::make_upload_segment_request(false));
  EXPECT_EQ(protocols::load_little<std::uint32_t>(segment.data, 4),
            code(SdoAbort::unknown_command));
  const auto block = rig.ask({0xA4, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(protocols::load_little<std::uint32_t>(block.data, 4), code(SdoAbort::unknown_command));
}

TEST(CanopenNode, StringsComeInSegments) {
  EncoderRig rig;
  rig.boot();
  const auto announced = rig.ask(canopen::make_upload({0x1008, 0}));
  EXPECT_EQ(announced.data[0], 0x41);
  std::string text;
  bool toggle = false;
  for (bool last = false; !last; toggle = !toggle) {
    const auto segment = rig.ask(canopen::make_upload_segment_request(toggle));
    EXPECT_EQ((segment.data[0] & 0x10) != 0, toggle);
    last = (segment.data[0] & 1) != 0;
    const int bytes = 7 - ((segment.data[0] >> 1) & 7);
    text.append(segment.data.begin() + 1, segment.data.begin() + 1 + bytes);
  }
  EXPECT_EQ(text, "Single-turn absolute encoder");
  EXPECT_EQ(text.size(), announced.data[4]);
}

TEST(CanopenNode, WrongToggleEndsTheTransfer) {
  EncoderRig rig;
  rig.boot();
  (void)rig.ask(canopen::make_upload({0x1008, 0}));
  const auto refused = rig.ask(canopen::make_upload_segment_request(true));
  EXPECT_EQ(protocols::load_little<std::uint32_t>(refused.data, 4),
            code(SdoAbort::toggle_not_alternated));
  EXPECT_EQ(rig.ask(canopen::make_upload_segment_request(false)).data[0], 0x80);
}

TEST(CanopenNode, SegmentedDownloadOfANumber) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.ask({0x21, 0x17, 0x10, 0, 2, 0, 0, 0}).data[0], 0x60);
  EXPECT_EQ(rig.ask({0x0B, 0xE8, 0x03, 0, 0, 0, 0, 0}).data[0], 0x20);  // 2 bytes, last
  EXPECT_EQ(rig.read(0x1017), 1000U);
}

TEST(CanopenNode, SavedParametersSurviveThePowerCycleOthersDoNot) {
  RotaryEncoderSettings settings = EncoderRig::settings();
  settings.supply.faults = rigwire::test::cuts({2s, 4s});
  EncoderRig rig(settings);
  rig.boot();
  EXPECT_EQ(rig.write(0x1017, 0, 700, 2), 0U);
  EXPECT_EQ(rig.write(0x1010, 1, 0x65766173, 4), 0U);
  EXPECT_EQ(rig.write(0x1800, 5, 50, 2), 0U);  // not saved
  rig.run(1800ms);                             // off at 2 s
  const std::size_t before = rig.output.frames.size();
  EXPECT_FALSE(rig.encoder.node().powered());
  rig.receive(0x620, canopen::make_upload({0x1000, 0}));
  EXPECT_EQ(rig.output.frames.size(), before);
  rig.run(900ms);
  EXPECT_EQ(rig.read(0x1017), 700U);
  EXPECT_EQ(rig.read(0x1800, 5), 20U);
  EXPECT_EQ(rig.write(0x1011, 1, 0x64616F6C, 4), 0U);
  EXPECT_EQ(rig.read(0x1017), 700U);  // in force after the next reset
  rig.run(2s);
  EXPECT_EQ(rig.read(0x1017), 0U);
}

TEST(CanopenNode, DamagedMemoryIsAsAtDelivery) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x1017, 0, 700, 2), 0U);
  EXPECT_EQ(rig.write(0x1010, 1, 0x65766173, 4), 0U);
  std::vector<std::uint8_t> block(rig.memory.content().begin(), rig.memory.content().end());
  block[block.size() / 2] ^= 0x10;
  ASSERT_TRUE(rig.memory.store(block));
  rig.command(NetworkCommand::reset_node);
  rig.run(300ms);
  EXPECT_EQ(rig.read(0x1017), 0U);
}

TEST(CanopenNode, AnotherNodeWithTheSameNumberIsCounted) {
  EncoderRig rig;
  rig.boot();
  rig.encoder.receive(rig.now, canopen::make_heartbeat(EncoderRig::kNode, NodeState::operational));
  EXPECT_EQ(rig.encoder.node().duplicates(), 1U);
}

TEST(CanopenHostile, EveryShapeOfFrameIsCountedOnce) {
  EncoderRig rig;
  rig.start();
  std::uint64_t fed = rig.encoder.received().accepted;
  for (std::uint32_t id = 0; id < 0x800; id += (id < 0x5F0 || id > 0x630) ? 13 : 1) {
    for (unsigned length = 0; length <= 255; length += length < 10 ? 1 : 49) {
      for (const bool extended : {false, true}) {
        for (const bool remote : {false, true}) {
          protocols::can::Frame frame;
          frame.id = id;
          frame.extended = extended;
          frame.remote = remote;
          frame.length = static_cast<std::uint8_t>(length);
          frame.data.fill(0xA5);
          rig.encoder.receive(rig.now, frame);
          ++fed;
        }
      }
    }
  }
  const ReceiveCounters counters = rig.encoder.received();
  EXPECT_EQ(counters.accepted + counters.ignored + counters.malformed, fed);
}

TEST(CanopenNode, ClearingErrorsWithAnotherNumberIsAValueOutOfRange) {
  EncoderRig rig;
  rig.boot();
  EXPECT_EQ(rig.write(0x1003, 0, 1, 1), code(SdoAbort::value_range));
  EXPECT_EQ(rig.write(0x1003, 0, 255, 1), code(SdoAbort::value_range));
  EXPECT_EQ(rig.write(0x1003, 0, 0, 1), 0U);
}

TEST(CanopenNode, AnswersAWriteBeforeThePdoThatItMakesDue) {
  EncoderRig rig;
  rig.start();
  EXPECT_EQ(rig.write(0x1801, 5, 0, 2), 0U);
  rig.angle_rad = 1.0;
  rig.run(10ms);
  rig.output.frames.clear();
  EXPECT_EQ(rig.write(0x1801, 2, 254, 1), 0U);  // ask() wants the answer first
  ASSERT_EQ(rig.output.frames.size(), 2U);
  EXPECT_EQ(rig.output.frames[1].second.id, 0x2A0U);
}

TEST(CanopenNode, ElectronicDataSheetIsReadInSegments) {
  EncoderRig rig;
  rig.boot();
  const auto announced = rig.ask(canopen::make_upload({0x1021, 0}));
  ASSERT_EQ(announced.data[0], 0x41);
  const auto size = protocols::load_little<std::uint32_t>(announced.data, 4);
  std::string text;
  for (bool toggle = false; text.size() < size; toggle = !toggle) {
    const auto segment = rig.ask(canopen::make_upload_segment_request(toggle));
    ASSERT_EQ(segment.data[0] & 0xF0, toggle ? 0x10 : 0x00);
    const std::size_t unused = (segment.data[0] >> 1U) & 7U;
    text.append(segment.data.begin() + 1, segment.data.end() - static_cast<long>(unused));
    if ((segment.data[0] & 1U) != 0) {
      break;
    }
  }
  EXPECT_EQ(text.size(), size);
  EXPECT_EQ(text, rig.encoder.node().electronic_data_sheet());
  EXPECT_EQ(rig.read(0x1022), 0U);
  EXPECT_EQ(rig.write(0x1021, 0, 0, 4), code(SdoAbort::write_of_read_only));
}

}  // namespace
}  // namespace rigwire::emulators
