// Common to all kinds of camera: checks whether a shot is possible, and arranges pictures as parts.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/camera/camera_renderer.h"
#include "sim/camera/camera_sensor.h"

namespace rigwire::sim {

/// Parts that a kind of camera can make; the flags are those of CameraCommand.
struct PictureParts {
  bool intensity = true;
  bool intensity_right = false;
  bool disparity = false;
  bool range = false;
  bool confidence = false;
};
inline constexpr PictureParts kStereoParts{true, true, true, false, true};
inline constexpr PictureParts kDepthParts{true, false, false, true, true};

/// Throws std::invalid_argument if the command asks for no part, for one that the kind does not
/// make, or for a format that is not in `formats`. `kind`: for the message.
void require_fits(const CameraCommand& command, std::string_view kind, const PictureParts& made,
                  std::span<const PixelFormat> formats);
/// Throws std::invalid_argument for binning, or for a region that is not within the picture; of
/// kinds whose pictures are made from several others.
void require_region(const CameraCommand& command, std::string_view kind, int width, int height);

/// "mono8", as GenICam calls it.
[[nodiscard]] std::string_view format_name(PixelFormat format);
/// Formats of a grey sensor, or of one behind a Bayer mosaic.
[[nodiscard]] std::span<const PixelFormat> sensor_formats(bool colour);

/// Returns the read-out of a shot: region and binning as the command has them.
[[nodiscard]] ReadOut read_out_of(const CameraShot& shot);
/// Returns the read-out of the whole sensor for a shot, without binning.
[[nodiscard]] ReadOut whole_read_out(const CameraShot& shot, const ImageSensorParameters& sensor);
/// The rest of a job; `X_SC`: a camera's own mount frame C, standing in the shot's S.
[[nodiscard]] PictureJob job_of(const CameraShot& shot, const ReadOut& read_out,
                                const Eigen::Isometry3d& X_SC = Eigen::Isometry3d::Identity());

/// How long a shot of all of a sensor takes (CameraSensor::span).
[[nodiscard]] Duration whole_span(const CameraCommand& command, Duration exposure,
                                  const ImageSensorParameters& sensor);

/// A picture with the shot's times and no parts.
[[nodiscard]] Picture empty_picture(const CameraShot& shot);
/// Copies `region` of a picture of `width` columns, `pixel_bytes` per pixel, to `cropped`.
void crop(std::span<const std::uint8_t> bytes, int width, const PictureRegion& region,
          std::size_t pixel_bytes, std::vector<std::uint8_t>& cropped);
/// Adds a part of that region, cut out of `bytes` of a picture of `width` columns. What it returns
/// is valid until the next one.
PicturePart& add_part(Picture& picture, PictureComponent component, PixelFormat format,
                      const PictureRegion& region, std::span<const std::uint8_t> bytes, int width);
/// Returns the truth of `region` of a rendered picture.
[[nodiscard]] CameraTruth crop(const RenderedPicture& known, const PictureRegion& region);
/// Returns `region` of `truth`.
[[nodiscard]] CameraTruth crop(const CameraTruth& truth, const PictureRegion& region);

/// Writes 16 bits, the least significant byte first.
void put_16(std::uint16_t value, std::uint8_t* to);

}  // namespace rigwire::sim
