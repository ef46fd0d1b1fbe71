// The statistics of public captures of real sensors, met by the models' own figures. What the
// captures say stands here as numbers with their tolerance; where they are from, in the header.
#include "sim/lidar/velodyne_heads.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "beam_head.h"
#include "sim/lidar/echo_model.h"
#include "sim/lidar/spinning_lidar.h"
#include "sim/weather/scene_weather.h"

namespace rigwire::sim {
namespace {

using beam_test::add_board;
using beam_test::paint;

/// What was measured of one unit.
struct Capture {
  std::string model;
  double rpm;
  Duration firing_period;  ///< Time between the azimuths that were compared.
  double least_noise_m;
  double greatest_noise_m;
  double least_bias_m;  ///< Spread over the lasers.
  double greatest_bias_m;
  double step_sigma_counts;  ///< Spread of the azimuth step from block to block, 0.01 degrees.
  double once_in_a_turn_counts;
  double data_sheet_m;  ///< Accuracy.
};

const std::vector<Capture> kCaptures{
    {"HDL-32E", 542.3, Duration{46'080}, 5.0e-3, 5.5e-3, 7.0e-3, 8.8e-3, 0.59, 3.2, 0.02},
    {"VLP-16", 600.0, Duration{110'592}, 5.6e-3, 6.8e-3, 6.2e-3, 8.0e-3, 0.86, 8.6, 0.03},
    {"VLP-32C", 600.0, Duration{55'296}, 4.5e-3, 5.0e-3, 5.4e-3, 7.0e-3, 0.82, 7.0, 0.03},
    {"VLS-128", 600.0, Duration{55'276}, 9.4e-3, 12.9e-3, 6.4e-3, 8.4e-3, 0.37, 5.7, 0.03},
};

LidarCommand velodyne_heads_turning(double rpm) {
  LidarCommand command;
  command.rotor_rate_radps = rpm / 60.0 * kTurn;
  return command;
}

/// Firings of 32 lasers of the model at a white wall all across, 10 m away, the rotor at rest.
std::vector<LidarFiring> at_a_wall(const std::string& model, int firings, std::uint64_t seed) {
  const SpinningHead head = velodyne_head(model);
  Scene scene;
  add_board(scene, 10.0, -20.0, 20.0, paint(0.9));
  beam_test::Shooter shooter(head.receiver, beam_test::head(std::vector<double>(32, 0.0)), 0.0,
                             false, seed);
  return shooter.shoot(scene, firings);
}

/// Mean of each laser's errors.
std::vector<double> biases_m(const std::vector<LidarFiring>& firings) {
  std::vector<double> mean(32, 0.0);
  for (const LidarFiring& firing : firings) {
    for (std::size_t laser = 0; laser < 32; ++laser) {
      mean[laser] += (static_cast<double>(firing.strongest[laser].range_m) - 10.0) /
                     static_cast<double>(firings.size());
    }
  }
  return mean;
}

double spread(const std::vector<double>& values) {
  double sum = 0.0;
  double squares = 0.0;
  for (const double value : values) {
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<double>(values.size());
  return std::sqrt(squares / count - sum / count * sum / count);
}

TEST(VelodyneHeads, RangeNoiseFromShotToShotIsThatOfTheCaptures) {
  for (const Capture& real : kCaptures) {
    const auto firings = at_a_wall(real.model, 2000, 1);
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 2; i < firings.size(); ++i) {
      for (std::size_t laser = 0; laser < 32; ++laser) {
        const double second = static_cast<double>(firings[i].strongest[laser].range_m) -
                              2.0 * firings[i - 1].strongest[laser].range_m +
                              firings[i - 2].strongest[laser].range_m;
        squares += second * second;
        count += 1.0;
      }
    }
    const double sigma_m = std::sqrt(squares / count / 6.0);
    // sqrt(2 n) with n = 64 000, of which neighbours share shots: 0.6 %.
    EXPECT_GE(sigma_m, 0.98 * real.least_noise_m) << real.model;
    EXPECT_LE(sigma_m, 1.02 * real.greatest_noise_m) << real.model;
  }
}

TEST(VelodyneHeads, LasersHaveBiasesThatStayAndSpreadAsInTheCaptures) {
  for (const Capture& real : kCaptures) {
    std::vector<double> all;
    for (std::uint64_t unit = 1; unit <= 30; ++unit) {
      const auto firings = at_a_wall(real.model, 64, unit);
      const std::vector<double> bias_m = biases_m(firings);
      all.insert(all.end(), bias_m.begin(), bias_m.end());
    }
    // 960 lasers: 2.3 % of the spread at one sigma, on top of what other units would say.
    EXPECT_GE(spread(all), 0.93 * real.least_bias_m) << real.model;
    EXPECT_LE(spread(all), 1.07 * real.greatest_bias_m) << real.model;

    const auto firings = at_a_wall(real.model, 2000, 3);
    const auto half = static_cast<std::ptrdiff_t>(firings.size() / 2);
    const auto first = biases_m({firings.begin(), firings.begin() + half});
    const auto second = biases_m({firings.begin() + half, firings.end()});
    const double sigma_m = real.greatest_noise_m * std::sqrt(2.0 / 1000.0);
    for (std::size_t laser = 0; laser < 32; ++laser) {
      EXPECT_NEAR(first[laser], second[laser], 5.0 * sigma_m) << real.model << ' ' << laser;
    }
    EXPECT_EQ(biases_m(firings), biases_m(at_a_wall(real.model, 2000, 3))) << real.model;
  }
}

TEST(VelodyneHeads, NoiseAndBiasTogetherKeepTheDataSheetsAccuracy) {
  for (const Capture& real : kCaptures) {
    for (std::uint64_t unit = 1; unit <= 30; ++unit) {
      for (const double bias_m : biases_m(at_a_wall(real.model, 400, unit))) {
        EXPECT_LE(std::abs(bias_m), real.data_sheet_m * 1.05) << real.model;
      }
    }
    const SpinningLidarParameters receiver = velodyne_head(real.model).receiver;
    EXPECT_LE(std::hypot(receiver.range_sigma_m, receiver.laser_bias_sigma_m), real.data_sheet_m)
        << real.model;
  }
}

/// Azimuths as sent, in counts, from turn to turn.
std::vector<double> azimuth_counts(const Capture& real, int count, std::uint64_t unit = 1) {
  Rotor rotor(velodyne_heads_turning(real.rpm), velodyne_head(real.model).rotor, unit, "lidar");
  std::vector<double> counts;
  double turns = 0.0;
  for (int i = 1; i <= count; ++i) {
    const double azimuth_rad = rotor.at(kStart + i * real.firing_period).encoder_rad;
    const double reading = std::round(azimuth_rad / kDegree * 100.0);
    if (!counts.empty() && reading + turns < counts.back() - 18'000.0) {
      turns += 36'000.0;
    }
    counts.push_back(reading + turns);
  }
  return counts;
}

TEST(VelodyneHeads, AzimuthStepsAreAsUnevenAsInTheCaptures) {
  for (const Capture& real : kCaptures) {
    const std::vector<double> counts = azimuth_counts(real, 20'000);
    std::vector<double> steps;
    for (std::size_t i = 1; i < counts.size(); ++i) {
      steps.push_back(counts[i] - counts[i - 1]);
    }
    EXPECT_NEAR(spread(steps), real.step_sigma_counts, 0.08 * real.step_sigma_counts) << real.model;
  }
}

TEST(VelodyneHeads, RotorsRunUnevenlyOnceInATurnAsInTheCaptures) {
  for (const Capture& real : kCaptures) {
    // 0.4 s: as long as the captures, before the wander counts.
    const auto count = static_cast<int>(std::chrono::milliseconds{400} / real.firing_period);
    const std::vector<double> counts = azimuth_counts(real, count);
    const auto n = static_cast<double>(counts.size());
    // Straight line by least squares, then the first harmonic of what is left.
    double sx = 0.0;
    double sy = 0.0;
    double sxx = 0.0;
    double sxy = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto x = static_cast<double>(i);
      sx += x;
      sy += counts[i];
      sxx += x * x;
      sxy += x * counts[i];
    }
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    const double offset = (sy - slope * sx) / n;
    double c = 0.0;
    double s = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const double rest = counts[i] - offset - slope * static_cast<double>(i);
      c += 2.0 / n * rest * std::cos(counts[i] / 36'000.0 * kTurn);
      s += 2.0 / n * rest * std::sin(counts[i] / 36'000.0 * kTurn);
    }
    // The line takes some of a harmonic of four turns; the wander adds some.
    EXPECT_NEAR(std::hypot(c, s), real.once_in_a_turn_counts, 0.35 * real.once_in_a_turn_counts)
        << real.model;
  }
}

TEST(VelodyneHeads, UnitsTurnAtSpeedsOfTheirOwnNearTheSetOne) {
  const Capture& vlp = kCaptures[1];
  std::vector<double> rpm;
  for (std::uint64_t unit = 1; unit <= 200; ++unit) {
    const std::vector<double> counts = azimuth_counts(vlp, 3616, unit);
    const double velodyne_heads_seconds =
        to_seconds(vlp.firing_period) * static_cast<double>(counts.size() - 1);
    rpm.push_back((counts.back() - counts.front()) / 36'000.0 / velodyne_heads_seconds * 60.0);
  }
  // The captures' 599.08, 599.95, 600.12 and 599.90 rpm: spread 0.46 of four.
  EXPECT_NEAR(spread(rpm), 0.45, 3.0 * 0.45 / std::sqrt(400.0));
}

/// One laser above level ground of that reflectance.
LidarReturn ground(const std::string& model, double reflectance, double height_m,
                   double elevation_deg, double maximum_m) {
  SpinningHead head = velodyne_head(model);
  head.receiver.range_sigma_m = 0.0;
  head.receiver.laser_bias_sigma_m = 0.0;
  head.receiver.reflectivity_sigma = 0.0;
  head.receiver.laser_reflectivity_sigma = 0.0;
  Scene scene;
  HeightField field;
  field.cell_m = 10.0;
  field.columns = 81;
  field.rows = 81;
  field.origin_m = {-400.0, -400.0};
  field.heights_m.assign(field.columns * field.rows, -height_m);
  scene.add_terrain(field, paint(reflectance));
  LidarPattern pattern = beam_test::head({elevation_deg * kDegree});
  pattern.maximum_range_m = maximum_m;
  return beam_test::Shooter(head.receiver, pattern, 0.0, false).shoot(scene).at(0).strongest[0];
}

TEST(VelodyneHeads, RoadIsSeenAsFarAsInTheCaptures) {
  constexpr double kAsphalt = 0.2;
  // VLS-128: road to 104 m from 2.1 m height, reflectivity bytes 8 to 13 (of 110) from 25 m on.
  for (const double range_m : {25.0, 40.0, 60.0, 80.0, 104.0}) {
    const LidarReturn echo =
        ground("VLS-128", kAsphalt, 2.1, -std::asin(2.1 / range_m) / kDegree, 245.0);
    EXPECT_NEAR(echo.range_m, range_m, 0.1);
    EXPECT_GE(110.0F * echo.reflectivity, 8.0F) << range_m;
    EXPECT_LE(110.0F * echo.reflectivity, 13.0F) << range_m;
  }
  // HDL-32E, 2.6 m high: -5.33 degrees at 28 m in 99 %, -4 degrees at 38 m; nothing beyond 46 m.
  EXPECT_GT(ground("HDL-32E", kAsphalt, 2.6, -5.33, 100.0).range_m, 27.0F);
  EXPECT_GT(ground("HDL-32E", kAsphalt, 2.6, -4.0, 100.0).range_m, 37.0F);
  EXPECT_EQ(ground("HDL-32E", kAsphalt, 2.6, -2.67, 100.0).range_m, 0.0F) << "56 m";
}

TEST(VelodyneHeads, TenPercentTargetsVanishWhereTheDataSheetsAndCapturesSay) {
  const auto sees = [](const std::string& model, double range_m) {
    SpinningHead head = velodyne_head(model);
    head.receiver.range_sigma_m = 0.0;
    head.receiver.laser_bias_sigma_m = 0.0;
    Scene scene;
    add_board(scene, range_m, -20.0, 20.0, paint(0.1));
    LidarPattern pattern = beam_test::head();
    pattern.maximum_range_m = 300.0;
    return beam_test::Shooter(head.receiver, pattern, 0.0, false)
               .shoot(scene)
               .at(0)
               .strongest[0]
               .range_m > 0.0F;
  };
  struct Limit {
    const char* model;
    double range_m;
  };
  for (const Limit& limit :
       {Limit{"HDL-32E", 50.0}, Limit{"VLP-16", 50.0}, Limit{"Puck Hi-Res", 50.0},
        Limit{"VLP-32C", 100.0}, Limit{"HDL-64E S2", 50.0}, Limit{"HDL-64E S3", 50.0},
        Limit{"VLS-128", 220.0}}) {
    EXPECT_TRUE(sees(limit.model, limit.range_m - 0.1)) << limit.model;
    EXPECT_FALSE(sees(limit.model, limit.range_m + 0.1)) << limit.model;
  }
}

TEST(VelodyneHeads, EchoesOfTheAirAreToldAsBeforeTheReceiversBecameMoreSensitive) {
  // The data sheets' ranges, with which docs/weather.md has its figures.
  struct Range {
    const char* model;
    double least_m;
    double greatest_m;
  };
  for (const Range& range :
       {Range{"HDL-32E", 1.0, 100.0}, Range{"VLP-16", 0.5, 100.0}, Range{"Puck Hi-Res", 0.5, 100.0},
        Range{"VLP-32C", 1.0, 200.0}, Range{"HDL-64E S2", 2.0, 120.0},
        Range{"HDL-64E S3", 2.0, 120.0}, Range{"VLS-128", 1.0, 245.0}}) {
    LidarPattern pattern = beam_test::head();
    pattern.minimum_range_m = 0.1;
    const EchoModel model(velodyne_head(range.model).receiver, pattern, 1, "lidar");
    EXPECT_DOUBLE_EQ(model.air_threshold(), 0.9 / (range.greatest_m * range.greatest_m));
    EXPECT_EQ(model.air_minimum_range_m(), range.least_m) << range.model;
  }
}

/// Bytes of the HDL-32E: 100 times the reflectivity, rounded.
int byte_of(const LidarReturn& echo) {
  return static_cast<int>(std::lround(100.0F * echo.reflectivity));
}

/// Firings of 32 lasers of an HDL-32E at a board of that reflectance.
std::vector<LidarFiring> at_a_board(double reflectance, double range_m, int firings,
                                    std::uint64_t seed = 1, int threads = 1, int sub_rays = 0) {
  SpinningHead head = velodyne_head("HDL-32E");
  head.receiver.threads = threads;
  head.receiver.sub_rays = sub_rays;
  Scene scene;
  add_board(scene, range_m, -40.0, 40.0, paint(reflectance));
  beam_test::Shooter shooter(head.receiver, beam_test::head(std::vector<double>(32, 0.0)), 0.0,
                             false, seed);
  return shooter.shoot(scene, firings);
}

TEST(VelodyneHeads, NeighboursOnOneSurfaceDifferInReflectivityAsInTheRecording) {
  // A street by an HDL-32E (open-mmlab/mmdetection3d demo/data/nuscenes): neighbours on one surface
  // by the level of the byte, share that is exactly equal.
  struct Level {
    double reflectance;
    double equal;
  };
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    for (const Level& level : {Level{0.055, 0.62}, Level{0.085, 0.61}, Level{0.125, 0.40},
                               Level{0.175, 0.38}, Level{0.25, 0.31}}) {
      const auto firings = at_a_board(level.reflectance, 8.0, 1000, seed);
      double equal = 0.0;
      for (std::size_t i = 1; i < firings.size(); ++i) {
        for (std::size_t laser = 0; laser < 32; ++laser) {
          equal += byte_of(firings[i].strongest[laser]) == byte_of(firings[i - 1].strongest[laser])
                       ? 1.0
                       : 0.0;
        }
      }
      // Real surfaces are not of one reflectance, and laser by laser the level is a little other.
      EXPECT_NEAR(equal / (32.0 * 999.0), level.equal, 0.15) << level.reflectance;
    }
  }
}

TEST(VelodyneHeads, LasersHaveReflectivitiesOfTheirOwnThatStay) {
  std::vector<double> all;
  const auto means = [](const std::vector<LidarFiring>& firings, std::size_t from, std::size_t to) {
    std::vector<double> mean(32, 0.0);
    for (std::size_t i = from; i < to; ++i) {
      for (std::size_t laser = 0; laser < 32; ++laser) {
        mean[laser] += static_cast<double>(firings[i].strongest[laser].reflectivity) /
                       static_cast<double>(to - from);
      }
    }
    return mean;
  };
  for (std::uint64_t unit = 1; unit <= 20; ++unit) {
    const auto firings = at_a_board(0.4, 10.0, 400, unit);
    const auto first = means(firings, 0, 200);
    const auto second = means(firings, 200, 400);
    for (std::size_t laser = 0; laser < 32; ++laser) {
      all.push_back(first[laser] / 0.4);
      // Noise of 5 % over 200 shots.
      EXPECT_NEAR(first[laser], second[laser], 5.0 * 0.4 * 0.05 * std::sqrt(2.0 / 200.0)) << laser;
    }
  }
  // 640 lasers, cut off at 2.5 sigma; the recording has 11 % of nine lasers.
  EXPECT_NEAR(spread(all), 0.10, 0.012);
  EXPECT_NE(at_a_board(0.4, 10.0, 8, 1)[0].strongest, at_a_board(0.4, 10.0, 8, 2)[0].strongest);
}

TEST(VelodyneHeads, FaintEchoesAreLessExactAsInTheRecording) {
  // Walls of the same recording: sigma by how often the echo is the faintest that is seen.
  struct Bin {
    double signal;
    double sigma_m;
  };
  for (const std::uint64_t seed : {1U, 2U}) {
    for (const Bin& bin : {Bin{1.4, 13.4e-3}, Bin{2.8, 7.3e-3}, Bin{5.6, 6.0e-3}, Bin{11.0, 4.8e-3},
                           Bin{30.0, 4.8e-3}}) {
      // At 40 m the faintest echo has the reflectance 0.9 (40 / 150)^2.
      const double faintest = 0.9 * 40.0 * 40.0 / (150.0 * 150.0);
      if (bin.signal * faintest > 1.0) {
        continue;
      }
      const auto firings = at_a_board(bin.signal * faintest, 40.0, 600, seed);
      double squares = 0.0;
      double count = 0.0;
      for (std::size_t i = 2; i < firings.size(); ++i) {
        const double second = static_cast<double>(firings[i].strongest[7].range_m) -
                              2.0 * firings[i - 1].strongest[7].range_m +
                              firings[i - 2].strongest[7].range_m;
        squares += second * second;
        count += 1.0;
      }
      EXPECT_NEAR(std::sqrt(squares / count / 6.0), bin.sigma_m, 0.25 * bin.sigma_m) << bin.signal;
    }
  }
}

TEST(VelodyneHeads, NoiseOfReflectivityIsTheSameForThreadsAndForBeamsOfOneRay) {
  // Drops of a rate of nothing take the way through the beams.
  const auto alone = at_a_board(0.3, 30.0, 200);
  const auto together = at_a_board(0.3, 30.0, 200, 1, 4);
  ASSERT_EQ(alone.size(), together.size());
  for (std::size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i].strongest, together[i].strongest);
  }
  const SpinningHead head = velodyne_head("HDL-32E");
  Scene scene;
  add_board(scene, 30.0, -40.0, 40.0, paint(0.3));
  SpinningLidarParameters parameters = head.receiver;
  parameters.sub_rays = 1;
  parameters.compensates_incidence = true;  // head on it changes nothing but the way
  beam_test::Shooter shooter(parameters, beam_test::head(std::vector<double>(32, 0.0)), 0.0, false);
  const auto& beams = shooter.shoot(scene, 200);
  for (std::size_t i = 0; i < alone.size(); ++i) {
    for (std::size_t laser = 0; laser < 32; ++laser) {
      EXPECT_NEAR(beams[i].strongest[laser].range_m, alone[i].strongest[laser].range_m, 1e-4F);
      EXPECT_NEAR(beams[i].strongest[laser].reflectivity, alone[i].strongest[laser].reflectivity,
                  1e-4F);
    }
  }
}

TEST(VelodyneHeads, FogLeavesHardTargetsTheStrongest) {
  // Bijelic, Gruber and Ritter, "A benchmark for lidar sensors in fog", IV 2018: lidars of that
  // class see to some 25 m at a visibility of 40 m; near walls stay the strongest echo.
  struct Air {
    double visibility_m;
    double range_m;
    double least_share;  ///< Share of shots whose strongest echo is the wall.
  };
  for (const std::uint64_t seed : {1U, 2U}) {
    for (const Air& air :
         {Air{40.0, 8.0, 0.97}, Air{40.0, 15.0, 0.7}, Air{60.0, 15.0, 0.93}, Air{60.0, 20.0, 0.85},
          Air{200.0, 15.0, 0.999}, Air{200.0, 40.0, 0.99}}) {
      WeatherParameters parameters;
      parameters.course = {{.fog_visibility_m = air.visibility_m}};
      const SceneWeather weather(parameters, 1);
      Scene scene;
      add_board(scene, air.range_m, -40.0, 40.0, paint(0.4));
      beam_test::Shooter shooter(velodyne_head("HDL-32E").receiver,
                                 beam_test::head(std::vector<double>(32, 0.0)), 0.0, false, seed);
      double wall = 0.0;
      double fog = 0.0;
      for (const LidarFiring& firing : shooter.shoot(scene, 400, &weather)) {
        for (std::size_t laser = 0; laser < 32; ++laser) {
          const double range_m = firing.strongest[laser].range_m;
          wall += std::abs(range_m - air.range_m) < 0.2 ? 1.0 : 0.0;
          fog += range_m > 0.0 && range_m < air.range_m - 0.5 ? 1.0 : 0.0;
        }
      }
      EXPECT_GE(wall / 12800.0, air.least_share) << air.visibility_m << ' ' << air.range_m;
      EXPECT_LE(fog / 12800.0, 1.0 - air.least_share) << air.visibility_m << ' ' << air.range_m;
    }
  }
}

TEST(VelodyneHeads, AnUnknownModelIsRefusedByName) {
  EXPECT_THROW((void)velodyne_head("HDL-33"), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
