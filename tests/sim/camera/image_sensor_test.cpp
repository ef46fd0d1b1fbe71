#include "sim/camera/image_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

ImageSensorParameters plain_sensor() {
  ImageSensorParameters p;
  p.width_px = 256;
  p.height_px = 192;
  p.photo_response_nonuniformity = 0.0;
  p.dark_signal_nonuniformity = 0.0;
  return p;
}

ReadOut whole(const ImageSensorParameters& p, Duration exposure, std::uint64_t frame = 0,
              int bits = 12) {
  ReadOut r;
  r.frame = frame;
  r.region = {0, 0, p.width_px, p.height_px};
  r.exposure = exposure;
  r.bits = bits;
  return r;
}

/// A sensor in even light.
struct Flat {
  explicit Flat(const ImageSensorParameters& p) : sensor(p, 2.8, 7, "camera") {
    pixels = static_cast<std::size_t>(p.width_px) * static_cast<std::size_t>(p.height_px);
    falloff.assign(pixels, 1.0F);
    numbers.resize(pixels);
  }
  const std::vector<std::uint16_t>& take(double luminance_cd, const ReadOut& r) {
    light.assign(3 * pixels, static_cast<float>(luminance_cd));
    constexpr std::array<float, 3> kHaze{0.0F, 0.0F, 0.0F};
    numbers.assign(pixels, 0);
    sensor.expose(light, falloff, kHaze, r, 0, r.region.height / r.binning_y, numbers);
    return numbers;
  }
  ImageSensor sensor;
  std::size_t pixels = 0;
  std::vector<float> light, falloff;
  std::vector<std::uint16_t> numbers;
};

double mean_of(const std::vector<std::uint16_t>& numbers) {
  double sum = 0.0;
  for (const std::uint16_t number : numbers) {
    sum += number;
  }
  return sum / static_cast<double>(numbers.size());
}

/// EMVA 1288: temporal variance from the difference of two frames.
double temporal_variance(const std::vector<std::uint16_t>& a, const std::vector<std::uint16_t>& b) {
  const double shift = mean_of(a) - mean_of(b);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - static_cast<double>(b[i]);
    sum += d * d;
  }
  return 0.5 * (sum / static_cast<double>(a.size()) - shift * shift);
}

TEST(ImageSensor, PhotonTransferCurveGivesItsFiguresBack) {
  const ImageSensorParameters p = plain_sensor();
  Flat flat(p);
  const double gain = flat.sensor.numbers_per_electron(0.0, 12);
  EXPECT_NEAR(gain, 4095.0 / 10000.0, 1e-12);
  const Duration exposure = 10ms;
  const auto pair = [&](double luminance, std::uint64_t frame, double* mean) {
    ReadOut r = whole(p, exposure, frame);
    r.black_level = 8.0;
    const std::vector<std::uint16_t> a = flat.take(luminance, r);
    r.frame = frame + 1;
    const std::vector<std::uint16_t>& b = flat.take(luminance, r);
    *mean = 0.5 * (mean_of(a) + mean_of(b));
    return temporal_variance(a, b);
  };
  double dark_mean = 0.0;
  const double dark_variance = pair(0.0, 0, &dark_mean);
  EXPECT_NEAR(dark_mean, 8.0 * 16.0 + gain * p.dark_current * 0.01, 0.05);
  // Read noise: dark variance less that of rounding.
  EXPECT_NEAR(std::sqrt(dark_variance - 1.0 / 12.0) / gain, p.read_noise, 0.03 * p.read_noise);
  // Slope of variance over mean up to 70 % of saturation, by least squares through the dark point.
  double xy = 0.0;
  double xx = 0.0;
  for (int step = 1; step <= 14; ++step) {
    const double electrons = 0.05 * step * p.saturation_capacity;
    const double luminance = electrons / flat.sensor.electrons(1.0, exposure);
    double mean = 0.0;
    const double variance = pair(luminance, 10 + 2 * static_cast<std::uint64_t>(step), &mean);
    EXPECT_NEAR((mean - dark_mean) / gain, electrons, 0.002 * electrons + 1.0);
    xy += (mean - dark_mean) * (variance - dark_variance);
    xx += (mean - dark_mean) * (mean - dark_mean);
  }
  EXPECT_NEAR(xy / xx, gain, 0.03 * gain);
  // Saturation: where the numbers end.
  double mean = 0.0;
  const double clipped =
      pair(3.0 * p.saturation_capacity / flat.sensor.electrons(1.0, exposure), 90, &mean);
  EXPECT_EQ(mean, 4095.0);
  EXPECT_EQ(clipped, 0.0);
}

TEST(ImageSensor, FaintLightIsPoissons) {
  ImageSensorParameters p = plain_sensor();
  p.read_noise = 0.0;
  p.dark_current = 0.0;
  p.saturation_capacity = p.full_well = 255.0;  // a number for each electron
  Flat flat(p);
  for (const double electrons : {0.3, 3.0, 9.0, 11.9, 12.1, 30.0}) {
    const auto& numbers =
        flat.take(electrons / flat.sensor.electrons(1.0, 1ms), whole(p, 1ms, 3, 8));
    double sum = 0.0;
    double squares = 0.0;
    for (const std::uint16_t n : numbers) {
      sum += n;
      squares += static_cast<double>(n) * n;
    }
    const auto count = static_cast<double>(numbers.size());
    const double mean = sum / count;
    EXPECT_NEAR(mean, electrons, 5.0 * std::sqrt(electrons / count) + 0.005 * electrons);
    EXPECT_NEAR(squares / count - mean * mean, electrons + (electrons > 12.0 ? 1.0 / 12.0 : 0.0),
                0.03 * electrons);
  }
}

TEST(ImageSensor, FixedPatternHasItsSpread) {
  ImageSensorParameters p = plain_sensor();
  p.photo_response_nonuniformity = 0.01;
  p.dark_signal_nonuniformity = 40.0;
  p.dark_current = 200.0;
  Flat flat(p);
  const auto spatial = [&](double luminance, Duration exposure) {
    std::vector<double> sum(flat.pixels, 0.0);
    constexpr int kFrames = 40;
    for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
      const auto& numbers = flat.take(luminance, whole(p, exposure, frame));
      for (std::size_t i = 0; i < sum.size(); ++i) {
        sum[i] += numbers[i] / static_cast<double>(kFrames);
      }
    }
    double mean = 0.0;
    double squares = 0.0;
    for (const double s : sum) {
      mean += s;
      squares += s * s;
    }
    const auto count = static_cast<double>(sum.size());
    mean /= count;
    // Variance that the mean over the frames keeps of shot and read noise.
    const double gain = flat.sensor.numbers_per_electron(0.0, 12);
    const double left = (gain * mean + gain * gain * 25.0 + 1.0 / 12.0) / kFrames;
    return std::sqrt(squares / count - mean * mean - left);
  };
  const double gain = flat.sensor.numbers_per_electron(0.0, 12);
  EXPECT_NEAR(spatial(5000.0 / flat.sensor.electrons(1.0, 1ms), 1ms) / (5000.0 * gain), 0.01,
              0.0005);
  EXPECT_NEAR(spatial(0.0, 1s) / gain, 40.0, 2.0);
}

TEST(ImageSensor, GainAndBitsAreWhatTheySay) {
  const ImageSensorParameters p = plain_sensor();
  Flat flat(p);
  const double luminance = 1000.0 / flat.sensor.electrons(1.0, 5ms);
  for (const int bits : {8, 10, 12}) {
    ReadOut r = whole(p, 5ms, 1, bits);
    const double at_0 = mean_of(flat.take(luminance, r));
    EXPECT_NEAR(at_0, 0.1 * ((1 << bits) - 1), 0.1 + 0.0005 * (1 << bits));
    r.gain_db = 6.0;
    EXPECT_NEAR(mean_of(flat.take(luminance, r)) / at_0, std::pow(10.0, 0.3), 0.01);
    r.gain_db = 0.0;
    r.black_level = 10.0;
    EXPECT_NEAR(mean_of(flat.take(luminance, r)) - at_0, 10.0 * (1 << (bits - 8)), 0.1);
  }
}

TEST(ImageSensor, DeadAndHotPixelsAndColumnsAreThere) {
  ImageSensorParameters p = plain_sensor();
  p.dead_pixels = 20;
  p.hot_pixels = 30;
  p.dead_columns = 2;
  Flat flat(p);
  const auto& numbers = flat.take(3000.0 / flat.sensor.electrons(1.0, 5ms), whole(p, 5ms));
  int bright = 0;
  int dark = 0;
  std::vector<int> dark_in_column(256, 0);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    bright += numbers[i] == 4095 ? 1 : 0;
    dark += numbers[i] < 100 ? 1 : 0;
    dark_in_column[i % 256] += numbers[i] < 100 ? 1 : 0;
  }
  EXPECT_GE(bright, 27);
  EXPECT_LE(bright, 30);
  EXPECT_GE(dark, 2 * 192 + 15);
  EXPECT_EQ(std::count(dark_in_column.begin(), dark_in_column.end(), 192), 2);
}

TEST(ImageSensor, BinningAddsCharges) {
  const ImageSensorParameters p = plain_sensor();
  Flat flat(p);
  const double luminance = 500.0 / flat.sensor.electrons(1.0, 5ms);
  const double one = mean_of(flat.take(luminance, whole(p, 5ms)));
  ReadOut r = whole(p, 5ms);
  r.binning_x = r.binning_y = 2;
  std::vector<std::uint16_t> numbers = flat.take(luminance, r);
  numbers.resize(flat.pixels / 4);
  EXPECT_NEAR(mean_of(numbers) / one, 4.0, 0.02);
}

TEST(ImageSensor, EachFilterSeesItsBand) {
  ImageSensorParameters p = plain_sensor();
  p.colour = true;
  Flat flat(p);
  flat.light.assign(3 * flat.pixels, 0.0F);
  const auto unit = static_cast<float>(1.0 / flat.sensor.electrons(1.0, 5ms));
  for (std::size_t i = 0; i < flat.pixels; ++i) {
    flat.light[3 * i] = 1000.0F * unit;
    flat.light[3 * i + 1] = 2000.0F * unit;
    flat.light[3 * i + 2] = 4000.0F * unit;
  }
  constexpr std::array<float, 3> kHaze{0.0F, 0.0F, 0.0F};
  flat.sensor.expose(flat.light, flat.falloff, kHaze, whole(p, 5ms), 0, 192, flat.numbers);
  std::array<double, 4> sum{};
  for (std::size_t i = 0; i < flat.pixels; ++i) {
    sum[(i / 256 % 2) * 2 + i % 2] += 4.0 * flat.numbers[i] / static_cast<double>(flat.pixels);
  }
  const double gain = flat.sensor.numbers_per_electron(0.0, 12);
  EXPECT_NEAR(sum[0], 1000.0 * gain, 2.0);
  EXPECT_NEAR(sum[1], 2000.0 * gain, 3.0);
  EXPECT_NEAR(sum[2], 2000.0 * gain, 3.0);
  EXPECT_NEAR(sum[3], 4000.0 * gain, 5.0);
}

TEST(ImageSensor, DirtDarkensAndHazes) {
  ImageSensorParameters p = plain_sensor();
  p.dirt_blobs = 12;
  Flat flat(p);
  const auto unit = static_cast<float>(1.0 / flat.sensor.electrons(1.0, 5ms));
  flat.light.assign(3 * flat.pixels, 6000.0F * unit);
  std::array<float, 3> haze{0.0F, 0.0F, 0.0F};
  flat.sensor.expose(flat.light, flat.falloff, haze, whole(p, 5ms), 0, 192, flat.numbers);
  const auto [darkest, brightest] = std::minmax_element(flat.numbers.begin(), flat.numbers.end());
  EXPECT_LT(*darkest, 0.75 * *brightest);
  // Before a dark scene it shows the light that falls on it.
  flat.light.assign(3 * flat.pixels, 0.0F);
  haze.fill(6000.0F * unit);
  flat.sensor.expose(flat.light, flat.falloff, haze, whole(p, 5ms), 0, 192, flat.numbers);
  const auto [least, most] = std::minmax_element(flat.numbers.begin(), flat.numbers.end());
  EXPECT_LT(*least, 30);
  EXPECT_GT(*most, 300);
}

TEST(ImageSensor, NoiseDoesNotDependOnTheOrderOfRows) {
  const ImageSensorParameters p = plain_sensor();
  Flat flat(p);
  const ReadOut r = whole(p, 5ms, 4);
  const double luminance = 800.0 / flat.sensor.electrons(1.0, 5ms);
  const std::vector<std::uint16_t> once = flat.take(luminance, r);
  constexpr std::array<float, 3> kHaze{0.0F, 0.0F, 0.0F};
  std::vector<std::uint16_t> pieces(flat.pixels);
  for (int row = 190; row >= 0; row -= 2) {
    flat.sensor.expose(flat.light, flat.falloff, kHaze, r, row, row + 2, pieces);
  }
  EXPECT_EQ(once, pieces);
  // A part of the sensor has the noise of its own pixels.
  ReadOut part = r;
  part.region = {32, 16, 64, 48};
  std::vector<std::uint16_t> cut(64 * 48);
  flat.sensor.expose(flat.light, flat.falloff, kHaze, part, 0, 48, cut);
  EXPECT_EQ(cut[5 * 64 + 7], once[(16 + 5) * 256 + 32 + 7]);
  // Another frame, another seed, another name: other noise.
  EXPECT_NE(flat.take(luminance, whole(p, 5ms, 5)), once);
}

TEST(ImageSensor, NumbersLeaveLeastSignificantByteFirst) {
  std::vector<std::uint8_t> bytes;
  const std::vector<std::uint16_t> numbers{0, 255, 0x0ABC};
  pack_numbers(numbers, 12, bytes);
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{0, 0, 255, 0, 0xBC, 0x0A}));
  pack_numbers(std::span(numbers).first(2), 8, bytes);
  EXPECT_EQ(bytes, (std::vector<std::uint8_t>{0, 255}));
}

TEST(ImageSensor, LightThatIsNoNumberIsNone) {
  const ImageSensorParameters p = plain_sensor();
  Flat flat(p);
  const auto& numbers = flat.take(std::numeric_limits<double>::quiet_NaN(), whole(p, 5ms));
  EXPECT_LT(mean_of(numbers), 3.0);
  EXPECT_EQ(mean_of(flat.take(std::numeric_limits<double>::infinity(), whole(p, 5ms))), 4095.0);
}

TEST(ImageSensor, RefusesWhatDoesNotFit) {
  ImageSensorParameters p = plain_sensor();
  const auto refused = [&](auto change) {
    ReadOut r = whole(p, 5ms);
    change(r);
    try {
      validate(r, p);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](ReadOut&) {}), "");
  EXPECT_NE(refused([](ReadOut& r) { r.bits = 9; }).find("bits"), std::string::npos);
  EXPECT_NE(refused([](ReadOut& r) { r.region.width = 257; }).find("region"), std::string::npos);
  EXPECT_NE(refused([](ReadOut& r) { r.region.x = 1; }).find("region"), std::string::npos);
  EXPECT_NE(refused([](ReadOut& r) { r.region.x = std::numeric_limits<int>::max(); }), "");
  EXPECT_NE(refused([](ReadOut& r) { r.binning_x = 3; }).find("binning"), std::string::npos);
  EXPECT_NE(refused([](ReadOut& r) { r.exposure = Duration{0}; }).find("exposure"),
            std::string::npos);
  EXPECT_NE(refused([](ReadOut& r) { r.gain_db = std::numeric_limits<double>::quiet_NaN(); }), "");
  p.colour = true;
  EXPECT_NE(refused([](ReadOut& r) { r.binning_x = 2; }).find("Bayer"), std::string::npos);
  p.full_well = 10.0;
  EXPECT_THROW(validate(p), std::invalid_argument);
  p = plain_sensor();
  p.read_noise = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ImageSensor(p, 2.8, 1, "camera"), std::invalid_argument);
  EXPECT_THROW(ImageSensor(plain_sensor(), 0.0, 1, "camera"), std::invalid_argument);
}

TEST(AutoExposure, ComesToItsTargetWithItsLag) {
  AutoExposureParameters p;
  p.lag = 3;
  AutoExposure choice(p, {.exposure = 1ms, .gain_db = 0.0});
  // A scene whose mean is 0.02 per millisecond at 0 dB.
  const auto mean_of_next = [&] {
    return std::min(1.0, 0.02 * 1e3 * to_seconds(choice.next().exposure) *
                             std::pow(10.0, choice.next().gain_db / 20.0));
  };
  std::vector<double> exposures;
  for (int picture = 0; picture < 40; ++picture) {
    exposures.push_back(1e3 * to_seconds(choice.next().exposure));
    choice.taken(mean_of_next(), true, true, {});
  }
  EXPECT_EQ(exposures[0], 1.0);
  EXPECT_EQ(exposures[2], 1.0);
  EXPECT_GT(exposures[3], 1.5);
  EXPECT_NEAR(mean_of_next(), p.target, p.dead_band * p.target * 1.1);
  // Then it rests.
  EXPECT_EQ(exposures[39], exposures[36]);
}

TEST(AutoExposure, SettlesFromPowerOnWithinTenPicturesAndLaterWithAGreaterLag) {
  // Pictures until the mean stays within the dead band; a scene that saturates 3.5 stops above.
  const auto pictures = [](int lag) {
    AutoExposureParameters p;
    p.lag = lag;
    AutoExposure choice(p, {.exposure = 1ms, .gain_db = 0.0});
    const double needed_s = 88e-6;
    int settled = 0;
    for (int picture = 0; picture < 100; ++picture) {
      const double mean = p.target * to_seconds(choice.next().exposure) / needed_s;
      settled = std::abs(mean - p.target) > 1.05 * p.dead_band * p.target ? picture + 1 : settled;
      choice.taken(std::min(1.0, mean), true, false, {});
    }
    return settled;
  };
  EXPECT_GE(pictures(2), 4);
  EXPECT_LE(pictures(2), 10);
  EXPECT_EQ(pictures(4), 2 * pictures(2));
}

TEST(AutoExposure, TakesGainWhenExposureIsAtItsEnd) {
  AutoExposureParameters p;
  p.longest = 10ms;
  AutoExposure choice(p, {.exposure = 1ms, .gain_db = 0.0});
  for (int picture = 0; picture < 60; ++picture) {
    choice.taken(std::min(1.0, 10.0 * to_seconds(choice.next().exposure) *
                                   std::pow(10.0, choice.next().gain_db / 20.0)),
                 true, true, {});
  }
  EXPECT_EQ(choice.next().exposure, Duration(10ms));
  // The longest exposure alone comes to a mean of 0.1.
  EXPECT_NEAR(choice.next().gain_db, 20.0 * std::log10(p.target / 0.1), 1.0);
  // What the client holds fast stays.
  for (int picture = 0; picture < 10; ++picture) {
    choice.taken(0.9, false, true, {.exposure = 4ms, .gain_db = 0.0});
  }
  EXPECT_EQ(choice.next().exposure, Duration(4ms));
}

TEST(AutoExposure, StaysFiniteInDarknessAndGlare) {
  AutoExposureParameters p;
  AutoExposure choice(p, {.exposure = 1ms, .gain_db = 0.0});
  for (int picture = 0; picture < 100; ++picture) {
    choice.taken(0.0, true, true, {});
  }
  EXPECT_EQ(choice.next().exposure, p.longest);
  EXPECT_EQ(choice.next().gain_db, p.greatest_gain_db);
  for (int picture = 0; picture < 100; ++picture) {
    choice.taken(1.0, true, true, {});
  }
  EXPECT_EQ(choice.next().exposure, p.shortest);
  EXPECT_EQ(choice.next().gain_db, 0.0);
}

}  // namespace
}  // namespace rigwire::sim
