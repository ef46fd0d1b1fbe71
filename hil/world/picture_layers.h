// A camera's picture, and what is true behind it, as images for people and programs.
//
// Shown: colours and grey levels of a screen (IEC 61966-2-1: the numbers of a camera are in
// proportion to light), a Bayer mosaic interpolated bilinearly; distances in false colours, the
// same whatever measured them, so that disparity and truth can be laid side by side; labels in a
// colour each.
//
// Raw: the numbers themselves. Of image, right, disparity, range and confidence as they leave the
// camera (mosaics too, more than 8 bits in the low bits of 16); of depth millimetres, 65535 what is
// farther, 0 nothing; of labels the place in label_shares(), 0 nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/files/image_file.h"
#include "sim/camera/camera_sensor.h"
#include "sim/camera/reported_geometry.h"
#include "sim/samples/picture_sample.h"

namespace rigwire::hil {

enum class PictureLayer : std::uint8_t {
  image,
  right,
  disparity,
  range,
  confidence,
  depth,   ///< True depth along the optical axis.
  labels,  ///< True labels.
};

/// Names in the command line and the documents, in the order of the enumeration.
inline constexpr std::array<std::string_view, 7> kPictureLayers{
    "image", "right", "disparity", "range", "confidence", "depth", "labels"};

/// A picture with the truth of its first part.
struct KeptPicture {
  std::shared_ptr<const Picture> picture;
  sim::CameraTruth truth;
  std::vector<std::string> labels;  ///< By instance, as far as truth.instance has them.
  /// Geometry that a camera with a third coordinate reports.
  std::optional<sim::ReportedGeometry> geometry;
};

/// Returns the names of the layers that the picture has.
[[nodiscard]] std::vector<std::string> layers_of(const KeptPicture& kept);

/// Throws std::invalid_argument naming the layer and the existing ones.
[[nodiscard]] Image layer_image(const KeptPicture& kept, PictureLayer layer, bool raw);

/// A label that occurs in a picture.
struct LabelShare {
  std::string label;
  std::array<std::uint8_t, 3> colour{};  ///< Colour of the label, equal in every picture.
  std::size_t pixels = 0;
};
/// Returns the labels sorted by name. A label's position, counted from 1, is its number in the raw
/// layer.
[[nodiscard]] std::vector<LabelShare> label_shares(const KeptPicture& kept);

/// False colour of a distance: from red at 1 m by yellow, green and cyan to blue at 100 m, evenly
/// over its logarithm; black where there is none.
[[nodiscard]] std::array<std::uint8_t, 3> distance_colour(double distance_m);

}  // namespace rigwire::hil
