// Packets of a stream, worked by hand after the tables that Aravis and Wireshark read by.
#include "protocols/gige_vision/gvsp.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

#include "protocols/gige_vision/chunk.h"

namespace rigwire::protocols::gige_vision {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes header_bytes(const PacketHeader& header) {
  Bytes out(kExtendedHeaderSize);
  out.resize(write_header(out, header));
  return out;
}

ImageLeader some_image() {
  ImageLeader leader;
  leader.timestamp = 0x0102'0304'0506'0708;
  leader.format = PixelFormatCode::bayer_rg8;
  leader.width = 640;
  leader.height = 480;
  leader.offset_x = 16;
  leader.offset_y = 8;
  return leader;
}

TEST(Gvsp, ShortHeader) {
  PacketHeader header;
  header.format = PacketFormat::payload;
  header.block = 0x1234;
  header.packet = 0x00AB'CDEF;
  EXPECT_EQ(header_bytes(header), (Bytes{0, 0, 0x12, 0x34, 3, 0xAB, 0xCD, 0xEF}));
  const auto again = decode_stream_packet(header_bytes(header));
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->header, header);
  EXPECT_TRUE(again->payload.empty());
}

TEST(Gvsp, ExtendedHeader) {
  PacketHeader header;
  header.status = Status::packet_resent;
  header.flags = PacketFlag::kResent;
  header.extended_ids = true;
  header.format = PacketFormat::leader;
  header.parts = 3;
  header.block = 0x1'0000'0002;
  header.packet = 0;
  EXPECT_EQ(header_bytes(header),
            (Bytes{1, 0, 0, 1, 0x81, 0, 0, 3, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(decode_stream_packet(header_bytes(header))->header, header);
}

TEST(Gvsp, BlocksAreCountedPastZero) {
  EXPECT_EQ(short_block(1), 1);
  EXPECT_EQ(short_block(65535), 65535);
  EXPECT_EQ(short_block(65536), 1);
  EXPECT_EQ(short_block(2 * 65535 + 7), 7);
}

TEST(Gvsp, RoomIsWhatTheHeadersLeave) {
  EXPECT_EQ(payload_room(1500, false, false), 1500U - 28 - 8);
  EXPECT_EQ(payload_room(1500, true, false), 1500U - 28 - 20);
  EXPECT_EQ(payload_room(1500, true, true), 1500U - 28 - 20 - 8);
}

TEST(Gvsp, ImageLeader) {
  Bytes out(kImageLeaderSize);
  ASSERT_EQ(write_image_leader(out, some_image()), 36U);
  EXPECT_EQ(out, (Bytes{0, 0,    0, 1,                       // flags, image
                        1, 2,    3, 4,    5, 6, 7,    8,     // timestamp
                        1, 0x08, 0, 9,    0, 0, 0x02, 0x80,  // BayerRG8, 640
                        0, 0,    1, 0xE0,                    // 480
                        0, 0,    0, 16,                      // offsets
                        0, 0,    0, 8,    0, 0, 0,    0}));  // no padding
  EXPECT_EQ(*decode_image_leader(out), some_image());
  EXPECT_EQ(*decode_payload_type(out), PayloadType::kImage);

  ImageLeader chunked = some_image();
  chunked.with_chunks = true;
  write_image_leader(out, chunked);
  EXPECT_EQ(out[2], 0x40);
  EXPECT_EQ(*decode_image_leader(out), chunked);
}

TEST(Gvsp, MultipartLeaderHas48BytesForEachPart) {
  PartLeader left;
  left.length = 0x0001'0203'0405;
  left.purpose = 1;
  left.source = 1;
  left.width = 640;
  left.height = 480;
  PartLeader disparity = left;
  disparity.type = DataType::image_3d;
  disparity.format = PixelFormatCode::coord3d_c16;
  disparity.purpose = 8;
  disparity.offset_x = 4;
  const std::array parts{left, disparity};
  Bytes out(kMultipartLeaderSize + 2 * kPartSize);
  ASSERT_EQ(write_multipart_leader(out, false, 5, parts), 12U + 96U);
  EXPECT_EQ(Bytes(out.begin(), out.begin() + 12), (Bytes{0, 0, 0, 0x0A, 0, 0, 0, 0, 0, 0, 0, 5}));
  const Bytes first(out.begin() + 12, out.begin() + 12 + 48);
  EXPECT_EQ(first, (Bytes{0, 1, 0, 1,    2, 3, 4, 5,     // image, length
                          1, 8, 0, 1,                    // Mono8
                          0, 0, 1, 0,    0, 0, 0, 0,     // source 1, zones
                          0, 1, 0, 0,                    // purpose, region
                          0, 0, 2, 0x80, 0, 0, 1, 0xE0,  // 640 by 480
                          0, 0, 0, 0,    0, 0, 0, 0,     // offsets
                          0, 0, 0, 0,    0, 0, 0, 0}));  // padding, reserved
  const auto leader = decode_multipart_leader(out, 2);
  ASSERT_TRUE(leader.ok());
  EXPECT_EQ(leader->timestamp, 5U);
  EXPECT_EQ(leader->parts, (std::vector<PartLeader>{left, disparity}));
  for (std::size_t size = 0; size < out.size(); ++size) {
    EXPECT_TRUE(decode_multipart_leader(std::span(out).first(size), 2).incomplete());
  }
}

TEST(Gvsp, MultipartPayloadSaysPartAndOffset) {
  Bytes out(kMultipartHeaderSize + 2);
  ASSERT_EQ(write_multipart_header(out, 2, 0x0001'0000'0003), 8U);
  out[8] = 7;
  EXPECT_EQ(out, (Bytes{2, 0, 0, 1, 0, 0, 0, 3, 7, 0}));
  const auto payload = decode_multipart_payload(out);
  ASSERT_TRUE(payload.ok());
  EXPECT_EQ(payload->part, 2);
  EXPECT_EQ(payload->offset, 0x0001'0000'0003U);
  EXPECT_EQ(payload->bytes.size(), 2U);
}

struct TrailerCase {
  const char* name;
  Trailer trailer;
  Bytes bytes;
};
void PrintTo(const TrailerCase& c, std::ostream* out) {
  *out << c.name;
}

class GvspTrailer : public testing::TestWithParam<TrailerCase> {};

TEST_P(GvspTrailer, IsWrittenAndRead) {
  Bytes out(32);
  out.resize(write_trailer(out, GetParam().trailer));
  EXPECT_EQ(out, GetParam().bytes);
  EXPECT_EQ(*decode_trailer(out), GetParam().trailer);
  for (std::size_t size = 0; size < out.size(); ++size) {
    EXPECT_TRUE(decode_trailer(std::span(out).first(size)).incomplete()) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Gvsp, GvspTrailer,
    testing::Values(TrailerCase{"Image", {false, 480, {}}, {0, 0, 0, 1, 0, 0, 1, 0xE0}},
                    TrailerCase{"ImageWithChunks",
                                {false, 480, ChunkTrailer{0x0102, 3}},
                                {0, 0, 0x40, 1, 0, 0, 1, 0xE0, 0, 0, 1, 2, 0, 0, 0, 3}},
                    TrailerCase{"Multipart", {true, 0, {}}, {0, 0, 0, 0x0A}},
                    TrailerCase{"MultipartWithChunks",
                                {true, 0, ChunkTrailer{0x0102, 3}},
                                {0, 0, 0x40, 0x0A, 0, 0, 1, 2, 0, 0, 0, 3}}),
    [](const auto& parameter) { return std::string(parameter.param.name); });

TEST(Gvsp, WhatIsNoPacketIsRefused) {
  EXPECT_TRUE(decode_stream_packet(Bytes{0, 0, 0, 1, 9, 0, 0, 0}).malformed());
  EXPECT_TRUE(decode_stream_packet(Bytes{0, 0, 0, 0, 3, 0, 0, 0}).malformed());
  EXPECT_TRUE(decode_stream_packet(Bytes{0, 0, 0, 1, 3, 0, 0}).incomplete());
  EXPECT_TRUE(decode_stream_packet(Bytes{0, 0, 0, 1, 0x83, 0, 0, 0}).incomplete());
}

TEST(Gvsp, LeadersOfAnotherKindAreRefused) {
  Bytes image(kImageLeaderSize);
  write_image_leader(image, some_image());
  EXPECT_TRUE(decode_multipart_leader(image, 0).malformed());
  image[3] = 7;
  EXPECT_TRUE(decode_image_leader(image).malformed());
  EXPECT_TRUE(decode_trailer(image).malformed());
  EXPECT_TRUE(decode_image_leader(std::span(image).first(35)).incomplete());
}

TEST(PixelFormats, NumbersSayHowManyBits) {
  EXPECT_EQ(bits_per_pixel(PixelFormatCode::mono12), 16U);
  EXPECT_EQ(bits_per_pixel(PixelFormatCode::rgb8), 24U);
  EXPECT_EQ(bits_per_pixel(PixelFormatCode::confidence8), 8U);
  EXPECT_EQ(pixel_format_name(PixelFormatCode::coord3d_c16), "Coord3D_C16");
  EXPECT_EQ(find_pixel_format("BayerRG12"), PixelFormatCode::bayer_rg12);
  EXPECT_FALSE(find_pixel_format("bayerrg12"));
  EXPECT_EQ(pixel_format_name(static_cast<PixelFormatCode>(7)), "");
}

TEST(Chunks, AreReadFromTheEnd) {
  Bytes payload{1, 2, 3, 4};
  payload.resize(4 + 8 + 8 + 8);
  write_chunk_tag(std::span(payload).subspan(4), {0x10, 4});
  payload[12] = 9;
  write_chunk_tag(std::span(payload).subspan(20), {0x11, 8});
  EXPECT_EQ(Bytes(payload.begin() + 4, payload.begin() + 12), (Bytes{0, 0, 0, 0x10, 0, 0, 0, 4}));
  ChunkReader reader(payload);
  const auto last = reader.next();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->id, 0x11U);
  EXPECT_EQ(last->bytes.size(), 8U);
  EXPECT_EQ(last->bytes[0], 9);
  const auto image = reader.next();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->id, 0x10U);
  EXPECT_EQ(image->bytes[3], 4);
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.rest().empty());
}

TEST(Chunks, ATagThatClaimsTooMuchEndsTheReading) {
  Bytes payload(12);
  write_chunk_tag(std::span(payload).subspan(4), {0x10, 5});
  ChunkReader reader(payload);
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.rest().size(), 12U);
}

}  // namespace
}  // namespace rigwire::protocols::gige_vision
