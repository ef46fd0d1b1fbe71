// Numbers of pixel formats after PFNC, the Pixel Format Naming Convention of EMVA (public document,
// version 2.1, and its file PFNC.h): bits 24 .. 31 say single component or several, bits 16 .. 23
// how many bits a pixel takes, bits 0 .. 15 which format it is.
//
// Unpacked formats of more than 8 bits take two bytes, the least significant first unless the
// stream channel is set otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace rigwire::protocols::gige_vision {

enum class PixelFormatCode : std::uint32_t {
  mono8 = 0x0108'0001,
  mono10 = 0x0110'0003,
  mono12 = 0x0110'0005,
  mono16 = 0x0110'0007,
  bayer_rg8 = 0x0108'0009,
  bayer_rg10 = 0x0110'000D,
  bayer_rg12 = 0x0110'0011,
  bayer_rg16 = 0x0110'002F,
  rgb8 = 0x0218'0014,
  coord3d_c16 = 0x0110'00B8,
  confidence8 = 0x0108'00C6,
};

[[nodiscard]] constexpr std::uint32_t bits_per_pixel(PixelFormatCode code) {
  return (static_cast<std::uint32_t>(code) >> 16U) & 0xFFU;
}

struct PixelFormatName {
  PixelFormatCode code;
  std::string_view name;  ///< Name used by clients.
};
inline constexpr std::array kPixelFormats{
    PixelFormatName{PixelFormatCode::mono8, "Mono8"},
    PixelFormatName{PixelFormatCode::mono10, "Mono10"},
    PixelFormatName{PixelFormatCode::mono12, "Mono12"},
    PixelFormatName{PixelFormatCode::mono16, "Mono16"},
    PixelFormatName{PixelFormatCode::bayer_rg8, "BayerRG8"},
    PixelFormatName{PixelFormatCode::bayer_rg10, "BayerRG10"},
    PixelFormatName{PixelFormatCode::bayer_rg12, "BayerRG12"},
    PixelFormatName{PixelFormatCode::bayer_rg16, "BayerRG16"},
    PixelFormatName{PixelFormatCode::rgb8, "RGB8"},
    PixelFormatName{PixelFormatCode::coord3d_c16, "Coord3D_C16"},
    PixelFormatName{PixelFormatCode::confidence8, "Confidence8"},
};

/// Empty for a number that is not in the list.
[[nodiscard]] constexpr std::string_view pixel_format_name(PixelFormatCode code) {
  for (const PixelFormatName& format : kPixelFormats) {
    if (format.code == code) {
      return format.name;
    }
  }
  return {};
}
[[nodiscard]] constexpr std::optional<PixelFormatCode> find_pixel_format(std::string_view name) {
  for (const PixelFormatName& format : kPixelFormats) {
    if (format.name == name) {
      return format.code;
    }
  }
  return std::nullopt;
}

}  // namespace rigwire::protocols::gige_vision
