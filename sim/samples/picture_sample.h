// A camera's request to its sensor, and one picture as the sensor delivers it.
//
// A picture is one exposure and everything computed from it: the plain image, or several parts (the
// left image, the disparity and its confidence). It is shared and immutable, so that device,
// recording and clients that keep frames for a while hold the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/samples/time.h"

namespace rigwire {

/// Format of a pixel. Formats of more than 8 bits have two bytes per value, the least significant
/// first, with the value in the low bits.
enum class PixelFormat : std::uint8_t {
  mono8,
  mono10,
  mono12,
  mono16,
  bayer_rg8,  ///< First row red green red ..., second row green blue green ...
  bayer_rg10,
  bayer_rg12,
  bayer_rg16,
  rgb8,         ///< Three bytes: red, green, blue.
  coord3d_c16,  ///< Third coordinate (depth or disparity), see CoordinateCoding.
  confidence8,  ///< 0 = none .. 255 = full.
};

[[nodiscard]] constexpr std::size_t bytes_per_pixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::mono8:
    case PixelFormat::bayer_rg8:
    case PixelFormat::confidence8:
      return 1;
    case PixelFormat::rgb8:
      return 3;
    case PixelFormat::mono10:
    case PixelFormat::mono12:
    case PixelFormat::mono16:
    case PixelFormat::bayer_rg10:
    case PixelFormat::bayer_rg12:
    case PixelFormat::bayer_rg16:
    case PixelFormat::coord3d_c16:
      return 2;
  }
  return 0;
}

/// Bits of one sample (of a grey value, of one colour) that can be other than zero.
[[nodiscard]] constexpr unsigned significant_bits(PixelFormat format) {
  switch (format) {
    case PixelFormat::mono8:
    case PixelFormat::bayer_rg8:
    case PixelFormat::rgb8:
    case PixelFormat::confidence8:
      return 8;
    case PixelFormat::mono10:
    case PixelFormat::bayer_rg10:
      return 10;
    case PixelFormat::mono12:
    case PixelFormat::bayer_rg12:
      return 12;
    case PixelFormat::mono16:
    case PixelFormat::bayer_rg16:
    case PixelFormat::coord3d_c16:
      return 16;
  }
  return 0;
}

/// What a part of a picture shows.
enum class PictureComponent : std::uint8_t {
  intensity,
  disparity,   ///< Pixels between left and right, coded.
  range,       ///< Distance along the optical axis, coded.
  confidence,  ///< Confidence of the disparity or range beside it.
};

/// Coordinate = offset + scale * value; of disparity in pixels, of range in metres.
struct CoordinateCoding {
  double scale = 1.0;
  double offset = 0.0;
  std::uint16_t invalid = 0;  ///< Value of a pixel that has no coordinate.

  friend bool operator==(const CoordinateCoding&, const CoordinateCoding&) = default;
};

/// A rectangle of the sensor. Its unit is the pixel after binning.
struct PictureRegion {
  int offset_x = 0;
  int offset_y = 0;
  int width = 0;
  int height = 0;

  friend bool operator==(const PictureRegion&, const PictureRegion&) = default;
};

/// One plane of a picture.
struct PicturePart {
  PictureComponent component = PictureComponent::intensity;
  std::uint8_t source = 0;  ///< Optical head: 0 left or only, 1 right.
  PixelFormat format = PixelFormat::mono8;
  PictureRegion region;
  /// region.width * region.height pixels, the top row first; no padding anywhere.
  std::vector<std::uint8_t> bytes;
};

/// One exposure.
struct Picture {
  SimTime exposure_start{};        ///< Start of exposure of the first row.
  Duration exposure{0};            ///< Exposure time of each row, commanded or automatic.
  double gain_db = 0.0;            ///< Commanded or automatic.
  std::vector<PicturePart> parts;  ///< In the order in which they are sent; at least one.
};

/// What the sensor hands over at `time`: when the last row of the exposure has been read out.
struct PictureSample {
  SimTime time{};
  SimTime exposure_start{};  ///< Start of exposure; also for a picture that was skipped.
  /// Null: there was no time to make it, as in a camera that is triggered too fast.
  std::shared_ptr<const Picture> picture;
  bool late = false;  ///< Delivered later than by a machine that is fast enough.
};

/// What a camera wants of its sensor; acts from the next exposure on.
///
/// When to expose by itself (free-running or by a line) is the device's sample plan
/// (SamplePlan, emulators/device.h): each instant of the plan is the start of one exposure.
/// Exposures by software are counted here.
struct CameraCommand {
  PixelFormat format = PixelFormat::mono8;  ///< Pixel format of the intensity.
  PictureRegion region;  ///< Width and height are greater than 0 when it is used.
  int binning_horizontal = 1;
  int binning_vertical = 1;
  Duration exposure{0};        ///< With automatic exposure: where that starts.
  bool exposure_auto = false;  ///< The sensor chooses the exposure.
  double gain_db = 0.0;
  bool gain_auto = false;    ///< The sensor chooses the gain.
  double black_level = 0.0;  ///< Added to every pixel, in grey levels of an 8-bit picture.
  /// Parts of a picture, in this order; a camera asks only for what its sensor can make.
  bool intensity = true;
  bool intensity_right = false;  ///< The right image of a stereo camera.
  bool disparity = false;
  bool range = false;
  bool confidence = false;
  /// Rises by one for each exposure that a client has triggered: it starts at once, which is the
  /// earliest instant that has not been computed yet.
  std::uint32_t software_triggers = 0;

  friend bool operator==(const CameraCommand&, const CameraCommand&) = default;
};

/// Returns the number of bytes of all parts of a picture that this command asks for.
[[nodiscard]] constexpr std::size_t picture_bytes(const CameraCommand& command) {
  const std::size_t images = (command.intensity ? 1U : 0U) + (command.intensity_right ? 1U : 0U);
  const std::size_t coordinates = (command.disparity ? 1U : 0U) + (command.range ? 1U : 0U);
  const std::size_t confidences = command.confidence ? 1U : 0U;
  return static_cast<std::size_t>(command.region.width) *
         static_cast<std::size_t>(command.region.height) *
         (images * bytes_per_pixel(command.format) +
          coordinates * bytes_per_pixel(PixelFormat::coord3d_c16) +
          confidences * bytes_per_pixel(PixelFormat::confidence8));
}

}  // namespace rigwire
