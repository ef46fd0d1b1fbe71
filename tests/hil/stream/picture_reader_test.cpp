#include "hil/stream/picture_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace rigwire::hil {
namespace {

namespace gige = protocols::gige_vision;
using namespace std::chrono_literals;
using testing::ElementsAre;
using Bytes = std::vector<std::uint8_t>;

/// A packet of block `block`; `write` fills what follows the header.
template <class Write>
Bytes packet(gige::PacketFormat format, std::uint64_t block, std::uint32_t number, Write write,
             std::uint8_t parts = 0) {
  Bytes bytes(1500);
  gige::PacketHeader header;
  header.extended_ids = true;
  header.format = format;
  header.block = block;
  header.packet = number;
  header.parts = parts;
  const std::size_t head = gige::write_header(bytes, header);
  bytes.resize(head + write(std::span(bytes).subspan(head)));
  return bytes;
}

Bytes leader(std::uint64_t block, std::uint32_t width, std::uint32_t height,
             gige::PixelFormatCode format) {
  return packet(gige::PacketFormat::leader, block, 0, [&](std::span<std::uint8_t> out) {
    gige::ImageLeader image;
    image.width = width;
    image.height = height;
    image.format = format;
    return gige::write_image_leader(out, image);
  });
}

Bytes payload(std::uint64_t block, std::uint32_t number, const Bytes& part) {
  return packet(gige::PacketFormat::payload, block, number, [&](std::span<std::uint8_t> out) {
    std::ranges::copy(part, out.begin());
    return part.size();
  });
}

Bytes trailer(std::uint64_t block, bool multipart = false) {
  return packet(gige::PacketFormat::trailer, block, 99, [&](std::span<std::uint8_t> out) {
    gige::Trailer end;
    end.multipart = multipart;
    return gige::write_trailer(out, end);
  });
}

Bytes counted(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

TEST(PictureReader, PutsPacketsTogether) {
  PictureReader reader;
  EXPECT_EQ(reader.take(kStart, leader(1, 4, 2, gige::PixelFormatCode::mono8)), nullptr);
  EXPECT_EQ(reader.take(kStart, payload(1, 1, {0, 1, 2, 3, 4, 5})), nullptr);
  EXPECT_EQ(reader.take(kStart, payload(1, 2, {6, 7})), nullptr);
  const SmallPicture* const picture = reader.take(kStart, trailer(1));
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->encoding, "mono8");
  EXPECT_EQ(picture->width, 4U);
  EXPECT_EQ(picture->height, 2U);
  EXPECT_THAT(picture->pixels, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST(PictureReader, WithoutOneOfItsPacketsItIsNone) {
  PictureReader reader;
  (void)reader.take(kStart, leader(1, 4, 2, gige::PixelFormatCode::mono8));
  (void)reader.take(kStart, payload(1, 1, {0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(reader.take(kStart, payload(1, 1, {0, 1})), nullptr) << "sent again";
  EXPECT_EQ(reader.take(kStart, trailer(1)), nullptr);
}

TEST(PictureReader, OneOfEveryFewIsEnough) {
  PictureReader reader;
  const auto whole = [&](std::uint64_t block, SimTime at) {
    (void)reader.take(at, leader(block, 2, 1, gige::PixelFormatCode::mono8));
    (void)reader.take(at, payload(block, 1, {8, 9}));
    return reader.take(at, trailer(block)) != nullptr;
  };
  EXPECT_TRUE(whole(1, kStart));
  EXPECT_FALSE(whole(2, kStart + PictureReader::kEvery - 1ns));
  EXPECT_TRUE(whole(3, kStart + PictureReader::kEvery));
}

TEST(PictureReader, OfAMosaicACellIsAPixel) {
  PictureReader reader;
  (void)reader.take(kStart, leader(1, 4, 2, gige::PixelFormatCode::bayer_rg8));
  (void)reader.take(kStart, payload(1, 1, {200, 100, 201, 101, 99, 50, 98, 51}));
  const SmallPicture* const picture = reader.take(kStart, trailer(1));
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->encoding, "rgb8");
  EXPECT_THAT(picture->pixels, ElementsAre(200, 100, 50, 201, 101, 51));
}

TEST(PictureReader, MoreThanEightBitsAreTheHighestEight) {
  PictureReader reader;
  (void)reader.take(kStart, leader(1, 2, 1, gige::PixelFormatCode::mono12));
  (void)reader.take(kStart, payload(1, 1, {0xFF, 0x0F, 0x10, 0x01}));
  const SmallPicture* const picture = reader.take(kStart, trailer(1));
  ASSERT_NE(picture, nullptr);
  EXPECT_THAT(picture->pixels, ElementsAre(0xFF, 0x11));
}

TEST(PictureReader, ALargePictureIsMadeSmaller) {
  PictureReader reader;
  (void)reader.take(kStart, leader(1, 1000, 1, gige::PixelFormatCode::mono8));
  (void)reader.take(kStart, payload(1, 1, counted(1000)));
  const SmallPicture* const picture = reader.take(kStart, trailer(1));
  ASSERT_NE(picture, nullptr);
  EXPECT_EQ(picture->sent_width, 1000U);
  EXPECT_EQ(picture->width, 250U);
  EXPECT_EQ(picture->pixels[1], 4);
}

TEST(PictureReader, OfSeveralPartsTheFirstImageIsShown) {
  PictureReader reader;
  gige::PartLeader confidence;
  confidence.type = gige::DataType::confidence;
  confidence.length = 2;
  gige::PartLeader image;
  image.length = 2;
  image.width = 2;
  image.height = 1;
  const std::vector<gige::PartLeader> parts{confidence, image};
  (void)reader.take(kStart, packet(
                                gige::PacketFormat::leader, 1, 0,
                                [&](std::span<std::uint8_t> out) {
                                  return gige::write_multipart_leader(out, false, 0, parts);
                                },
                                2));
  for (std::uint8_t part = 0; part < 2; ++part) {
    (void)reader.take(
        kStart,
        packet(gige::PacketFormat::multipart, 1, part + 1U, [&](std::span<std::uint8_t> out) {
          const std::size_t head = gige::write_multipart_header(out, part, 2U * part);
          out[head] = static_cast<std::uint8_t>(10 * part);
          out[head + 1] = static_cast<std::uint8_t>(10 * part + 1);
          return head + 2;
        }));
  }
  const SmallPicture* const picture = reader.take(kStart, trailer(1, true));
  ASSERT_NE(picture, nullptr);
  EXPECT_THAT(picture->pixels, ElementsAre(10, 11));
}

/// The picture of one block of three disparities, without an image; null: none.
const SmallPicture* disparities(PictureReader& reader, const std::array<std::uint16_t, 3>& values) {
  gige::PartLeader disparity;
  disparity.type = gige::DataType::image_3d;
  disparity.format = gige::PixelFormatCode::coord3d_c16;
  disparity.length = 6;
  disparity.width = 3;
  disparity.height = 1;
  const std::vector<gige::PartLeader> parts{disparity};
  (void)reader.take(kStart, packet(
                                gige::PacketFormat::leader, 1, 0,
                                [&](std::span<std::uint8_t> out) {
                                  return gige::write_multipart_leader(out, false, 0, parts);
                                },
                                1));
  (void)reader.take(kStart,
                    packet(gige::PacketFormat::multipart, 1, 1, [&](std::span<std::uint8_t> out) {
                      std::size_t at = gige::write_multipart_header(out, 0, 0);
                      for (const std::uint16_t value : values) {
                        out[at++] = static_cast<std::uint8_t>(value & 0xFFU);  // low byte first
                        out[at++] = static_cast<std::uint8_t>(value >> 8U);
                      }
                      return at;
                    }));
  return reader.take(kStart, trailer(1, true));
}

// A client that takes disparities and how sure they are, and no image.
TEST(PictureReader, WithoutAnImageDisparitiesAreShownWithinFixedLimits) {
  // In sixteenths of a pixel, 0 for none, from 10 px to 61 px: five greys a pixel.
  const CoordinateScale scale{{1.0 / 16.0, 0.0, 0}, "disparity", "px", 10.0, 61.0};
  for (const std::uint16_t largest : {std::uint16_t{31 * 16}, std::uint16_t{16 * 200}}) {
    PictureReader reader(scale);
    const SmallPicture* const picture = disparities(reader, {0, 11 * 16, largest});
    ASSERT_NE(picture, nullptr);
    EXPECT_EQ(picture->encoding, "mono8");
    EXPECT_THAT(picture->pixels, ElementsAre(0, 5, largest == 31 * 16 ? 105 : 255))
        << "the grey of a disparity does not depend on the others";
    EXPECT_EQ(picture->remark, "disparity: black 10 px, white 61 px");
  }
}

TEST(PictureReader, DistancesMayBeBrightWhereTheyAreSmall) {
  PictureReader reader(CoordinateScale{{0.001, 0.0, 0}, "range", "m", 10.0, 0.0});
  const SmallPicture* const picture = disparities(reader, {0, 2000, 20000});
  ASSERT_NE(picture, nullptr);
  EXPECT_THAT(picture->pixels, ElementsAre(0, 204, 0));
  EXPECT_EQ(picture->remark, "range: black 10 m, white 0 m");
}

TEST(PictureReader, WithoutLimitsCoordinatesAreLeftOut) {
  PictureReader reader;
  EXPECT_EQ(disparities(reader, {0, 1, 2}), nullptr);
}

TEST(PictureReader, WhatNobodyCanHoldOrSeeIsLeftOut) {
  PictureReader reader;
  for (const auto& [width, height, format] :
       std::vector<std::tuple<std::uint32_t, std::uint32_t, gige::PixelFormatCode>>{
           {0xFFFFFFFF, 0xFFFFFFFF, gige::PixelFormatCode::rgb8},
           {0, 0, gige::PixelFormatCode::mono8},
           {1, 1, gige::PixelFormatCode::bayer_rg8},
           {2, 1, gige::PixelFormatCode::confidence8}}) {
    (void)reader.take(kStart, leader(1, width, height, format));
    (void)reader.take(kStart, payload(1, 1, {1}));
    EXPECT_EQ(reader.take(kStart, trailer(1)), nullptr);
  }
  EXPECT_EQ(reader.take(kStart, Bytes{0, 0, 0}), nullptr);
}

}  // namespace
}  // namespace rigwire::hil
