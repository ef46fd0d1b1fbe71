// An image sensor: from the light on its pixels to numbers, by the linear model of EMVA 1288
// (European Machine Vision Association, "Standard 1288: characterization of image sensors and
// cameras", release 4.0 linear, section 2).
//
//   photons    of a pixel: luminance L of the scene, f-number N, exposure t, pixel area A:
//              illuminance pi L / (4 N^2), and 1.114e16 photons of 400 .. 700 nm per second, m2 and
//              lux of daylight (18.5 umol/s per klx: R. W. Thimijan, R. D. Heins, HortScience
//              18(6), 1983)
//   electrons  Poisson(eta mu_p (1 + PRNU)) + Poisson((dark current + DSNU) t), shared by each
//              pixel's own PRNU and DSNU, and a read noise of sigma_d
//   charge     no more than the full well
//   number     y = K e + black level, to the nearest whole number, cut off at both ends; K so that
//              the saturation capacity fills the range at 0 dB
// A colour sensor has a Bayer mosaic RGGB; each filter passes one band of the scene, a third of the
// photons of white light.
//
// Poisson numbers are exact below 12 electrons, above normal ones of the same mean and variance
// (the third moment is lost: skewness below 0.29). Random numbers depend on (seed, name, frame,
// pixel) alone: the same picture whatever is computed first. Photon transfer curve from flat
// frames: gain, read noise and saturation come back within 3 % (tested).
//
// Defaults: size and pixels of onsemi's PYTHON 300 as Basler acA640-750 reads it out (640 x 480 of
// 4.8 um, global shutter; docs.baslerweb.com); the figures after EMVA 1288 are of the order that
// makers of such industrial cameras publish, of no one camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

struct ImageSensorParameters {
  int width_px = 640;
  int height_px = 480;
  double pixel_pitch_m = 4.8e-6;
  bool colour = false;                   ///< A Bayer mosaic in front of it, first pixel red.
  double quantum_efficiency = 0.60;      ///< Behind the filter, if any, mean of 400 .. 700 nm.
  double saturation_capacity = 10000.0;  ///< Electrons that fill the range of numbers at 0 dB.
  double full_well = 12000.0;            ///< Electrons that a pixel holds.
  double read_noise = 5.0;               ///< Electrons rms, with the converter's.
  double dark_current = 5.0;             ///< Electrons per second.
  double photo_response_nonuniformity = 0.006;  ///< PRNU, rms share.
  double dark_signal_nonuniformity = 3.0;       ///< DSNU, electrons per second rms.
  /// Pixels that are always dark, always bright; and columns without signal.
  int dead_pixels = 0;
  int hot_pixels = 0;
  int dead_columns = 0;
  /// Between the starts of two neighbouring rows; 0: all rows at once (global shutter).
  Duration row_time{0};

  // Dirt on the front glass, out of focus: soft blobs that hold light back and are bright
  // themselves by the light that falls on them.
  int dirt_blobs = 0;
  double dirt_radius = 0.04;  ///< Mean, as share of the picture's width.
  double dirt_opacity = 0.6;  ///< In a blob's middle.
};
void visit(fields::Visitor& v, ImageSensorParameters& p);

/// Visit the size or all other keys, for cameras whose pictures have a size of their own.
void visit_size(fields::Visitor& v, ImageSensorParameters& p);
void visit_figures(fields::Visitor& v, ImageSensorParameters& p);
/// What the width or the height of a picture may be, of any kind of camera.
inline constexpr fields::IntegerRule kPictureSide{2, 16384};

/// Throws std::invalid_argument naming the key, the value found and what is allowed.
void validate(const ImageSensorParameters& parameters);

/// A rectangle of sensor pixels.
struct PixelRectangle {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  friend bool operator==(const PixelRectangle&, const PixelRectangle&) = default;
};

/// How one exposure is taken and read out.
struct ReadOut {
  std::uint64_t frame = 0;  ///< Draws the noise: another number, other noise.
  PixelRectangle region;    ///< In sensor pixels, a multiple of the binning.
  int binning_x = 1;        ///< Charges of so many pixels are added up.
  int binning_y = 1;
  Duration exposure{};
  double gain_db = 0.0;
  double black_level = 0.0;  ///< In numbers of 8 bits.
  int bits = 8;              ///< 8, 10 or 12.
};

/// Throws std::invalid_argument naming what does not fit the sensor or itself: a region off the
/// sensor or no multiple of the binning, binning of a colour sensor, bits, exposure, gain.
void validate(const ReadOut& read_out, const ImageSensorParameters& sensor);

class ImageSensor {
 public:
  /// Throws std::invalid_argument as validate() does. The fixed pattern, dead pixels and dirt
  /// depend on (seed, name) alone.
  ImageSensor(const ImageSensorParameters& parameters, double f_number, std::uint64_t seed,
              std::string_view name);

  /// `luminance`: of each pixel of the region after binning, row by row, three bands (red, green,
  /// blue), cd/m2, as it would be seen on the lens's axis. `falloff`: share of it that the lens
  /// lets through to each pixel of the sensor. `haze_cd`: luminance of a white sheet in the scene's
  /// light, by band, for dirt. Writes one number for each pixel. A luminance that is not a number
  /// counts as 0. Rows from `first_row` up to before `end_row` of the region after binning; the
  /// spans are of the whole region. May run on many threads, for different rows. Does not allocate.
  void expose(std::span<const float> luminance, std::span<const float> falloff,
              std::span<const float, 3> haze_cd, const ReadOut& read_out, int first_row,
              int end_row, std::span<std::uint16_t> numbers) const;

  /// Electrons of one pixel on the axis by light of that luminance in its band.
  [[nodiscard]] double electrons(double luminance_cd, Duration exposure) const;
  /// Luminance on the axis, in each band, that fills the range of numbers.
  [[nodiscard]] double full_luminance_cd(const ReadOut& read_out) const;
  /// Numbers per electron (EMVA's K).
  [[nodiscard]] double numbers_per_electron(double gain_db, int bits) const;
  [[nodiscard]] const ImageSensorParameters& parameters() const { return parameters_; }
  /// 0 red, 1 green, 2 blue; of a grey sensor 1.
  [[nodiscard]] static int bayer_band(int x, int y) { return (x & 1) + (y & 1); }

 private:
  struct Exposure;
  void charge(std::span<const float> luminance, std::span<const float> falloff,
              std::span<const float, 3> haze_cd, const ReadOut& read_out, const Exposure& exposure,
              int row, std::size_t first, std::span<float> signal) const;
  void lay_dirt(std::uint64_t seed, std::string_view name);

  ImageSensorParameters parameters_;
  double electrons_per_cd_s_;
  std::uint64_t shot_key_;
  // The fixed pattern: a pixel's signal as share of what it should be, and electrons per second in
  // the dark.
  std::vector<float> response_;
  std::vector<float> dark_;
  std::vector<float> clear_;  ///< Share of the light that dirt lets through; empty: no dirt.
};

/// Mean of the numbers of a picture, share of full scale, black level taken off; not below 0.
[[nodiscard]] double mean_share(std::span<const std::uint16_t> numbers, const ReadOut& read_out);

/// Packs numbers as a camera sends them: one byte each for 8 bits, else two, the least significant
/// first. Resizes `bytes`.
void pack_numbers(std::span<const std::uint16_t> numbers, int bits,
                  std::vector<std::uint8_t>& bytes);

/// Exposure and gain chosen from the pictures before, as cameras do it: a picture's mean is
/// compared with the target, the change acts some pictures later, and between dead bands nothing
/// moves. Exposure first, gain when exposure is at its end.
struct AutoExposureParameters {
  double target = 0.28;     ///< Mean of the picture, share of full scale.
  double dead_band = 0.10;  ///< Relative error that is left alone.
  /// Share of the error, in stops, that is left after one step. Basler's cameras take off 0.68 of
  /// it as they are delivered (docs.baslerweb.com, Gray Value Adjustment Damping: 0.6836).
  double damping = 0.32;
  int lag = 2;  ///< Pictures between one that is measured and the first that differs.
  Duration shortest = std::chrono::microseconds{20};
  Duration longest = std::chrono::milliseconds{30};
  double greatest_gain_db = 18.0;
};
void visit(fields::Visitor& v, AutoExposureParameters& p);
void validate(const AutoExposureParameters& parameters);

class AutoExposure {
 public:
  struct Choice {
    Duration exposure{};
    double gain_db = 0.0;

    friend bool operator==(const Choice&, const Choice&) = default;
  };

  /// Throws std::invalid_argument as validate() does.
  AutoExposure(const AutoExposureParameters& parameters, const Choice& start);

  /// Returns the choice for the next picture, or for the one `ahead` pictures later; `ahead` is
  /// less than the lag.
  [[nodiscard]] const Choice& next(std::size_t ahead = 0) const { return queue_.at(ahead); }
  [[nodiscard]] std::size_t known() const { return queue_.size(); }
  /// Notes that a picture was taken with next() and not measured.
  void unmeasured();
  /// Notes that a picture was taken with next() and had this mean, share of full scale (black level
  /// taken off). `exposure_free`, `gain_free`: what may be changed; the other stays as in `fixed`.
  void taken(double mean, bool exposure_free, bool gain_free, const Choice& fixed);

 private:
  AutoExposureParameters parameters_;
  std::vector<Choice> queue_;  ///< Choices for the next `lag` pictures, in order.
};

}  // namespace rigwire::sim
