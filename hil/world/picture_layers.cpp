#include "hil/world/picture_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

namespace rigwire::hil {
namespace {

constexpr double kNearest_m = 1.0;
constexpr double kFarthest_m = 100.0;

struct PartPlace {
  PictureComponent component;
  std::uint8_t source;
};

PartPlace place_of(PictureLayer layer) {
  switch (layer) {
    case PictureLayer::right:
      return {PictureComponent::intensity, 1};
    case PictureLayer::disparity:
      return {PictureComponent::disparity, 0};
    case PictureLayer::range:
      return {PictureComponent::range, 0};
    case PictureLayer::confidence:
      return {PictureComponent::confidence, 0};
    case PictureLayer::image:
    case PictureLayer::depth:
    case PictureLayer::labels:
      break;
  }
  return {PictureComponent::intensity, 0};
}

bool is_truth(PictureLayer layer) {
  return layer == PictureLayer::depth || layer == PictureLayer::labels;
}

const PicturePart* find_part(const Picture& picture, PictureLayer layer) {
  const PartPlace place = place_of(layer);
  const auto part = std::ranges::find_if(picture.parts, [&](const PicturePart& p) {
    return p.component == place.component && p.source == place.source;
  });
  return part == picture.parts.end() ? nullptr : &*part;
}

Image image_of(int width, int height, std::size_t channels, int bits) {
  Image image;
  image.columns = static_cast<std::size_t>(width);
  image.rows = static_cast<std::size_t>(height);
  image.channels = channels;
  image.bits = bits;
  image.samples.resize(image.columns * image.rows * channels);
  return image;
}

/// Samples of a part as numbers, whatever their bytes.
std::vector<std::uint16_t> numbers_of(const PicturePart& part) {
  const bool wide = significant_bits(part.format) > 8;
  std::vector<std::uint16_t> numbers(part.bytes.size() / (wide ? 2 : 1));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = wide ? static_cast<std::uint16_t>(part.bytes[2 * i] | part.bytes[2 * i + 1] << 8U)
                      : part.bytes[i];
  }
  return numbers;
}

std::uint16_t screen_level(double light) {
  const double v = std::clamp(light, 0.0, 1.0);
  const double encoded = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint16_t>(std::lround(255.0 * encoded));
}

bool is_mosaic(PixelFormat format) {
  return format == PixelFormat::bayer_rg8 || format == PixelFormat::bayer_rg10 ||
         format == PixelFormat::bayer_rg12 || format == PixelFormat::bayer_rg16;
}

/// Mean of the neighbours, at most one pixel away, behind the filter of that band.
double neighbours_mean(std::span<const std::uint16_t> numbers, int width, int height, int x, int y,
                       int band) {
  double sum = 0.0;
  double weights = 0.0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const int u = x + dx;
      const int v = y + dy;
      if (u < 0 || v < 0 || u >= width || v >= height || (u & 1) + (v & 1) != band) {
        continue;
      }
      // The pixel's own number, else the mean of those beside it, else of those at its corners.
      const double weight = dx == 0 && dy == 0 ? 1e6 : (dx == 0 || dy == 0 ? 1e3 : 1.0);
      sum += weight * numbers[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(u)];
      weights += weight;
    }
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

Image shown(const PicturePart& part) {
  const int width = part.region.width;
  const int height = part.region.height;
  const std::vector<std::uint16_t> numbers = numbers_of(part);
  const double full = (1U << significant_bits(part.format)) - 1U;
  if (part.format == PixelFormat::confidence8) {
    Image image = image_of(width, height, 1, 8);
    image.samples = numbers;
    return image;
  }
  if (!is_mosaic(part.format)) {
    Image image = image_of(width, height, part.format == PixelFormat::rgb8 ? 3 : 1, 8);
    std::ranges::transform(numbers, image.samples.begin(),
                           [&](std::uint16_t number) { return screen_level(number / full); });
    return image;
  }
  Image image = image_of(width, height, 3, 8);
  std::size_t at = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int band = 0; band < 3; ++band) {
        image.samples[at++] =
            screen_level(neighbours_mean(numbers, width, height, x, y, band) / full);
      }
    }
  }
  return image;
}

Image raw_numbers(const PicturePart& part) {
  Image image =
      image_of(part.region.width, part.region.height, part.format == PixelFormat::rgb8 ? 3 : 1,
               significant_bits(part.format) > 8 ? 16 : 8);
  image.samples = numbers_of(part);
  return image;
}

template <class Distance>
Image distances(int width, int height, const Distance& distance_m) {
  Image image = image_of(width, height, 3, 8);
  const std::size_t pixels = image.columns * image.rows;
  for (std::size_t i = 0; i < pixels; ++i) {
    std::ranges::copy(distance_colour(distance_m(i)),
                      image.samples.begin() + 3 * static_cast<std::ptrdiff_t>(i));
  }
  return image;
}

Image shown_coordinates(const KeptPicture& kept, const PicturePart& part) {
  const std::vector<std::uint16_t> numbers = numbers_of(part);
  const sim::ReportedGeometry geometry = kept.geometry.value_or(sim::ReportedGeometry{});
  const CoordinateCoding& coding = geometry.coding;
  return distances(part.region.width, part.region.height, [&](std::size_t i) {
    if (numbers[i] == coding.invalid) {
      return 0.0;
    }
    const double value = coding.offset + coding.scale * numbers[i];
    return part.component == PictureComponent::range
               ? value
               : geometry.focal_length_px * geometry.baseline_m / std::max(value, 1e-6);
  });
}

const std::string& label_at(const KeptPicture& kept, std::size_t pixel) {
  static const std::string kNone;
  const std::uint32_t instance = kept.truth.instance[pixel];
  return instance < kept.labels.size() ? kept.labels[instance] : kNone;
}

/// FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo), of 32 bits.
std::uint32_t hash_of(std::string_view text) {
  std::uint32_t hash = 0x811C9DC5U;
  for (const char c : text) {
    hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x01000193U;
  }
  return hash;
}

std::array<std::uint8_t, 3> label_colour(std::string_view label) {
  // Hue and brightness by the name: HSV at a saturation of 0.65.
  const std::uint32_t hash = hash_of(label) * 0x9E3779B1U;
  const double hue = 6.0 * (hash >> 8U) / 0x1.0p24;
  const double bright = 0.55 + 0.45 * (hash & 0xFFU) / 255.0;
  std::array<std::uint8_t, 3> colour{};
  for (int band = 0; band < 3; ++band) {
    const double turn = std::fmod(hue + 6.0 - 2.0 * band, 6.0);
    const double away = std::clamp(std::abs(turn > 3.0 ? turn - 6.0 : turn) - 1.0, 0.0, 1.0);
    colour[static_cast<std::size_t>(band)] =
        static_cast<std::uint8_t>(std::lround(255.0 * bright * (1.0 - 0.65 * away)));
  }
  return colour;
}

Image true_depth(const KeptPicture& kept, bool raw) {
  const sim::CameraTruth& truth = kept.truth;
  if (!raw) {
    return distances(truth.width, truth.height,
                     [&](std::size_t i) { return static_cast<double>(truth.depth_m[i]); });
  }
  Image image = image_of(truth.width, truth.height, 1, 16);
  std::ranges::transform(truth.depth_m, image.samples.begin(), [](float depth_m) {
    return static_cast<std::uint16_t>(
        std::clamp(std::lround(1e3 * static_cast<double>(depth_m)), 0L, 65535L));
  });
  return image;
}

Image true_labels(const KeptPicture& kept, bool raw) {
  const std::vector<LabelShare> shares = label_shares(kept);
  std::map<std::string_view, std::size_t> places;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    places[shares[i].label] = i;
  }
  Image image = image_of(kept.truth.width, kept.truth.height, raw ? 1 : 3, raw ? 16 : 8);
  for (std::size_t i = 0; i < kept.truth.instance.size(); ++i) {
    const std::string& label = label_at(kept, i);
    if (label.empty()) {
      continue;
    }
    const std::size_t place = places.at(label);
    if (raw) {
      image.samples[i] = static_cast<std::uint16_t>(place + 1);
    } else {
      std::ranges::copy(shares[place].colour,
                        image.samples.begin() + 3 * static_cast<std::ptrdiff_t>(i));
    }
  }
  return image;
}

}  // namespace

std::array<std::uint8_t, 3> distance_colour(double distance_m) {
  if (!(distance_m > 0.0)) {
    return {};
  }
  constexpr std::array<std::array<double, 3>, 5> kStops{{{215.0, 38.0, 30.0},
                                                         {246.0, 200.0, 55.0},
                                                         {80.0, 180.0, 75.0},
                                                         {60.0, 180.0, 205.0},
                                                         {45.0, 60.0, 150.0}}};
  const double along =
      (kStops.size() - 1) *
      std::clamp(std::log(distance_m / kNearest_m) / std::log(kFarthest_m / kNearest_m), 0.0, 1.0);
  const std::size_t from = std::min(static_cast<std::size_t>(along), kStops.size() - 2);
  const double share = along - static_cast<double>(from);
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t band = 0; band < 3; ++band) {
    colour[band] = static_cast<std::uint8_t>(
        std::lround((1.0 - share) * kStops[from][band] + share * kStops[from + 1][band]));
  }
  return colour;
}

std::vector<std::string> layers_of(const KeptPicture& kept) {
  std::vector<std::string> layers;
  for (std::size_t i = 0; i < kPictureLayers.size(); ++i) {
    const auto layer = static_cast<PictureLayer>(i);
    if (is_truth(layer) ? !kept.truth.instance.empty()
                        : find_part(*kept.picture, layer) != nullptr) {
      layers.emplace_back(kPictureLayers[i]);
    }
  }
  return layers;
}

Image layer_image(const KeptPicture& kept, PictureLayer layer, bool raw) {
  const std::string_view name = kPictureLayers[static_cast<std::size_t>(layer)];
  const std::vector<std::string> there = layers_of(kept);
  if (std::ranges::find(there, name) == there.end()) {
    throw std::invalid_argument(fmt::format("layer: found \"{}\", allowed of this camera {}", name,
                                            fmt::join(there, ", ")));
  }
  if (layer == PictureLayer::depth) {
    return true_depth(kept, raw);
  }
  if (layer == PictureLayer::labels) {
    return true_labels(kept, raw);
  }
  const PicturePart& part = *find_part(*kept.picture, layer);
  if (raw) {
    return raw_numbers(part);
  }
  return part.format == PixelFormat::coord3d_c16 ? shown_coordinates(kept, part) : shown(part);
}

std::vector<LabelShare> label_shares(const KeptPicture& kept) {
  std::map<std::string_view, std::size_t> pixels;
  for (std::size_t i = 0; i < kept.truth.instance.size(); ++i) {
    if (const std::string& label = label_at(kept, i); !label.empty()) {
      ++pixels[label];
    }
  }
  std::vector<LabelShare> shares;
  for (const auto& [label, count] : pixels) {
    shares.push_back({std::string(label), label_colour(label), count});
  }
  return shares;
}

}  // namespace rigwire::hil
