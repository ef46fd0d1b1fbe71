// Faults: each acts for its time, and the same way for the same seed.
#include "emulators/gige_camera/gige_camera_fault.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fault_period.h"
#include "gige_camera_fixture.h"

namespace rigwire::emulators {
namespace {

using gev::Status;
using std::chrono::milliseconds;
using std::chrono::seconds;

class GigeCameraFaultTest : public GigeCameraFixture {
 protected:
  void make_with(const GigeCameraFault& fault) {
    GigeCameraSettings settings = small();
    settings.faults.push_back(fault);
    make(settings);
  }
  void expose_many(int count) {
    for (int i = 0; i < count; ++i) {
      expose(static_cast<std::uint8_t>(i));
      pass(milliseconds{10});
      // A client that is there.
      if (i % 50 == 0) {
        write(boot::kStreamPacketDelay, 0);
      }
    }
  }
  [[nodiscard]] std::vector<std::uint32_t> packet_numbers() const {
    std::vector<std::uint32_t> numbers;
    for (const auto& sent : stream.sent) {
      numbers.push_back(gev::decode_stream_packet(sent.bytes)->header.packet);
    }
    return numbers;
  }
};

TEST_F(GigeCameraFaultTest, LostPacketsAreAsManyAsTheProbabilitySays) {
  make_with({between(Duration{0}, seconds{100}), LostStreamPacketsFault{0.2}});
  start_streaming();
  expose_many(400);
  const double expected = 2000 * 0.8;
  EXPECT_NEAR(static_cast<double>(stream.sent.size()), expected, 4 * std::sqrt(expected * 0.2));
  EXPECT_EQ(camera->counters().lost_datagrams + stream.sent.size(), 2000U);
}

TEST_F(GigeCameraFaultTest, ThroughResendsEveryPictureArrives) {
  make_with({between(Duration{0}, seconds{100}), LostStreamPacketsFault{0.2}});
  start_streaming();
  for (std::uint64_t number = 1; number <= 50; ++number) {
    const SimTime start = now;
    expose(static_cast<std::uint8_t>(number));
    pass(milliseconds{10});
    const auto picture = drawn(camera->command(), start, static_cast<std::uint8_t>(number));
    for (int tries = 0; tries < 20; ++tries) {
      const auto blocks = received();
      const auto found = blocks.find(number);
      if (found != blocks.end() && found->second.image && found->second.trailer &&
          found->second.payload == picture->parts[0].bytes) {
        break;
      }
      ASSERT_LT(tries, 19) << "block " << number << " never arrived";
      camera->receive(now, {kClient.address, kStreamTo},
                      gev::encode_packet_resend(next_request(), {0, false, number, 0, 4}).view());
      pass(milliseconds{1});
    }
    write(boot::kStreamPacketDelay, 0);
  }
}

TEST_F(GigeCameraFaultTest, SwappedPacketsChangePlaces) {
  make_with({between(Duration{0}, seconds{100}), SwappedStreamPacketsFault{1.0}});
  start_streaming();
  expose_many(2);
  EXPECT_THAT(packet_numbers(), testing::ElementsAre(1, 0, 3, 2, 0, 4, 2, 1, 4, 3));
}

TEST_F(GigeCameraFaultTest, DuplicatedPacketsComeTwice) {
  make_with({between(Duration{0}, seconds{100}), DuplicatedStreamPacketsFault{1.0}});
  start_streaming();
  expose_many(1);
  EXPECT_THAT(packet_numbers(), testing::ElementsAre(0, 0, 1, 1, 2, 2, 3, 3, 4, 4));
}

TEST_F(GigeCameraFaultTest, WithTheLinkDownNothingComesAndGoes) {
  make_with({between(seconds{2}, seconds{3}), LinkDownFault{}});
  start_streaming();
  expose_many(1);
  EXPECT_EQ(stream.sent.size(), 5U);
  now = kStart + seconds{2};
  const std::size_t answers = control.sent.size();
  camera->receive(now, kClient, gev::encode_discovery(1).view());
  EXPECT_EQ(control.sent.size(), answers);
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(stream.sent.size(), 5U);
  now = kStart + seconds{3};
  EXPECT_EQ(ask(gev::encode_discovery(1)).payload.size(), 248U);
  EXPECT_EQ(camera->counters().lost_datagrams, 6U);
}

TEST_F(GigeCameraFaultTest, WithoutSupplyItIsNotThereAndAfterItAsAtPowerOn) {
  GigeCameraSettings settings = small();
  settings.supply_faults = {{between(seconds{2}, seconds{3}), NoSupplyFault{}}};
  make(settings);
  start_streaming();
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(stream.sent.size(), 5U);
  const std::string name = "left eye";
  EXPECT_EQ(write_bytes(boot::kUserDefinedName,
                        std::array<std::uint8_t, 16>{'l', 'e', 'f', 't', ' ', 'e', 'y', 'e'}),
            Status::success);
  EXPECT_EQ(write_real(reg::kGain, 6.0), Status::success);

  now = kStart + seconds{2};
  camera->advance(now);
  EXPECT_FALSE(camera->controlled());
  EXPECT_FALSE(camera->acquiring());
  EXPECT_EQ(camera->sample_plan().first, kNever);
  const std::size_t answers = control.sent.size();
  camera->receive(now, kClient, gev::encode_discovery(1).view());
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(control.sent.size(), answers);
  EXPECT_EQ(stream.sent.size(), 5U);

  now = kStart + seconds{3};
  camera->advance(now);
  EXPECT_EQ(ask(gev::encode_discovery(1)).payload.size(), 248U);
  EXPECT_EQ(read_text(boot::kUserDefinedName, 16), name) << "its memory has it";
  EXPECT_EQ(read_real(reg::kGain), settings.gain_db);
  EXPECT_EQ(read(boot::kStreamPort), 0U);
  EXPECT_EQ(write(reg::kGain, 1), Status::access_denied) << "nobody has control";
  EXPECT_EQ(write(boot::kTimestampControl, gev::TimestampControl::kLatch), Status::access_denied);
  take_control();
  EXPECT_EQ(write(boot::kTimestampControl, gev::TimestampControl::kLatch), Status::success);
  EXPECT_LT(read(boot::kTimestampLow), 1'000'000'000U) << "its time began anew";
}

/// Else what comes with the number of an old request would be answered and not done.
TEST_F(GigeCameraFaultTest, WhatWasAnsweredBeforeAnOutageIsNotKnownAfterIt) {
  GigeCameraSettings settings = small();
  settings.supply_faults = {{between(seconds{2}, seconds{3}), NoSupplyFault{}}};
  make(settings);
  const gev::RegisterValue control_word{boot::kControlPrivilege, gev::Privilege::kControl};
  const auto takes = gev::encode_write_registers(7, std::span(&control_word, 1));
  EXPECT_EQ(ask(takes).status, Status::success);
  now = kStart + seconds{3};
  camera->advance(now);
  EXPECT_FALSE(camera->controlled());
  EXPECT_EQ(ask(takes).status, Status::success);
  EXPECT_TRUE(camera->controlled());
}

TEST_F(GigeCameraFaultTest, AForcedAddressDoesNotOutliveTheSupply) {
  GigeCameraSettings settings = small();
  settings.supply_faults = {{between(seconds{2}, seconds{3}), NoSupplyFault{}}};
  make(settings);
  int moves = 0;
  camera->inform_of_moves([&moves] { ++moves; });
  const std::uint32_t own = camera->address().address;
  const CameraAddress forced{own + 1, settings.address.mask, 0};
  EXPECT_EQ(ask(gev::encode_force_ip(next_request(),
                                     {settings.mac, forced.address, forced.mask, forced.gateway}))
                .status,
            Status::success);
  EXPECT_EQ(camera->address().address, forced.address);
  now = kStart + seconds{3};
  camera->advance(now);
  EXPECT_EQ(camera->address().address, own);
  EXPECT_EQ(moves, 1);
}

TEST_F(GigeCameraFaultTest, LostTriggersMakeNoExposure) {
  make_with({between(seconds{1}, seconds{2}), LostTriggerFault{1.0}});
  start_streaming();
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  EXPECT_EQ(write(reg::kTriggerSoftware, 1), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 0U);
  EXPECT_EQ(camera->counters().lost_triggers, 1U);
  pass(seconds{1});
  EXPECT_EQ(write(reg::kTriggerSoftware, 1), Status::success);
  EXPECT_EQ(camera->command().software_triggers, 1U);
}

TEST_F(GigeCameraFaultTest, LostPulsesOfTheLineMakeNoPicture) {
  make_with({between(seconds{1}, seconds{2}), LostTriggerFault{1.0}});
  start_streaming();
  expose();
  EXPECT_EQ(camera->counters().pictures, 1U) << "free-running pictures have no trigger";
  ASSERT_EQ(write(reg::kTriggerMode, 1), Status::success);
  ASSERT_EQ(write(reg::kTriggerSource, static_cast<std::uint32_t>(TriggerSource::line)),
            Status::success);
  expose();
  EXPECT_EQ(camera->counters().pictures, 1U);
  EXPECT_EQ(camera->counters().lost_triggers, 1U);
}

TEST_F(GigeCameraFaultTest, AFrozenFrameComesAgainWithNewTimes) {
  make_with({between(milliseconds{1010}, seconds{2}), FrozenFrameFault{}});
  start_streaming();
  expose_many(3);
  const auto blocks = received();
  ASSERT_EQ(blocks.size(), 3U);
  EXPECT_EQ(blocks.at(2).payload, blocks.at(1).payload);
  EXPECT_EQ(blocks.at(3).payload, blocks.at(1).payload);
  EXPECT_GT(blocks.at(2).image->timestamp, blocks.at(1).image->timestamp);
  now = kStart + seconds{2};
  write(boot::kStreamPacketDelay, 0);
  expose(9);
  pass(milliseconds{10});
  EXPECT_NE(received().at(4).payload, blocks.at(1).payload);
}

TEST_F(GigeCameraFaultTest, AStuckExposureKeepsWhatItWasUntilItIsFree) {
  make_with({between(seconds{2}, seconds{3}), ExposureStuckFault{}});
  start_streaming();
  now = kStart + seconds{2};
  EXPECT_EQ(write_real(reg::kExposureTime, 100.0), Status::success);
  EXPECT_EQ(camera->command().exposure, milliseconds{5});
  EXPECT_EQ(camera->next_event(), kStart + seconds{3});
  pass(seconds{1});
  EXPECT_EQ(camera->command().exposure, std::chrono::microseconds{100});
}

TEST_F(GigeCameraFaultTest, ASlowCameraTakesPicturesAtAShareOfItsRate) {
  make_with({between(seconds{2}, seconds{3}), SlowPicturesFault{0.25}});
  start_streaming();
  const Duration period = camera->sample_plan().period;
  now = kStart + seconds{2};
  camera->advance(now);
  EXPECT_EQ(camera->sample_plan().period, 4 * period);
  EXPECT_EQ(read_real(reg::kResultingFrameRate), 1.0 / to_seconds(period)) << "as it is set";
  write(boot::kStreamPacketDelay, 0);
  now = kStart + seconds{3};
  camera->advance(now);
  EXPECT_EQ(camera->sample_plan().period, period);
}

TEST_F(GigeCameraFaultTest, WhatAClientWouldChangeIsRefusedAndWhatItReadsIsAnswered) {
  make_with({between(seconds{2}, seconds{3}), RefusedWritesFault{}});
  start_streaming();
  now = kStart + seconds{2};
  EXPECT_EQ(write_real(reg::kGain, 6.0), Status::access_denied);
  EXPECT_EQ(write(reg::kAcquisitionStop, 1), Status::access_denied);
  EXPECT_TRUE(camera->acquiring());
  EXPECT_EQ(read_real(reg::kGain), 0.0);
  now = kStart + seconds{3};
  EXPECT_EQ(write_real(reg::kGain, 6.0), Status::success);
}

TEST_F(GigeCameraFaultTest, AHotCameraStopsAndSaysWhy) {
  make_with({between(seconds{2}, seconds{3}), OverTemperatureFault{95.0}});
  start_streaming();
  EXPECT_EQ(read_real(reg::kTemperature), 45.0);
  pass(seconds{1});
  EXPECT_FALSE(camera->acquiring());
  EXPECT_EQ(read_real(reg::kTemperature), 95.0);
  EXPECT_EQ(write(reg::kAcquisitionStart, 1), Status::access_denied);
  pass(seconds{1});
  EXPECT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
}

TEST_F(GigeCameraFaultTest, TheSameSeedLosesTheSamePackets) {
  std::vector<std::uint32_t> first;
  for (int run = 0; run < 2; ++run) {
    now = kStart + seconds{1};
    make_with({between(Duration{0}, seconds{100}), LostStreamPacketsFault{0.3}});
    start_streaming();
    expose_many(20);
    if (run == 0) {
      first = packet_numbers();
    } else {
      EXPECT_EQ(packet_numbers(), first);
    }
  }
}

}  // namespace
}  // namespace rigwire::emulators
