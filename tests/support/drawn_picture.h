// Pictures for cameras that have no scene: what a test's sensor draws.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "emulators/gige_camera/camera_backend.h"

namespace rigwire::emulators {

/// A picture whose bytes tell part, row and column.
inline std::shared_ptr<const Picture> drawn(const CameraCommand& command, SimTime start,
                                            std::uint8_t seed = 0) {
  auto picture = std::make_shared<Picture>();
  picture->exposure_start = start;
  picture->exposure = command.exposure;
  picture->gain_db = command.gain_db;
  const auto add = [&](PictureComponent component, std::uint8_t source, PixelFormat format) {
    PicturePart part;
    part.component = component;
    part.source = source;
    part.format = format;
    part.region = command.region;
    part.bytes.resize(static_cast<std::size_t>(part.region.width) *
                      static_cast<std::size_t>(part.region.height) * bytes_per_pixel(format));
    for (std::size_t i = 0; i < part.bytes.size(); ++i) {
      part.bytes[i] =
          static_cast<std::uint8_t>(i * 7 + i / 251 + picture->parts.size() * 31 + seed);
    }
    picture->parts.push_back(std::move(part));
  };
  if (command.intensity) {
    add(PictureComponent::intensity, 0, command.format);
  }
  if (command.intensity_right) {
    add(PictureComponent::intensity, 1, command.format);
  }
  if (command.disparity) {
    add(PictureComponent::disparity, 0, PixelFormat::coord3d_c16);
  }
  if (command.range) {
    add(PictureComponent::range, 0, PixelFormat::coord3d_c16);
  }
  if (command.confidence) {
    add(PictureComponent::confidence, 0, PixelFormat::confidence8);
  }
  return picture;
}

}  // namespace rigwire::emulators
