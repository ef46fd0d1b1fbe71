#include "hil/files/geotiff_file.h"

#include <tiffio.h>
#include <unistd.h>

#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <span>
#include <stdexcept>

#include "hil/configuration/outside_file.h"

namespace rigwire::hil {
namespace {

constexpr ttag_t kModelPixelScale = 33550;
constexpr ttag_t kModelTiepoint = 33922;
constexpr ttag_t kGeoKeyDirectory = 34735;
constexpr ttag_t kNoData = 42113;
constexpr std::uint32_t kMostPixels = 16384;

int keep_error(TIFF* /*tiff*/, void* user, const char* /*module*/, const char* format,
               va_list arguments) {
  auto& error = *static_cast<std::string*>(user);
  char text[200];
  std::vsnprintf(text, sizeof text, format, arguments);
  if (error.empty()) {
    error = text;
  }
  return 1;
}

int ignore_warning(TIFF* /*tiff*/, void* /*user*/, const char* /*module*/, const char* /*format*/,
                   va_list /*arguments*/) {
  return 1;
}

struct CloseTiff {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
struct FreeOptions {
  void operator()(TIFFOpenOptions* options) const { TIFFOpenOptionsFree(options); }
};

class Tiff {
 public:
  Tiff(const std::filesystem::path& file, const std::string& who) : who_(who) {
    const std::unique_ptr<TIFFOpenOptions, FreeOptions> options(TIFFOpenOptionsAlloc());
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), keep_error, &error_);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), ignore_warning, nullptr);
    const int descriptor = open_raster(file);
    // Not mapped into memory ("m"): if the file is truncated meanwhile, that would end the program.
    tiff_.reset(TIFFFdOpenExt(descriptor, file.c_str(), "rm", options.get()));
    if (!tiff_) {
      ::close(descriptor);
      refuse("cannot be read as TIFF");
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw std::invalid_argument(who_ + what + (error_.empty() ? "" : ": " + error_));
  }

  template <class Number>
  [[nodiscard]] Number field(ttag_t tag, Number otherwise) const {
    Number value = otherwise;
    return TIFFGetFieldDefaulted(tiff_.get(), tag, &value) == 1 ? value : otherwise;
  }
  /// Returns the numbers of a tag that libtiff does not know.
  template <class Number>
  [[nodiscard]] std::span<const Number> numbers(ttag_t tag) const {
    // The count is of 32 bits where a tag's length is not limited, of 16 where it is.
    std::uint32_t count = 0;
    const void* data = nullptr;
    if (TIFFGetField(tiff_.get(), tag, &count, &data) != 1 || data == nullptr) {
      return {};
    }
    return {static_cast<const Number*>(data), count};
  }
  [[nodiscard]] std::string text(ttag_t tag) const {
    const std::span<const char> found = numbers<char>(tag);
    return {found.begin(), found.end()};
  }
  [[nodiscard]] TIFF* get() const { return tiff_.get(); }

 private:
  [[nodiscard]] int open_raster(const std::filesystem::path& file) const {
    try {
      return OutsideFile(file, kHeightMapFile).release();
    } catch (const FileRefused& refused) {
      refuse(refused.missing() ? "there is no such file" : refused.rest());
    }
  }

  std::string who_;
  std::string error_;
  std::unique_ptr<TIFF, CloseTiff> tiff_;
};

/// The type of one sample in the file's bytes, which are in the machine's order by now.
struct SampleFormat {
  std::uint16_t bits = 8;
  std::uint16_t kind = SAMPLEFORMAT_UINT;

  template <class Number>
  static double as(const std::uint8_t* bytes) {
    Number number{};
    std::memcpy(&number, bytes, sizeof number);
    return static_cast<double>(number);
  }
  [[nodiscard]] bool known() const {
    return kind == SAMPLEFORMAT_IEEEFP ? bits == 32 || bits == 64
                                       : (kind == SAMPLEFORMAT_UINT || kind == SAMPLEFORMAT_INT) &&
                                             (bits == 8 || bits == 16 || bits == 32);
  }
  [[nodiscard]] double read(const std::uint8_t* bytes) const {
    if (kind == SAMPLEFORMAT_IEEEFP) {
      return bits == 32 ? as<float>(bytes) : as<double>(bytes);
    }
    if (kind == SAMPLEFORMAT_INT) {
      return bits == 8 ? as<std::int8_t>(bytes)
                       : (bits == 16 ? as<std::int16_t>(bytes) : as<std::int32_t>(bytes));
    }
    return bits == 8 ? as<std::uint8_t>(bytes)
                     : (bits == 16 ? as<std::uint16_t>(bytes) : as<std::uint32_t>(bytes));
  }
};

/// Tiles, or strips as tiles of the raster's whole width.
void read_values(const Tiff& tiff, const SampleFormat& format, GeoRaster& raster) {
  const bool tiled = TIFFIsTiled(tiff.get()) != 0;
  const auto width = tiled ? tiff.field<std::uint32_t>(TIFFTAG_TILEWIDTH, 0)
                           : static_cast<std::uint32_t>(raster.columns);
  const auto height = tiled ? tiff.field<std::uint32_t>(TIFFTAG_TILELENGTH, 0)
                            : std::min(tiff.field<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, 0xFFFFFFFFU),
                                       static_cast<std::uint32_t>(raster.rows));
  if (width == 0 || height == 0 || width > 2 * kMostPixels || height > 2 * kMostPixels) {
    tiff.refuse("has tiles or strips without or of absurd size");
  }
  const std::size_t sample_bytes = format.bits / 8U;
  const std::size_t whole = width * static_cast<std::size_t>(height) * sample_bytes;
  std::vector<std::uint8_t> bytes(whole);
  raster.values.assign(raster.columns * raster.rows, 0.0);
  for (std::uint32_t first_row = 0; first_row < raster.rows; first_row += height) {
    for (std::uint32_t first_column = 0; first_column < raster.columns; first_column += width) {
      const std::size_t rows = std::min<std::size_t>(height, raster.rows - first_row);
      const std::size_t needed = tiled ? whole : rows * width * sample_bytes;
      const tmsize_t got =
          tiled ? TIFFReadEncodedTile(tiff.get(),
                                      TIFFComputeTile(tiff.get(), first_column, first_row, 0, 0),
                                      bytes.data(), static_cast<tmsize_t>(needed))
                : TIFFReadEncodedStrip(tiff.get(), TIFFComputeStrip(tiff.get(), first_row, 0),
                                       bytes.data(), static_cast<tmsize_t>(needed));
      if (got < static_cast<tmsize_t>(needed)) {
        tiff.refuse("is damaged or ends early");
      }
      const std::size_t columns = std::min<std::size_t>(width, raster.columns - first_column);
      for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < columns; ++c) {
          raster.values[(first_row + r) * raster.columns + first_column + c] =
              format.read(bytes.data() + (r * width + c) * sample_bytes);
        }
      }
    }
  }
}

/// OGC 19-008r4, 7.1.2: a header of four numbers, then four for each key.
void read_keys(const Tiff& tiff, GeoRaster& raster) {
  constexpr std::uint16_t kRasterType = 1025;
  constexpr std::uint16_t kGeographicType = 2048;
  constexpr std::uint16_t kProjectedType = 3072;
  constexpr std::uint16_t kPixelIsPoint = 2;
  const auto keys = tiff.numbers<std::uint16_t>(kGeoKeyDirectory);
  int geographic = 0;
  for (std::size_t i = 4; i + 3 < keys.size(); i += 4) {
    if (keys[i + 1] != 0) {
      continue;  // its value is in another tag
    }
    const std::uint16_t value = keys[i + 3];
    if (keys[i] == kRasterType) {
      raster.pixel_is_area = value != kPixelIsPoint;
    } else if (keys[i] == kGeographicType) {
      geographic = value;
    } else if (keys[i] == kProjectedType) {
      raster.epsg = value;
    }
  }
  raster.epsg = raster.epsg != 0 ? raster.epsg : geographic;
}

}  // namespace

GeoRaster read_geotiff(const std::filesystem::path& file, const std::string& who) {
  const Tiff tiff(file, who);
  GeoRaster raster;
  const auto columns = tiff.field<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
  const auto rows = tiff.field<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
  if (columns < 1 || rows < 1 || columns > kMostPixels || rows > kMostPixels) {
    tiff.refuse("has " + std::to_string(columns) + " x " + std::to_string(rows) +
                " pixels, allowed: 1 to " + std::to_string(kMostPixels) + " along a side");
  }
  raster.columns = columns;
  raster.rows = rows;
  const SampleFormat format{tiff.field<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1),
                            tiff.field<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT)};
  if (const auto samples = tiff.field<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
      samples != 1 || !format.known()) {
    tiff.refuse("has " + std::to_string(samples) + " samples to the pixel, of " +
                std::to_string(format.bits) + " bits and format " + std::to_string(format.kind) +
                "; allowed: one, an integer of 8, 16 or 32 bits or a float of 32 or 64");
  }
  read_values(tiff, format, raster);
  if (const auto scale = tiff.numbers<double>(kModelPixelScale); scale.size() >= 2) {
    raster.pixel = {scale[0], scale[1]};
  }
  if (const auto tie = tiff.numbers<double>(kModelTiepoint); tie.size() >= 6) {
    raster.tie_point = GeoRaster::TiePoint{tie[0], tie[1], tie[3], tie[4]};
  }
  read_keys(tiff, raster);
  if (const std::string text = tiff.text(kNoData); !text.empty()) {
    const double none = std::strtod(text.c_str(), nullptr);
    // GDAL writes the value of a float raster with fewer digits than a double has.
    for (double& value : raster.values) {
      if (value == none || static_cast<float>(value) == static_cast<float>(none)) {
        value = std::numeric_limits<double>::quiet_NaN();
      }
    }
  }
  return raster;
}

}  // namespace rigwire::hil
