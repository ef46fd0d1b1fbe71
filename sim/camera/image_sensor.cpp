#include "sim/camera/image_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"
#include "sim/lidar/counter_noise.h"
#include "sim/lidar/ray_lanes.h"
#include "sim/random.h"

namespace rigwire::sim {

using fields::in;
using fields::IntegerRule;
using fields::plain;

namespace {

/// Photons of daylight, 400 .. 700 nm, per second, m2 and lux.
constexpr double kPhotonsPerLuxSecond = 1.114e16;
constexpr float kExactBelow = 12.0F;
/// Pixels that are worked on together.
constexpr std::size_t kBatch = 64;
constexpr float kHotNumber_e = 1e9F;

/// A Poisson number of that mean from one uniform, the distribution inverted term by term; for
/// means below kExactBelow.
float poisson(float mean, double uniform) {
  auto probability = std::exp(-static_cast<double>(mean));
  double sum = probability;
  int count = 0;
  while (uniform > sum && count < 80) {
    ++count;
    probability *= static_cast<double>(mean) / count;
    sum += probability;
  }
  return static_cast<float>(count);
}

std::uint64_t key_of(std::uint64_t seed, std::string_view name, std::string_view what) {
  return RandomStream(seed, std::string(name) + "/" + std::string(what)).bits();
}

}  // namespace

void visit(fields::Visitor& v, ImageSensorParameters& p) {
  visit_size(v, p);
  visit_figures(v, p);
}

void visit_size(fields::Visitor& v, ImageSensorParameters& p) {
  v.integer("width", p.width_px, kPictureSide, "Pixels in a row.");
  v.integer("height", p.height_px, kPictureSide, "Rows.");
}

void visit_figures(fields::Visitor& v, ImageSensorParameters& p) {
  v.number("pixel_pitch", p.pixel_pitch_m, in("um").between(0.5, 100), "Edge of a pixel.");
  v.boolean("colour", p.colour, "Bayer mosaic RGGB in front of the sensor.");
  v.number("quantum_efficiency", p.quantum_efficiency, in("%").above(0).at_most(100),
           "Electrons per photon, mean over 400 to 700 nm.");
  v.number("saturation_capacity", p.saturation_capacity, plain().between(100, 1e7),
           "Electrons that fill the range of numbers at 0 dB.");
  v.number("full_well", p.full_well, plain().between(100, 1e7), "Electrons that a pixel holds.");
  v.number("read_noise", p.read_noise, plain().between(0, 1000), "Electrons rms in the dark.");
  v.number("dark_current", p.dark_current, plain().between(0, 1e6), "Electrons per second.");
  v.number("photo_response_nonuniformity", p.photo_response_nonuniformity, in("%").between(0, 20),
           "PRNU: rms difference of the pixels' response.");
  v.number("dark_signal_nonuniformity", p.dark_signal_nonuniformity, plain().between(0, 1e6),
           "DSNU: rms difference of the dark signal, electrons per second.");
  v.integer("dead_pixels", p.dead_pixels, IntegerRule{0, 100000}, "Pixels that stay dark.");
  v.integer("hot_pixels", p.hot_pixels, IntegerRule{0, 100000}, "Pixels that stay bright.");
  v.integer("dead_columns", p.dead_columns, IntegerRule{0, 1000}, "Columns without signal.");
  v.duration("row_time", p.row_time, {0, 10'000'000},
             "Between the starts of two rows; 0 = global shutter.");
  v.integer("dirt_blobs", p.dirt_blobs, IntegerRule{0, 1000}, "Spots of dirt on the glass.");
  v.number("dirt_radius", p.dirt_radius, plain().between(0.001, 0.5),
           "Mean radius of a spot, share of the picture's width.");
  v.number("dirt_opacity", p.dirt_opacity, in("%").between(0, 100),
           "Light that the middle of a spot holds back.");
}

void validate(const ImageSensorParameters& p) {
  fields::check(p);
  fields::require(p.full_well >= p.saturation_capacity, "full_well", plain().print(p.full_well),
                  "at least saturation_capacity, " + plain().print(p.saturation_capacity));
  fields::require(p.dead_columns < p.width_px, "dead_columns", std::to_string(p.dead_columns),
                  "fewer than the width, " + std::to_string(p.width_px));
}

void validate(const ReadOut& r, const ImageSensorParameters& sensor) {
  const auto require = [](bool holds, const char* what, const std::string& found,
                          const std::string& allowed) {
    if (!holds) {
      throw std::invalid_argument(std::string("read-out: ") + what + ": found " + found +
                                  ", allowed " + allowed);
    }
  };
  require(r.bits == 8 || r.bits == 10 || r.bits == 12, "bits", std::to_string(r.bits),
          "8, 10 or 12");
  require(r.binning_x >= 1 && r.binning_x <= 16 && r.binning_y >= 1 && r.binning_y <= 16, "binning",
          std::to_string(r.binning_x) + " x " + std::to_string(r.binning_y), "1 .. 16 each");
  require(!sensor.colour || (r.binning_x == 1 && r.binning_y == 1), "binning",
          std::to_string(r.binning_x) + " x " + std::to_string(r.binning_y),
          "1 x 1 behind a Bayer mosaic");
  const PixelRectangle& g = r.region;
  const std::string region = std::to_string(g.width) + " x " + std::to_string(g.height) + " at " +
                             std::to_string(g.x) + ", " + std::to_string(g.y);
  require(g.x >= 0 && g.y >= 0 && g.width > 0 && g.height > 0 && g.width <= sensor.width_px &&
              g.height <= sensor.height_px && g.x <= sensor.width_px - g.width &&
              g.y <= sensor.height_px - g.height,
          "region", region,
          "within " + std::to_string(sensor.width_px) + " x " + std::to_string(sensor.height_px));
  require(g.width % r.binning_x == 0 && g.height % r.binning_y == 0, "region", region,
          "multiples of the binning");
  require(r.exposure > Duration{0} && r.exposure <= std::chrono::seconds{10}, "exposure",
          fields::print_duration(r.exposure.count()), "above 0 up to 10 s");
  require(r.gain_db >= -20.0 && r.gain_db <= 60.0, "gain", std::to_string(r.gain_db),
          "-20 .. 60 dB");
  require(r.black_level >= 0.0 && r.black_level <= 255.0, "black level",
          std::to_string(r.black_level), "0 .. 255");
}

ImageSensor::ImageSensor(const ImageSensorParameters& parameters, double f_number,
                         std::uint64_t seed, std::string_view name)
    : parameters_(parameters) {
  validate(parameters);
  if (!(f_number > 0.0) || !std::isfinite(f_number)) {
    throw std::invalid_argument("image sensor: found f-number " + std::to_string(f_number) +
                                ", allowed is a positive one");
  }
  // Illuminance behind the lens pi L / (4 N^2), photons, then electrons. Behind a filter a third.
  const double area_m2 = parameters.pixel_pitch_m * parameters.pixel_pitch_m;
  electrons_per_cd_s_ = 0.25 * std::numbers::pi / (f_number * f_number) * kPhotonsPerLuxSecond *
                        area_m2 * parameters.quantum_efficiency *
                        (parameters.colour ? 1.0 / 3.0 : 1.0);
  shot_key_ = key_of(seed, name, "shot");
  const auto count = static_cast<std::size_t>(parameters.width_px) *
                     static_cast<std::size_t>(parameters.height_px);
  response_.resize(count);
  dark_.resize(count);
  RandomStream random(seed, std::string(name) + "/pattern");
  for (std::size_t i = 0; i < count; ++i) {
    response_[i] = static_cast<float>(
        std::max(0.0, 1.0 + parameters.photo_response_nonuniformity * random.gaussian()));
    dark_[i] = static_cast<float>(std::max(
        0.0, parameters.dark_current + parameters.dark_signal_nonuniformity * random.gaussian()));
  }
  const auto set = [this](std::size_t pixel, float response, float dark) {
    response_[pixel] = response;
    dark_[pixel] = dark;
  };
  const auto any_pixel = [&] {
    return std::min(count - 1,
                    static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
  };
  for (int i = 0; i < parameters.dead_pixels; ++i) {
    set(any_pixel(), 0.0F, 0.0F);
  }
  for (int i = 0; i < parameters.hot_pixels; ++i) {
    set(any_pixel(), 1.0F, kHotNumber_e);
  }
  for (int i = 0; i < parameters.dead_columns; ++i) {
    const auto width = static_cast<std::size_t>(parameters.width_px);
    for (std::size_t at = any_pixel() % width; at < count; at += width) {
      set(at, 0.0F, 0.0F);
    }
  }
  if (parameters.dirt_blobs > 0) {
    lay_dirt(seed, name);
  }
}

void ImageSensor::lay_dirt(std::uint64_t seed, std::string_view name) {
  const ImageSensorParameters& p = parameters_;
  clear_.assign(response_.size(), 1.0F);
  RandomStream random(seed, std::string(name) + "/dirt");
  for (int i = 0; i < p.dirt_blobs; ++i) {
    const double x = random.uniform() * p.width_px;
    const double y = random.uniform() * p.height_px;
    // Radii are spread by half of their mean either way, opacities down to a third.
    const double radius = p.dirt_radius * p.width_px * random.uniform(0.5, 1.5);
    const double opacity = p.dirt_opacity * random.uniform(0.33, 1.0);
    const int first_y = std::max(0, static_cast<int>(y - radius));
    const int last_y = std::min(p.height_px - 1, static_cast<int>(y + radius) + 1);
    const int first_x = std::max(0, static_cast<int>(x - radius));
    const int last_x = std::min(p.width_px - 1, static_cast<int>(x + radius) + 1);
    for (int row = first_y; row <= last_y; ++row) {
      for (int column = first_x; column <= last_x; ++column) {
        // (1 - d^2)^2: flat in the middle and at the edge, as a disc out of focus is.
        const double d2 = ((column - x) * (column - x) + (row - y) * (row - y)) / (radius * radius);
        if (d2 < 1.0) {
          clear_[static_cast<std::size_t>(row) * static_cast<std::size_t>(p.width_px) +
                 static_cast<std::size_t>(column)] *=
              static_cast<float>(1.0 - opacity * (1.0 - d2) * (1.0 - d2));
        }
      }
    }
  }
}

double ImageSensor::electrons(double luminance_cd, Duration exposure) const {
  return electrons_per_cd_s_ * luminance_cd * to_seconds(exposure);
}

double ImageSensor::full_luminance_cd(const ReadOut& r) const {
  const double charges = static_cast<double>(r.binning_x) * r.binning_y;
  return parameters_.saturation_capacity / std::pow(10.0, r.gain_db / 20.0) /
         (charges * electrons(1.0, r.exposure));
}

double ImageSensor::numbers_per_electron(double gain_db, int bits) const {
  return ((1 << bits) - 1) / parameters_.saturation_capacity * std::pow(10.0, gain_db / 20.0);
}

/// An exposure in the sensor's own units.
struct ImageSensor::Exposure {
  Exposure(const ImageSensorParameters& p, const ReadOut& r, double electrons_per_cd_s)
      : exposure_s(static_cast<float>(to_seconds(r.exposure))),
        per_cd(static_cast<float>(electrons_per_cd_s) * exposure_s),
        full_well(static_cast<float>(p.full_well * r.binning_x * r.binning_y)),
        read_variance(static_cast<float>(p.read_noise * p.read_noise * r.binning_x * r.binning_y)),
        white(static_cast<float>((1 << r.bits) - 1)),
        black(static_cast<float>(r.black_level * (1 << (r.bits - 8)))) {}

  float exposure_s;
  float per_cd;
  float full_well;
  float read_variance;
  float white;
  float black;
};

namespace {

/// What grey pixels see: a third of each band.
RIGWIRE_WIDE_VECTORS void take_mean(const float* light, std::size_t count, float* seen) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    seen[i] = (light[3 * i] + light[3 * i + 1] + light[3 * i + 2]) * (1.0F / 3.0F);
  }
}

/// What pixels see behind a Bayer mosaic, from column `first_x` of row `y` on.
RIGWIRE_WIDE_VECTORS void take_mosaic(const float* light, std::size_t count, int first_x, int y,
                                      float* seen) {
  const int below = y & 1;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const int across = (first_x + static_cast<int>(i)) & 1;
    const float even = below == 0 ? light[3 * i] : light[3 * i + 1];
    const float odd = below == 0 ? light[3 * i + 1] : light[3 * i + 2];
    seen[i] = choose(across != 0, odd, even);
  }
}

/// Electrons of single pixels.
RIGWIRE_WIDE_VECTORS void fill_wells(const float* seen, const float* falloff, const float* response,
                                     const float* dark, std::size_t count, float per_cd,
                                     float exposure_s, float* signal) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    signal[i] = per_cd * seen[i] * falloff[i] * response[i] + dark[i] * exposure_s;
  }
}

/// Adds shot and read noise together; what exceeds the full well is lost before it is read. Returns
/// the minimum of the signals, at most kExactBelow.
RIGWIRE_WIDE_VECTORS float count_up(const float* signal, const float* normal, std::size_t count,
                                    float read_variance, float full_well, float* electrons) {
  float least = kExactBelow;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const float shot = signal[i] + std::sqrt(signal[i] + read_variance) * normal[i];
    electrons[i] = shot < full_well ? shot : full_well;
    least = signal[i] < least ? signal[i] : least;
  }
  return least;
}

RIGWIRE_WIDE_VECTORS void convert(const float* electrons, std::size_t count, float gain,
                                  float black, float white, std::uint16_t* numbers) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    float number = electrons[i] * gain + black;
    number = number < white ? number : white;
    number = number > 0.0F ? number : 0.0F;
    number += 0.5F;
    numbers[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(number));
  }
}

}  // namespace

/// Mean electrons of pixels of one row after binning, from column `first` on.
void ImageSensor::charge(std::span<const float> luminance, std::span<const float> falloff,
                         std::span<const float, 3> haze_cd, const ReadOut& r,
                         const Exposure& exposure, int row, std::size_t first,
                         std::span<float> signal) const {
  const ImageSensorParameters& p = parameters_;
  const std::size_t count = signal.size();
  const auto sensor_width = static_cast<std::size_t>(p.width_px);
  const float* const light =
      luminance.data() +
      3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(r.region.width / r.binning_x) +
           first);
  const int x0 = r.region.x + static_cast<int>(first) * r.binning_x;
  const int y0 = r.region.y + row * r.binning_y;
  std::array<float, kBatch> seen;
  if (p.colour) {
    take_mosaic(light, count, x0, y0, seen.data());
  } else {
    take_mean(light, count, seen.data());
  }
  const auto through = [&](std::size_t i, std::size_t at) {
    // Dirt shows the light of the scene around it, half as bright as a white sheet.
    const int band = bayer_band(x0 + static_cast<int>(i), y0);
    const float haze = p.colour ? haze_cd[static_cast<std::size_t>(band)]
                                : (haze_cd[0] + haze_cd[1] + haze_cd[2]) * (1.0F / 3.0F);
    return clear_[at] * seen[i] + (1.0F - clear_[at]) * 0.5F * haze;
  };
  const std::size_t corner =
      static_cast<std::size_t>(y0) * sensor_width + static_cast<std::size_t>(x0);
  if (r.binning_x == 1 && r.binning_y == 1) {
    for (std::size_t i = 0; !clear_.empty() && i < count; ++i) {
      seen[i] = through(i, corner + i);
    }
    fill_wells(seen.data(), falloff.data() + corner, response_.data() + corner,
               dark_.data() + corner, count, exposure.per_cd, exposure.exposure_s, signal.data());
  } else {
    // Charges of the pixels are added up.
    for (std::size_t i = 0; i < count; ++i) {
      signal[i] = 0.0F;
      for (int dy = 0; dy < r.binning_y; ++dy) {
        for (int dx = 0; dx < r.binning_x; ++dx) {
          const std::size_t at = corner + static_cast<std::size_t>(dy) * sensor_width +
                                 i * static_cast<std::size_t>(r.binning_x) +
                                 static_cast<std::size_t>(dx);
          signal[i] += exposure.per_cd * (clear_.empty() ? seen[i] : through(i, at)) * falloff[at] *
                           response_[at] +
                       dark_[at] * exposure.exposure_s;
        }
      }
    }
  }
  for (float& electrons : signal) {
    // NaN counts as 0.
    electrons = electrons > 0.0F ? std::min(electrons, 4.0F * exposure.full_well) : 0.0F;
  }
}

void ImageSensor::expose(std::span<const float> luminance, std::span<const float> falloff,
                         std::span<const float, 3> haze_cd, const ReadOut& r, int first_row,
                         int end_row, std::span<std::uint16_t> numbers) const {
  const Exposure exposure(parameters_, r, electrons_per_cd_s_);
  const auto gain = static_cast<float>(numbers_per_electron(r.gain_db, r.bits));
  const std::uint64_t key = counter_bits(shot_key_, r.frame);
  const std::uint64_t second_key = counter_bits(key, 0);
  const auto width = static_cast<std::size_t>(r.region.width / r.binning_x);

  std::array<float, kBatch> signal;
  std::array<float, kBatch> normal;
  std::array<float, kBatch> electrons;
  std::array<std::uint64_t, kBatch> counter;
  for (int row = first_row; row < end_row; ++row) {
    for (std::size_t begin = 0; begin < width; begin += kBatch) {
      const std::size_t count = std::min(kBatch, width - begin);
      charge(luminance, falloff, haze_cd, r, exposure, row, begin, std::span(signal).first(count));
      const int y = r.region.y + row * r.binning_y;
      const auto y0 = static_cast<std::uint64_t>(y);
      for (std::size_t i = 0; i < count; ++i) {
        counter[i] = y0 << 32U | static_cast<std::uint32_t>(
                                     r.region.x + static_cast<int>(begin + i) * r.binning_x);
      }
      gaussian(key, std::span(counter).first(count), std::span(normal).first(count));
      const float least = count_up(signal.data(), normal.data(), count, exposure.read_variance,
                                   exposure.full_well, electrons.data());
      for (std::size_t i = 0; least < kExactBelow && i < count; ++i) {
        if (signal[i] < kExactBelow) {
          electrons[i] = poisson(signal[i], counter_uniform(second_key, counter[i])) +
                         std::sqrt(exposure.read_variance) * normal[i];
        }
      }
      convert(electrons.data(), count, gain, exposure.black, exposure.white,
              numbers.data() + static_cast<std::size_t>(row) * width + begin);
    }
  }
}

double mean_share(std::span<const std::uint16_t> numbers, const ReadOut& r) {
  const auto sum = std::accumulate(numbers.begin(), numbers.end(), std::uint64_t{0});
  const double black = r.black_level * (1 << (r.bits - 8));
  return std::max(0.0, static_cast<double>(sum) / static_cast<double>(numbers.size()) - black) /
         ((1 << r.bits) - 1);
}

void pack_numbers(std::span<const std::uint16_t> numbers, int bits,
                  std::vector<std::uint8_t>& bytes) {
  if (bits == 8) {
    bytes.resize(numbers.size());
    std::ranges::transform(numbers, bytes.begin(),
                           [](std::uint16_t number) { return static_cast<std::uint8_t>(number); });
    return;
  }
  bytes.resize(2 * numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    bytes[2 * i] = static_cast<std::uint8_t>(numbers[i] & 0xFFU);
    bytes[2 * i + 1] = static_cast<std::uint8_t>(numbers[i] >> 8U);
  }
}

void visit(fields::Visitor& v, AutoExposureParameters& p) {
  v.number("target", p.target, in("%").between(1, 90), "Mean of the picture, of full scale.");
  v.number("dead_band", p.dead_band, in("%").between(0, 100), "Relative error that is left alone.");
  v.number("damping", p.damping, plain().between(0, 0.95),
           "Share of the error in stops that one step leaves.");
  v.integer("lag", p.lag, IntegerRule{1, 16},
            "Pictures from one that is measured to the first that differs.");
  v.duration("shortest", p.shortest, {1'000, 1'000'000'000}, "Shortest exposure.");
  v.duration("longest", p.longest, {1'000, 1'000'000'000}, "Longest exposure.");
  v.number("greatest_gain", p.greatest_gain_db, in("dB").between(0, 48), "Greatest gain.");
}

void validate(const AutoExposureParameters& p) {
  fields::check(p);
  fields::require(p.shortest <= p.longest, "shortest", fields::print_duration(p.shortest.count()),
                  "up to longest, " + fields::print_duration(p.longest.count()));
}

AutoExposure::AutoExposure(const AutoExposureParameters& parameters, const Choice& start)
    : parameters_(parameters) {
  validate(parameters);
  queue_.assign(static_cast<std::size_t>(parameters.lag), start);
}

void AutoExposure::unmeasured() {
  queue_.push_back(queue_.back());
  queue_.erase(queue_.begin());
}

void AutoExposure::taken(double mean, bool exposure_free, bool gain_free, const Choice& fixed) {
  const AutoExposureParameters& p = parameters_;
  const Choice measured = queue_.front();
  Choice chosen = queue_.back();
  // Ratio of the light that the picture would have needed to what it got, within 1/4 .. 4.
  const double error = std::clamp(p.target / std::max(mean, 1e-3), 0.25, 4.0);
  if (std::abs(error - 1.0) > p.dead_band) {
    const double wanted = to_seconds(measured.exposure) * std::pow(10.0, measured.gain_db / 20.0) *
                          std::pow(error, 1.0 - p.damping);
    const auto gain_for = [&](double exposure_s) {
      return std::clamp(20.0 * std::log10(wanted / exposure_s), 0.0, p.greatest_gain_db);
    };
    if (exposure_free) {
      const double at_gain = gain_free ? 1.0 : std::pow(10.0, fixed.gain_db / 20.0);
      chosen.exposure = std::clamp(from_seconds(wanted / at_gain), p.shortest, p.longest);
    }
    if (gain_free) {
      chosen.gain_db = gain_for(to_seconds(exposure_free ? chosen.exposure : fixed.exposure));
    }
  }
  if (!exposure_free) {
    chosen.exposure = fixed.exposure;
  }
  if (!gain_free) {
    chosen.gain_db = fixed.gain_db;
  }
  queue_.erase(queue_.begin());
  queue_.push_back(chosen);
}

}  // namespace rigwire::sim
