// Pictures on the wire: what a receiver puts together is what the sensor handed over, packets leave
// at their pace, and what is missed can be had again.
#include "emulators/gige_camera/stream_channel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gige_camera_fixture.h"
#include "protocols/gige_vision/chunk.h"

namespace rigwire::emulators {
namespace {

using gev::Status;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

class StreamChannelTest : public GigeCameraFixture {
 protected:
  void resend(std::uint64_t block, std::uint32_t first, std::uint32_t last,
              bool extended_ids = false) {
    // From the stream's socket, as clients do.
    const UdpEnd from{kClient.address, kStreamTo};
    camera->receive(
        now, from,
        gev::encode_packet_resend(next_request(), {0, extended_ids, block, first, last}).view());
  }
  [[nodiscard]] gev::StreamPacket last_packet() const {
    return *gev::decode_stream_packet(stream.sent.back().bytes);
  }
};

TEST_F(StreamChannelTest, AnImageArrivesAsItWasExposed) {
  make();
  start_streaming();
  const SimTime start = now;
  expose();
  pass(milliseconds{10});
  const auto blocks = received();
  ASSERT_EQ(blocks.size(), 1U);
  const Received& block = blocks.at(1);
  ASSERT_TRUE(block.image);
  EXPECT_EQ(block.image->timestamp, static_cast<std::uint64_t>((start - kStart).count()));
  EXPECT_EQ(block.image->width, 64U);
  EXPECT_EQ(block.image->height, 48U);
  EXPECT_EQ(block.image->format, gev::PixelFormatCode::mono8);
  EXPECT_EQ(block.payload, drawn(camera->command(), start)->parts[0].bytes);
  EXPECT_EQ(block.trailer, (gev::Trailer{false, 48, {}}));
  // 3072 bytes in packets of 1464, with leader and trailer.
  EXPECT_EQ(block.packets, 5U);
  EXPECT_FALSE(block.extended_ids);
  EXPECT_EQ(stream.sent[0].to, (UdpEnd{kClient.address, kStreamTo}));
  // All but the last are full.
  EXPECT_EQ(stream.sent[1].bytes.size(), 1472U);
  EXPECT_EQ(stream.sent[2].bytes.size(), 1472U);
  EXPECT_EQ(stream.sent[3].bytes.size(), 3072U - 2 * 1464 + 8);
}

TEST_F(StreamChannelTest, BlocksAreNumberedFromOneSinceTheStreamWasOpened) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  ASSERT_EQ(write(reg::kAcquisitionStop, 1), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(received().rbegin()->first, 2U);
  ASSERT_EQ(write(boot::kStreamPort, 0), Status::success);
  ASSERT_EQ(write(boot::kStreamPort, kStreamTo), Status::success);
  stream.sent.clear();
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(received().begin()->first, 1U);
}

TEST_F(StreamChannelTest, ExtendedIdentifiersWhenTheClientAsks) {
  make();
  take_control();
  open_stream();
  ASSERT_EQ(write(boot::kStreamConfiguration, gev::StreamConfiguration::kExtendedIds),
            Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  EXPECT_EQ(write(boot::kStreamConfiguration, 0), Status::access_denied);
  const SimTime start = now;
  expose();
  pass(milliseconds{10});
  const Received block = received().at(1);
  EXPECT_TRUE(block.extended_ids);
  EXPECT_EQ(block.payload, drawn(camera->command(), start)->parts[0].bytes);
}

TEST_F(StreamChannelTest, ChunksFollowTheImage) {
  make();
  take_control();
  open_stream();
  ASSERT_EQ(write(reg::kChunkModeActive, 1), Status::success);
  EXPECT_EQ(read(reg::kPayloadSize), 64U * 48 + 8 + 4 * 16);
  ASSERT_EQ(write_real(reg::kGain, 4.5), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  const SimTime start = now;
  expose();
  pass(milliseconds{10});
  const Received block = received().at(1);
  EXPECT_TRUE(block.image->with_chunks);
  ASSERT_EQ(block.payload.size(), 64U * 48 + 8 + 4 * 16);
  ASSERT_TRUE(block.trailer->chunks);
  EXPECT_EQ(block.trailer->chunks->payload_length, block.payload.size());
  gev::ChunkReader reader(block.payload);
  const auto value = [](const gev::Chunk& chunk) {
    return protocols::load_big<std::uint64_t>(chunk.bytes, 0);
  };
  const auto gain = reader.next();
  EXPECT_EQ(gain->id, chunk_id(CameraChunk::gain));
  EXPECT_EQ(std::bit_cast<double>(value(*gain)), 4.5);
  const auto exposure = reader.next();
  EXPECT_EQ(std::bit_cast<double>(value(*exposure)), 5000.0);
  EXPECT_EQ(value(*reader.next()), 1U);
  const auto timestamp = reader.next();
  EXPECT_EQ(timestamp->id, chunk_id(CameraChunk::timestamp));
  EXPECT_EQ(value(*timestamp), static_cast<std::uint64_t>((start - kStart).count()));
  const auto image = reader.next();
  EXPECT_EQ(image->id, kImageChunkId);
  EXPECT_TRUE(std::ranges::equal(image->bytes, drawn(camera->command(), start)->parts[0].bytes));
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.rest().empty());
}

TEST_F(StreamChannelTest, ChunksThatAreSwitchedOffAreNotThere) {
  make();
  take_control();
  open_stream();
  ASSERT_EQ(write(reg::kChunkModeActive, 1), Status::success);
  for (std::uint32_t chunk = 0; chunk < kCameraChunks.size(); ++chunk) {
    ASSERT_EQ(write(reg::kChunkEnable + 4 * chunk, 0), Status::success);
  }
  EXPECT_EQ(read(reg::kPayloadSize), 64U * 48 + 8);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  EXPECT_EQ(write(reg::kChunkModeActive, 0), Status::access_denied);
  expose();
  pass(milliseconds{10});
  EXPECT_EQ(received().at(1).payload.size(), 64U * 48 + 8);
}

class StereoStreamTest : public StreamChannelTest {
 protected:
  StereoStreamTest() {
    GigeCameraSettings settings = small();
    settings.kind = GigeCameraKind::stereo;
    make(settings);
    take_control();
    open_stream();
  }
};

TEST_F(StereoStreamTest, AMultipartBlockHoldsAllComponents) {
  ASSERT_EQ(write(boot::kStreamChannelConfiguration, gev::StreamChannel::kMultipart),
            Status::success);
  ASSERT_EQ(write(reg::kComponentEnable + 4, 1), Status::success);  // the right image
  ASSERT_EQ(write(reg::kChunkModeActive, 1), Status::success);
  const std::size_t pixels = 64 * 48;
  EXPECT_EQ(read(reg::kPayloadSize), pixels * 5 + 4 * 16);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  const SimTime start = now;
  expose();
  pass(milliseconds{20});
  const Received block = received().at(1);
  ASSERT_TRUE(block.multipart);
  EXPECT_TRUE(block.extended_ids);
  EXPECT_EQ(block.multipart->timestamp, static_cast<std::uint64_t>((start - kStart).count()));
  const auto& parts = block.multipart->parts;
  ASSERT_EQ(parts.size(), 5U);
  EXPECT_EQ(parts[0].purpose, 1);
  EXPECT_EQ(parts[1].source, 1);
  EXPECT_EQ(parts[2].type, gev::DataType::image_3d);
  EXPECT_EQ(parts[2].purpose, 8);
  EXPECT_EQ(parts[2].format, gev::PixelFormatCode::coord3d_c16);
  EXPECT_EQ(parts[3].type, gev::DataType::confidence);
  EXPECT_EQ(parts[4].type, gev::DataType::chunks);
  std::vector<std::uint8_t> all;
  const auto picture = drawn(camera->command(), start);
  for (const PicturePart& part : picture->parts) {
    all.insert(all.end(), part.bytes.begin(), part.bytes.end());
  }
  ASSERT_EQ(block.payload.size(), all.size() + 4 * 16);
  EXPECT_TRUE(std::equal(all.begin(), all.end(), block.payload.begin()));
  gev::ChunkReader reader(block.payload);
  EXPECT_EQ(reader.next()->id, chunk_id(CameraChunk::gain));
  EXPECT_EQ(block.trailer->chunks->payload_length, block.payload.size());
}

TEST_F(StereoStreamTest, OtherwiseEachComponentIsABlock) {
  EXPECT_EQ(read(reg::kPayloadSize), 64U * 48 * 2);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  const SimTime start = now;
  expose();
  pass(milliseconds{20});
  const auto blocks = received();
  const auto picture = drawn(camera->command(), start);
  ASSERT_EQ(blocks.size(), 3U);
  for (std::uint64_t number = 1; number <= 3; ++number) {
    EXPECT_EQ(blocks.at(number).payload, picture->parts[number - 1].bytes);
    EXPECT_EQ(blocks.at(number).image->timestamp, blocks.at(1).image->timestamp);
  }
  EXPECT_EQ(blocks.at(2).image->format, gev::PixelFormatCode::coord3d_c16);
}

TEST_F(StereoStreamTest, AnExposureFillsOnePlaceOfTheQueueWithAllItsBlocks) {
  GigeCameraSettings settings = small();
  settings.kind = GigeCameraKind::stereo;
  settings.queued_frames = 2;
  settings.throughput_bps = 8e6;  // 16 ms for the four of them
  make(settings);
  take_control();
  open_stream();
  ASSERT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  ASSERT_EQ(write(reg::kComponentEnable + 4, 1), Status::success);  // the right image
  ASSERT_EQ(write(reg::kChunkModeActive, 1), Status::success);
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  for (int i = 0; i < 3; ++i) {
    expose();
  }
  pass(milliseconds{100});
  expose();
  pass(milliseconds{100});
  std::map<std::uint64_t, std::vector<std::uint64_t>> of_exposure;
  for (const auto& [number, block] : received()) {
    ASSERT_TRUE(block.image && block.trailer) << number;
    of_exposure[block.image->timestamp].push_back(number);
    gev::ChunkReader reader(block.payload);
    std::uint64_t frame = 0;
    while (const auto chunk = reader.next()) {
      if (chunk->id == chunk_id(CameraChunk::frame)) {
        frame = protocols::load_big<std::uint64_t>(chunk->bytes, 0);
      }
    }
    EXPECT_EQ(frame, number);
  }
  std::vector<std::vector<std::uint64_t>> numbers;
  for (const auto& [timestamp, of] : of_exposure) {
    numbers.push_back(of);
  }
  // The third exposure is lost as a whole.
  EXPECT_EQ(numbers, (std::vector<std::vector<std::uint64_t>>{
                         {1, 2, 3, 4}, {5, 6, 7, 8}, {13, 14, 15, 16}}));
  EXPECT_EQ(camera->counters().stream.lost_blocks, 4U);
}

TEST_F(StereoStreamTest, ComponentsThatAreSwitchedOffAreNotAskedFor) {
  for (std::uint32_t component = 0; component < 4; ++component) {
    ASSERT_EQ(write(reg::kComponentEnable + 4 * component, 0), Status::success);
  }
  EXPECT_EQ(read(reg::kPayloadSize), 0U);
  EXPECT_EQ(write(reg::kAcquisitionStart, 1), Status::access_denied);
  ASSERT_EQ(write(reg::kComponentEnable + 8, 1), Status::success);
  EXPECT_FALSE(camera->command().intensity);
  EXPECT_TRUE(camera->command().disparity);
  EXPECT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  EXPECT_EQ(write(reg::kComponentEnable, 1), Status::access_denied);
  EXPECT_EQ(read(reg::kComponentId + 8), 8U);
}

TEST_F(StreamChannelTest, AnOrdinaryCameraHasNoMultipart) {
  make();
  take_control();
  EXPECT_EQ(write(boot::kStreamChannelConfiguration, gev::StreamChannel::kMultipart),
            Status::invalid_parameter);
}

TEST_F(StreamChannelTest, PacketsLeaveAtThePaceOfTheThroughputLimit) {
  make();
  start_streaming();
  const SimTime begin = now + milliseconds{5};  // when the exposure ends
  expose();
  pass(milliseconds{10});
  ASSERT_EQ(stream.sent.size(), 5U);
  EXPECT_EQ(stream.sent[0].due, begin);
  // 62.5 MB/s: 36 + 8 + 28 bytes of the leader, then packets of 1500.
  EXPECT_EQ(stream.sent[1].due - stream.sent[0].due, Duration{72 * 16});
  EXPECT_EQ(stream.sent[2].due - stream.sent[1].due, Duration{24'000});
  EXPECT_EQ(stream.sent[3].due - stream.sent[2].due, Duration{24'000});
}

TEST_F(StreamChannelTest, WithoutALimitTheLinkIsTheLimitAndThePacketDelayAdds) {
  make();
  take_control();
  ASSERT_EQ(write(reg::kThroughputMode, 0), Status::success);
  ASSERT_EQ(write(boot::kStreamPacketDelay, 100'000), Status::success);
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  expose();
  pass(milliseconds{10});
  ASSERT_EQ(stream.sent.size(), 5U);
  // 1500 bytes and 38 of Ethernet at 1 Gbit/s, and the delay.
  EXPECT_EQ(stream.sent[2].due - stream.sent[1].due, Duration{1538 * 8 + 100'000});
}

TEST_F(StreamChannelTest, WhatFindsTheQueueFullIsLostAndSeen) {
  GigeCameraSettings settings = small();
  settings.queued_frames = 2;
  settings.throughput_bps = 8e6;  // 3 ms for a picture
  make(settings);
  take_control();
  ASSERT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  for (int i = 0; i < 4; ++i) {
    expose();
  }
  pass(milliseconds{30});
  expose();
  pass(milliseconds{30});
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, block] : received()) {
    numbers.push_back(number);
    EXPECT_TRUE(block.trailer);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{1, 2, 5}));
  EXPECT_EQ(camera->counters().stream.lost_blocks, 2U);
  EXPECT_EQ(camera->counters().stream.blocks, 3U);
}

TEST_F(StreamChannelTest, APlaceThatIsFreeAfterALossIsUsedAtOnce) {
  GigeCameraSettings settings = small();
  settings.queued_frames = 2;
  settings.throughput_bps = 8e6;  // 3 ms for a picture
  make(settings);
  take_control();
  ASSERT_EQ(write_real(reg::kExposureTime, 10.0), Status::success);
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  for (int i = 0; i < 3; ++i) {
    expose();
  }
  pass(milliseconds{4});  // the first has left, the second has not
  expose();
  pass(milliseconds{30});
  std::vector<std::uint64_t> numbers;
  for (const auto& [number, block] : received()) {
    numbers.push_back(number);
  }
  EXPECT_EQ(numbers, (std::vector<std::uint64_t>{1, 2, 4}));
}

TEST_F(StreamChannelTest, PacketsAreSentAgain) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  const auto original = stream.sent;
  ASSERT_EQ(original.size(), 5U);
  resend(1, 2, 3);
  pass(milliseconds{1});
  ASSERT_EQ(stream.sent.size(), 7U);
  for (const std::size_t i : {0U, 1U}) {
    auto again = stream.sent[5 + i].bytes;
    EXPECT_EQ(again[0], 0x01);  // resent
    again[0] = 0;
    EXPECT_EQ(again, original[2 + i].bytes);
  }
  EXPECT_EQ(camera->counters().stream.resent_packets, 2U);
  EXPECT_TRUE(control.sent.size() == 4U) << "a resend request has no acknowledge";
}

TEST_F(StreamChannelTest, ARequestToTheEndIsOfThePacketsThatThereAre) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  resend(1, 0, gev::PacketResend::kToTheEnd);
  pass(milliseconds{1});
  EXPECT_EQ(stream.sent.size(), 10U);
  EXPECT_EQ(last_packet().header.format, gev::PacketFormat::trailer);
}

TEST_F(StreamChannelTest, OldBlocksAreGone) {
  GigeCameraSettings settings = small();
  settings.queued_frames = 1;
  settings.retained_frames = 2;
  make(settings);
  start_streaming();
  for (int i = 0; i < 4; ++i) {
    expose();
    pass(milliseconds{10});
  }
  const std::size_t sent = stream.sent.size();
  resend(1, 0, 0);
  pass(milliseconds{1});
  ASSERT_EQ(stream.sent.size(), sent + 1);
  EXPECT_EQ(last_packet().header.status, Status::packet_unavailable);
  EXPECT_EQ(last_packet().header.block, 1U);
  EXPECT_TRUE(last_packet().payload.empty());
  resend(2, 0, 0);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_resent);
  // A client that knows the newer statuses is told more.
  ASSERT_EQ(write(boot::kConfiguration, gev::Configuration::kExtendedStatus), Status::success);
  resend(1, 0, 0);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_removed);
  resend(9, 0, 0);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_not_yet_available);
  resend(4, 77, 78);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_unavailable);
  EXPECT_EQ(camera->counters().stream.refused_resends, 4U);
}

TEST_F(StreamChannelTest, WhatIsStillToComeIsNotRefused) {
  GigeCameraSettings settings = small();
  settings.throughput_bps = 8e6;
  make(settings);
  start_streaming();
  expose();
  pass(microseconds{200});  // the leader has left
  const std::size_t sent = stream.sent.size();
  resend(1, 3, 4);
  pass(microseconds{100});
  EXPECT_EQ(stream.sent.size(), sent);
  EXPECT_EQ(camera->counters().stream.refused_resends, 1U);
}

TEST_F(StreamChannelTest, ExtendedRequestsAreOfExtendedNumbers) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  resend(0x1'0000'0001, 0, 0, true);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_unavailable);
  EXPECT_EQ(last_packet().header.block, 0x1'0000'0001U);
  resend(1, 0, 0, true);
  pass(milliseconds{1});
  EXPECT_EQ(last_packet().header.status, Status::packet_resent);
}

TEST_F(StreamChannelTest, StrangersGetNothingAgain) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  const std::size_t sent = stream.sent.size();
  camera->receive(now, {0x7F00'0009, 1}, gev::encode_packet_resend(1, {0, false, 1, 0, 4}).view());
  pass(milliseconds{1});
  EXPECT_EQ(stream.sent.size(), sent);
}

TEST_F(StreamChannelTest, AStormOfRequestsIsBounded) {
  make();
  start_streaming();
  expose();
  pass(milliseconds{10});
  const std::size_t sent = stream.sent.size();
  for (int i = 0; i < 1000; ++i) {
    resend(1, 0, 4);
  }
  pass(seconds{1});
  EXPECT_LE(stream.sent.size() - sent, 64U * 5 + 5);
  EXPECT_GT(camera->counters().stream.refused_resends, 900U);
}

TEST_F(StreamChannelTest, TheTestPacketHasTheSizeThatIsAskedFor) {
  make();
  take_control();
  EXPECT_EQ(write(boot::kStreamPacketSize, gev::PacketSize::kFireTest | 1500),
            Status::invalid_parameter)
      << "there is nowhere to send it";
  open_stream();
  for (const std::uint32_t size : {576U, 1500U, 9000U, 16356U}) {
    stream.sent.clear();
    ASSERT_EQ(write(boot::kStreamPacketSize,
                    gev::PacketSize::kFireTest | gev::PacketSize::kDoNotFragment | size),
              Status::success);
    ASSERT_EQ(stream.sent.size(), 1U);
    EXPECT_EQ(stream.sent[0].bytes.size(), size - 28);
    EXPECT_TRUE(stream.sent[0].do_not_fragment);
    EXPECT_EQ(read(boot::kStreamPacketSize), gev::PacketSize::kDoNotFragment | size);
  }
}

TEST_F(StreamChannelTest, PacketSizesStayInTheirRange) {
  make();
  take_control();
  for (const std::uint32_t size : {0U, 572U, 16360U, 65535U}) {
    EXPECT_EQ(write(boot::kStreamPacketSize, size), Status::invalid_parameter) << size;
  }
  EXPECT_EQ(write(boot::kStreamPacketSize, 1503), Status::success);
  EXPECT_EQ(read(boot::kStreamPacketSize), 1500U);
  EXPECT_EQ(write(boot::kStreamPacketSize, gev::PacketSize::kBigEndian | 1500),
            Status::invalid_parameter);
  open_stream();
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  EXPECT_EQ(write(boot::kStreamPacketSize, 9000), Status::access_denied);
  EXPECT_EQ(write(boot::kStreamPacketSize, 1500), Status::success);
}

TEST_F(StreamChannelTest, StreamsGoToPermittedHostsAlone) {
  make();
  take_control();
  EXPECT_EQ(write(boot::kStreamDestination, 0xC0A8'0001), Status::invalid_parameter);
  EXPECT_EQ(write(boot::kStreamDestination, 0xEF00'0001), Status::invalid_parameter);
  EXPECT_EQ(write(boot::kStreamPort, 0x8000'0000 | kStreamTo), Status::invalid_parameter);
  EXPECT_EQ(read(boot::kStreamDestination), 0U);
}

TEST_F(StreamChannelTest, WithoutAStreamPicturesGoNowhere) {
  make();
  take_control();
  ASSERT_EQ(write(reg::kAcquisitionStart, 1), Status::success);
  expose();
  pass(milliseconds{10});
  EXPECT_TRUE(stream.sent.empty());
  EXPECT_EQ(camera->counters().pictures, 1U);
}

TEST_F(StreamChannelTest, AClosedStreamStopsWithinTheBlock) {
  GigeCameraSettings settings = small();
  settings.throughput_bps = 8e6;
  make(settings);
  start_streaming();
  expose();
  pass(milliseconds{1});
  const std::size_t sent = stream.sent.size();
  EXPECT_LT(sent, 5U);
  ASSERT_EQ(write(boot::kStreamPort, 0), Status::success);
  pass(milliseconds{100});
  EXPECT_EQ(stream.sent.size(), sent);
}

TEST_F(StreamChannelTest, BytesDependOnNoStepOfTime) {
  std::vector<DatagramRecorder::Sent> coarse;
  for (const Duration step : {Duration{milliseconds{50}}, Duration{microseconds{7}}}) {
    now = kStart + seconds{1};
    make();
    start_streaming();
    expose();
    for (const SimTime end = now + milliseconds{50}; now < end;) {
      pass(std::min(step, end - now));
    }
    if (coarse.empty()) {
      coarse = stream.sent;
      continue;
    }
    ASSERT_EQ(stream.sent.size(), coarse.size());
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      EXPECT_EQ(stream.sent[i].due, coarse[i].due);
      EXPECT_EQ(stream.sent[i].bytes, coarse[i].bytes);
    }
  }
}

}  // namespace
}  // namespace rigwire::emulators
