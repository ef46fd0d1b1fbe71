#include "hil/files/image_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <stdexcept>

#include "hil/configuration/outside_file.h"

namespace rigwire::hil {
namespace {

constexpr std::size_t kMostPixelsAcross = 16384;

/// Maximum bytes that one byte of deflate expands to: 258 by two bits (RFC 1951, 3.2.5 and 3.2.7).
constexpr std::size_t kMostExpansion = 258 * 4;

/// What libpng's callbacks share with decode(): nothing in it needs a destructor, for libpng leaves
/// by longjmp.
struct Reading {
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;
  char error[160] = {};
};

void take(png_structp png, png_bytep out, std::size_t count) {
  auto& reading = *static_cast<Reading*>(png_get_io_ptr(png));
  if (reading.bytes.size() - reading.at < count) {
    png_error(png, "the file ends early");
  }
  std::memcpy(out, reading.bytes.data() + reading.at, count);
  reading.at += count;
}

[[noreturn]] void fail(png_structp png, png_const_charp text) {
  auto& reading = *static_cast<Reading*>(png_get_error_ptr(png));
  std::strncpy(reading.error, text, sizeof reading.error - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp /*png*/, png_const_charp /*text*/) {}

/// Header and rows; false with reading.error set. `rows` and `image` belong to the caller.
bool decode(png_structp png, png_infop info, Image& image, std::vector<std::uint8_t>& pixels,
            std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(png)) != 0) {  // NOLINT: the library's way
    return false;
  }
  png_set_user_limits(png, kMostPixelsAcross, kMostPixelsAcross);
  png_read_info(png, info);
  // Before anything is made room for: what a header may claim is 2 GB, whatever follows it.
  const auto& reading = *static_cast<const Reading*>(png_get_io_ptr(png));
  if (png_get_rowbytes(png, info) * png_get_image_height(png, info) >
      kMostExpansion * reading.bytes.size()) {
    png_error(png, "more pixels than its bytes can hold");
  }
  png_set_expand(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  image.columns = png_get_image_width(png, info);
  image.rows = png_get_image_height(png, info);
  image.channels = png_get_channels(png, info);
  image.bits = png_get_bit_depth(png, info);
  const std::size_t row_bytes = png_get_rowbytes(png, info);
  pixels.resize(row_bytes * image.rows);
  rows.resize(image.rows);
  for (std::size_t r = 0; r < image.rows; ++r) {
    rows[r] = pixels.data() + r * row_bytes;
  }
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  return true;
}

/// What libpng's callbacks share with encode().
struct Writing {
  std::vector<std::uint8_t>& bytes;
  char error[160] = {};
};

void give(png_structp png, png_bytep data, std::size_t count) {
  auto& bytes = static_cast<Writing*>(png_get_io_ptr(png))->bytes;
  bytes.insert(bytes.end(), data, data + count);
}

void nothing_to_flush(png_structp /*png*/) {}

[[noreturn]] void fail_writing(png_structp png, png_const_charp text) {
  auto& writing = *static_cast<Writing*>(png_get_error_ptr(png));
  std::strncpy(writing.error, text, sizeof writing.error - 1);
  png_longjmp(png, 1);
}

/// False with writing.error set. `rows` belong to the caller.
bool encode(png_structp png, png_infop info, const Image& image, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(png)) != 0) {  // NOLINT: the library's way
    return false;
  }
  constexpr std::array<int, 4> kColourTypes{PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                            PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.columns),
               static_cast<png_uint_32>(image.rows), image.bits, kColourTypes[image.channels - 1],
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  return true;
}

}  // namespace

Image decode_png(std::span<const std::uint8_t> bytes, const std::string& who) {
  constexpr std::size_t kSignatureBytes = 8;
  if (bytes.size() < kSignatureBytes || png_sig_cmp(bytes.data(), 0, kSignatureBytes) != 0) {
    throw std::invalid_argument(who + "is no PNG image");
  }
  Reading reading{bytes};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reading, fail, ignore_warning);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &reading, take);
  Image image;
  std::vector<std::uint8_t> pixels;
  std::vector<png_bytep> rows;
  const bool good = decode(png, info, image, pixels, rows);
  png_destroy_read_struct(&png, &info, nullptr);
  if (!good) {
    throw std::invalid_argument(who + "is damaged, or larger than " +
                                std::to_string(kMostPixelsAcross) +
                                " pixels along a side: " + reading.error);
  }
  const std::size_t count = image.columns * image.rows * image.channels;
  image.samples.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    image.samples[i] = image.bits == 16
                           ? static_cast<std::uint16_t>(pixels[2 * i] << 8U | pixels[2 * i + 1])
                           : pixels[i];
  }
  return image;
}

Image read_png(const std::filesystem::path& file, const std::string& who) {
  std::string content;
  try {
    content = read_outside_file(file, kImageFile);
  } catch (const FileRefused& refused) {
    throw std::invalid_argument(who +
                                (refused.missing() ? "there is no such file" : refused.rest()));
  }
  return decode_png({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, who);
}

std::vector<std::uint8_t> encode_png(const Image& image) {
  const bool shaped = image.columns > 0 && image.rows > 0 && image.columns <= kMostPixelsAcross &&
                      image.rows <= kMostPixelsAcross && image.channels >= 1 &&
                      image.channels <= 4 && (image.bits == 8 || image.bits == 16) &&
                      image.samples.size() == image.columns * image.rows * image.channels;
  if (!shaped) {
    throw std::invalid_argument("an image of " + std::to_string(image.columns) + " x " +
                                std::to_string(image.rows) + " pixels, " +
                                std::to_string(image.channels) + " channels of " +
                                std::to_string(image.bits) + " bits is none that PNG holds");
  }
  const std::size_t row_samples = image.columns * image.channels;
  const std::size_t row_bytes = row_samples * static_cast<std::size_t>(image.bits) / 8;
  std::vector<std::uint8_t> pixels(row_bytes * image.rows);
  for (std::size_t i = 0; i < image.samples.size(); ++i) {
    if (image.bits == 16) {
      // PNG stores 16-bit samples most significant byte first.
      pixels[2 * i] = static_cast<std::uint8_t>(image.samples[i] >> 8U);
      pixels[2 * i + 1] = static_cast<std::uint8_t>(image.samples[i] & 0xFFU);
    } else {
      pixels[i] = static_cast<std::uint8_t>(image.samples[i]);
    }
  }
  std::vector<png_bytep> rows(image.rows);
  for (std::size_t r = 0; r < image.rows; ++r) {
    rows[r] = pixels.data() + r * row_bytes;
  }
  std::vector<std::uint8_t> bytes;
  Writing writing{bytes};
  png_structp png =
      png_create_write_struct(PNG_LIBPNG_VER_STRING, &writing, fail_writing, ignore_warning);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &writing, give, nothing_to_flush);
  const bool good = encode(png, info, image, rows);
  png_destroy_write_struct(&png, &info);
  if (!good) {
    throw std::runtime_error(std::string("a PNG image cannot be made: ") + writing.error);
  }
  return bytes;
}

}  // namespace rigwire::hil
