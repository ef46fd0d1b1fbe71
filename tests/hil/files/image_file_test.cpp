#include "hil/files/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "small_images.h"

namespace rigwire::hil {
namespace {

Image image_of(std::size_t columns, std::size_t rows, std::size_t channels, int bits) {
  Image image;
  image.columns = columns;
  image.rows = rows;
  image.channels = channels;
  image.bits = bits;
  for (std::size_t i = 0; i < columns * rows * channels; ++i) {
    image.samples.push_back(
        static_cast<std::uint16_t>(static_cast<std::uint32_t>(i) * 2654435761U >> (32 - bits)));
  }
  return image;
}

TEST(ImageFile, WhatIsWrittenComesBack) {
  for (const int bits : {8, 16}) {
    for (const std::size_t channels : {1, 2, 3, 4}) {
      const Image written = image_of(37, 5, channels, bits);
      const Image read = decode_png(encode_png(written), "image: ");
      EXPECT_EQ(read.columns, written.columns);
      EXPECT_EQ(read.rows, written.rows);
      EXPECT_EQ(read.channels, written.channels);
      EXPECT_EQ(read.bits, written.bits);
      EXPECT_EQ(read.samples, written.samples) << channels << " channels of " << bits << " bits";
    }
  }
}

TEST(ImageFile, RefusesWhatIsNoImage) {
  EXPECT_THROW((void)encode_png({}), std::invalid_argument);
  Image image = image_of(4, 4, 3, 8);
  image.samples.pop_back();
  EXPECT_THROW((void)encode_png(image), std::invalid_argument);
  image = image_of(4, 4, 1, 8);
  image.bits = 12;
  EXPECT_THROW((void)encode_png(image), std::invalid_argument);
}

TEST(ImageFile, EveryTruncationIsRefused) {
  const std::vector<std::uint8_t> bytes = encode_png(image_of(9, 7, 3, 16));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW((void)decode_png(std::span(bytes).first(size), "image: "), std::invalid_argument)
        << size;
  }
}

// A file of 68 bytes made room for 4 GB before its first pixel was missed.
TEST(ImageFile, RefusesMorePixelsThanItsBytesCanHold) {
  tests::Bytes claim{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  tests::Bytes header;
  tests::put_be(header, 16384, 4);
  tests::put_be(header, 16384, 4);
  for (const std::uint32_t field : {16U, 6U, 0U, 0U, 0U}) {  // bits, RGB and alpha, three methods
    tests::put_be(header, field, 1);
  }
  tests::put_chunk(claim, "IHDR", header);
  tests::put_chunk(claim, "IDAT", {0x78, 0x01, 0x03, 0x00, 0, 0, 0, 1});
  tests::put_chunk(claim, "IEND", {});
  EXPECT_THAT([&] { (void)decode_png(claim, "image: "); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::HasSubstr("more pixels than its bytes can hold")));
  // The densest that there are: one shade.
  Image dense = image_of(1, 1, 1, 8);
  dense.columns = dense.rows = 4096;
  dense.samples.assign(dense.columns * dense.rows, 200);
  EXPECT_EQ(decode_png(encode_png(dense), "image: ").samples, dense.samples);
}

}  // namespace
}  // namespace rigwire::hil
