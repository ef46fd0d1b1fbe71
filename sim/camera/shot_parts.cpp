#include "sim/camera/shot_parts.h"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace rigwire::sim {
namespace {

struct FormatName {
  PixelFormat format;
  std::string_view name;
};
constexpr std::array kFormatNames{FormatName{PixelFormat::mono8, "Mono8"},
                                  FormatName{PixelFormat::mono10, "Mono10"},
                                  FormatName{PixelFormat::mono12, "Mono12"},
                                  FormatName{PixelFormat::mono16, "Mono16"},
                                  FormatName{PixelFormat::bayer_rg8, "BayerRG8"},
                                  FormatName{PixelFormat::bayer_rg10, "BayerRG10"},
                                  FormatName{PixelFormat::bayer_rg12, "BayerRG12"},
                                  FormatName{PixelFormat::bayer_rg16, "BayerRG16"},
                                  FormatName{PixelFormat::rgb8, "RGB8"},
                                  FormatName{PixelFormat::coord3d_c16, "Coord3D_C16"},
                                  FormatName{PixelFormat::confidence8, "Confidence8"}};

constexpr std::array kGrey{PixelFormat::mono8, PixelFormat::mono10, PixelFormat::mono12};
constexpr std::array kBayer{PixelFormat::bayer_rg8, PixelFormat::bayer_rg10,
                            PixelFormat::bayer_rg12};

[[noreturn]] void refuse(std::string_view kind, const std::string& what, const std::string& found,
                         const std::string& allowed) {
  throw std::invalid_argument(std::string(kind) + ": " + what + ": found " + found + ", allowed " +
                              allowed);
}

/// A part that a command may ask for.
struct PartSwitch {
  std::string_view name;
  bool CameraCommand::*asked;
  bool PictureParts::*made;
};
constexpr std::array kSwitches{
    PartSwitch{"intensity", &CameraCommand::intensity, &PictureParts::intensity},
    PartSwitch{"right intensity", &CameraCommand::intensity_right, &PictureParts::intensity_right},
    PartSwitch{"disparity", &CameraCommand::disparity, &PictureParts::disparity},
    PartSwitch{"range", &CameraCommand::range, &PictureParts::range},
    PartSwitch{"confidence", &CameraCommand::confidence, &PictureParts::confidence}};

}  // namespace

std::string_view format_name(PixelFormat format) {
  const auto at = std::ranges::find(kFormatNames, format, &FormatName::format);
  return at == kFormatNames.end() ? "no format" : at->name;
}

std::span<const PixelFormat> sensor_formats(bool colour) {
  return colour ? std::span<const PixelFormat>(kBayer) : std::span<const PixelFormat>(kGrey);
}

void require_fits(const CameraCommand& command, std::string_view kind, const PictureParts& made,
                  std::span<const PixelFormat> formats) {
  bool any = false;
  std::string allowed;
  for (const PartSwitch& part : kSwitches) {
    if (made.*part.made) {
      allowed += (allowed.empty() ? "" : ", ") + std::string(part.name);
    }
  }
  for (const PartSwitch& part : kSwitches) {
    any = any || command.*part.asked;
    if (command.*part.asked && !(made.*part.made)) {
      refuse(kind, "parts", std::string(part.name), allowed);
    }
  }
  if (!any) {
    refuse(kind, "parts", "none", allowed);
  }
  if (std::ranges::find(formats, command.format) == formats.end()) {
    std::string names;
    for (const PixelFormat format : formats) {
      names += (names.empty() ? "" : ", ") + std::string(format_name(format));
    }
    refuse(kind, "format", std::string(format_name(command.format)), names);
  }
}

void require_region(const CameraCommand& command, std::string_view kind, int width, int height) {
  if (command.binning_horizontal != 1 || command.binning_vertical != 1) {
    refuse(kind, "binning",
           std::to_string(command.binning_horizontal) + " x " +
               std::to_string(command.binning_vertical),
           "1 x 1");
  }
  const PictureRegion& r = command.region;
  if (r.offset_x < 0 || r.offset_y < 0 || r.width < 1 || r.height < 1 || r.width > width ||
      r.height > height || r.offset_x > width - r.width || r.offset_y > height - r.height) {
    refuse(kind, "region",
           std::to_string(r.width) + " x " + std::to_string(r.height) + " at " +
               std::to_string(r.offset_x) + ", " + std::to_string(r.offset_y),
           "within " + std::to_string(width) + " x " + std::to_string(height));
  }
}

ReadOut read_out_of(const CameraShot& shot) {
  const CameraCommand& command = shot.command;
  const PictureRegion& region = command.region;
  // A side that overflows is refused as what it is: off the sensor.
  const auto sensor_pixels = [](int binned, int binning) {
    return static_cast<int>(std::clamp<std::int64_t>(static_cast<std::int64_t>(binned) * binning,
                                                     -1, std::int64_t{1} << 30));
  };
  ReadOut r;
  r.frame = shot.frame;
  r.region = {sensor_pixels(region.offset_x, command.binning_horizontal),
              sensor_pixels(region.offset_y, command.binning_vertical),
              sensor_pixels(region.width, command.binning_horizontal),
              sensor_pixels(region.height, command.binning_vertical)};
  r.binning_x = command.binning_horizontal;
  r.binning_y = command.binning_vertical;
  r.exposure = shot.exposure;
  r.gain_db = shot.gain_db;
  r.black_level = command.black_level;
  r.bits = static_cast<int>(significant_bits(command.format));
  return r;
}

ReadOut whole_read_out(const CameraShot& shot, const ImageSensorParameters& sensor) {
  ReadOut r = read_out_of(shot);
  r.region = {0, 0, sensor.width_px, sensor.height_px};
  r.binning_x = 1;
  r.binning_y = 1;
  return r;
}

PictureJob job_of(const CameraShot& shot, const ReadOut& read_out, const Eigen::Isometry3d& X_SC) {
  PictureJob job;
  job.read_out = read_out;
  job.exposure_start = shot.start;
  job.poses = shot.poses;
  // Another point of the same body: the same rates, and the speed of the lever arm.
  for (CameraPose& pose : job.poses) {
    LinkMotion& m = pose.mount;
    const Eigen::Vector3d arm_W = m.X_WL.linear() * X_SC.translation();
    m.v_WL_W += m.w_WL_W.cross(arm_W);
    m.X_WL = m.X_WL * X_SC;
  }
  job.mask = shot.mask;
  job.light = shot.light;
  job.air = shot.air;
  job.sky = shot.sky;
  job.wetness = shot.wetness;
  return job;
}

Duration whole_span(const CameraCommand& command, Duration exposure,
                    const ImageSensorParameters& sensor) {
  CameraShot shot;
  shot.command = command;
  shot.exposure = exposure;
  return exposure_span(job_of(shot, whole_read_out(shot, sensor)), sensor);
}

Picture empty_picture(const CameraShot& shot) {
  Picture picture;
  picture.exposure_start = shot.start;
  picture.exposure = shot.exposure;
  picture.gain_db = shot.gain_db;
  return picture;
}

void crop(std::span<const std::uint8_t> bytes, int width, const PictureRegion& region,
          std::size_t pixel_bytes, std::vector<std::uint8_t>& cropped) {
  const std::size_t row_bytes = static_cast<std::size_t>(region.width) * pixel_bytes;
  cropped.resize(row_bytes * static_cast<std::size_t>(region.height));
  for (int row = 0; row < region.height; ++row) {
    const std::size_t from =
        (static_cast<std::size_t>(region.offset_y + row) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(region.offset_x)) *
        pixel_bytes;
    std::ranges::copy(
        bytes.subspan(from, row_bytes),
        cropped.begin() + static_cast<std::ptrdiff_t>(row_bytes * static_cast<std::size_t>(row)));
  }
}

PicturePart& add_part(Picture& picture, PictureComponent component, PixelFormat format,
                      const PictureRegion& region, std::span<const std::uint8_t> bytes, int width) {
  PicturePart& part = picture.parts.emplace_back();
  part.component = component;
  part.format = format;
  part.region = region;
  crop(bytes, width, region, bytes_per_pixel(format), part.bytes);
  return part;
}

namespace {

/// Returns `region` of a RenderedPicture or of a CameraTruth.
template <class Known>
CameraTruth crop_known(const Known& known, const PictureRegion& region) {
  CameraTruth cropped;
  cropped.width = region.width;
  cropped.height = region.height;
  const auto rows = [&](const auto& from, auto& to) {
    for (int row = 0; row < region.height; ++row) {
      const auto begin = from.begin() +
                         static_cast<std::ptrdiff_t>(region.offset_y + row) * known.width +
                         region.offset_x;
      to.insert(to.end(), begin, begin + region.width);
    }
  };
  rows(known.range_m, cropped.range_m);
  rows(known.depth_m, cropped.depth_m);
  rows(known.instance, cropped.instance);
  return cropped;
}

}  // namespace

CameraTruth crop(const RenderedPicture& known, const PictureRegion& region) {
  return crop_known(known, region);
}

CameraTruth crop(const CameraTruth& truth, const PictureRegion& region) {
  return crop_known(truth, region);
}

void put_16(std::uint16_t value, std::uint8_t* to) {
  to[0] = static_cast<std::uint8_t>(value & 0xFFU);
  to[1] = static_cast<std::uint8_t>(value >> 8U);
}

}  // namespace rigwire::sim
