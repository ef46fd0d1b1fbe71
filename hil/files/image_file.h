// Images in PNG files (ISO/IEC 15948): textures' alpha, heights, pictures of cameras.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace rigwire::hil {

/// Row 0 is the top row. Samples of up to 8 bits are spread over 0 .. 255, those of 16 stay as they
/// are; no gamma is applied; palettes are looked up.
struct Image {
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::size_t channels = 1;  ///< 1 grey, 2 grey and alpha, 3 RGB, 4 RGB and alpha.
  int bits = 8;              ///< 8 or 16.
  std::vector<std::uint16_t> samples;

  [[nodiscard]] bool has_alpha() const { return channels == 2 || channels == 4; }
  [[nodiscard]] std::uint16_t sample(std::size_t column, std::size_t row,
                                     std::size_t channel) const {
    return samples[(row * columns + column) * channels + channel];
  }
};

/// Throw std::invalid_argument beginning with `who` when it is no PNG, is damaged, or has more than
/// 16384 pixels along a side.
[[nodiscard]] Image decode_png(std::span<const std::uint8_t> bytes, const std::string& who);
/// Decodes a PNG file like decode_png(); throws also when it cannot be read.
[[nodiscard]] Image read_png(const std::filesystem::path& file, const std::string& who);

/// The image as a PNG file has it, of the same samples; the same image gives the same bytes. Throws
/// std::invalid_argument when it has no pixels, more than 16384 along a side, or samples that do
/// not match its shape; std::runtime_error when libpng refuses it.
[[nodiscard]] std::vector<std::uint8_t> encode_png(const Image& image);

}  // namespace rigwire::hil
