// What clients of an HDL-64E get out of its raw distances and its status channel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "emulators/velodyne/raw_ranges.h"
#include "fields/constants.h"
#include "protocols/velodyne/status_channel.h"
#include "velodyne_fixture.h"

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;
using std::chrono::seconds;
using testing::HasSubstr;
using testing::ThrowsMessage;

class Hdl64eTest : public VelodyneFixture {
 protected:
  /// Corrections as various as those of a real unit.
  static velodyne::Hdl64eCalibration various() {
    velodyne::Hdl64eCalibration calibration =
        velodyne::nominal_calibration(*velodyne::find_model("HDL-64E S2"));
    for (std::size_t i = 0; i < calibration.lasers.size(); ++i) {
      velodyne::Hdl64eLaser& laser = calibration.lasers[i];
      const auto n = static_cast<double>(i);
      laser.dist_correction_m = 1.3 + 0.003 * n;
      laser.dist_correction_x_m = 1.25 + 0.004 * n;
      laser.dist_correction_y_m = 1.45 - 0.003 * n;
      laser.rot_correction_deg = -8.0 + 0.25 * n;
      laser.horiz_offset_m = i % 2 == 0 ? 0.026 : -0.026;
      laser.focal_slope = 0.1 * static_cast<double>(i % 12);
    }
    return calibration;
  }
  static VelodyneSettings settings() {
    VelodyneSettings s;
    s.model = "HDL-64E S2";
    s.calibration = various();
    return s;
  }
};

TEST_F(Hdl64eTest, FastInverseAgreesWithTheIteratedOne) {
  const velodyne::Model& model = *velodyne::find_model("HDL-64E S2");
  const velodyne::Hdl64eCalibration calibration = various();
  const RawRanges raw(calibration, model.lasers);
  for (double azimuth_deg = 0.05; azimuth_deg < 360.0; azimuth_deg += 3.7) {
    std::array<RawRanges::Beams, 2> banks;
    raw.aim(azimuth_deg * kDegree, 62.8, 0, banks[0]);
    raw.aim(azimuth_deg * kDegree, 62.8, kBankLasers, banks[1]);
    for (std::size_t i = 0; i < 64; ++i) {
      const double shot_deg = azimuth_deg + 62.8 * model.lasers[i].time_offset_ns * 1e-9 / kDegree;
      for (const double range_m : {2.0, 3.0, 8.0, 25.0, 119.0}) {
        const double exact = velodyne::raw_counts(calibration.lasers[i], range_m, shot_deg);
        ASSERT_NEAR(raw.counts(banks[i / kBankLasers], i % kBankLasers, range_m), exact, 0.05)
            << azimuth_deg << " deg, laser " << i << ", " << range_m << " m";
      }
    }
  }
}

TEST_F(Hdl64eTest, CalibratedClientsGetTheTrueRangeWithinHalfACount) {
  VelodyneLidar lidar(settings(), calendar, data, position);
  const velodyne::Hdl64eCalibration told = velodyne::as_sent(various());
  see = [](LidarFiring& bank) {
    for (std::size_t i = 0; i < kBankLasers; ++i) {
      bank.strongest[i] = {3.0F + static_cast<float>(bank.first_laser + i), 0.5F};
    }
  };
  azimuth_rad = 1.0;
  const double before_rad = azimuth_rad;
  fire(lidar, 6);
  ASSERT_EQ(data.sent.size(), 1U);
  const double rate = 20.0 * std::numbers::pi;
  for (std::size_t b = 0; b < 12; ++b) {
    const double fired_rad = before_rad + rate * 48e-6 * static_cast<double>(b / 2 + 1);
    for (std::size_t j = 0; j < 32; ++j) {
      const std::size_t n = b % 2 * 32 + j;
      const double shot_rad =
          fired_rad + rate * velodyne::find_model("HDL-64E S2")->lasers[n].time_offset_ns * 1e-9;
      const auto point = velodyne::corrected(told.lasers[n], packet(0).distance(b, j),
                                             shot_rad * 180.0 / std::numbers::pi);
      ASSERT_NEAR(point.range_m, 3.0 + static_cast<double>(n), 0.00115);
      EXPECT_NEAR(velodyne::corrected_intensity(
                      told.lasers[n], static_cast<std::uint8_t>(packet(0).reflectivity(b, j)),
                      packet(0).distance(b, j)),
                  128.0, 40.0);
    }
  }
}

TEST_F(Hdl64eTest, StatusChannelTellsCalibrationTimeAndSettings) {
  VelodyneLidar lidar(settings(), calendar, data, position);
  velodyne::StatusReader reader;
  std::optional<velodyne::StatusRecord> record;
  see = [](LidarFiring&) {};
  fire(lidar, 6 * 2 * 4160);
  for (const auto& sent : data.sent) {
    if (auto complete = reader.add({sent.bytes[1204], sent.bytes[1205]})) {
      record = complete;
    }
  }
  ASSERT_TRUE(record.has_value());
  EXPECT_EQ(record->calibration, velodyne::as_sent(various()));
  EXPECT_EQ(record->motor_rpm, 600);
  EXPECT_EQ(record->view_end_centideg, 36000);
  EXPECT_EQ(record->destination, (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
  EXPECT_EQ(reader.live().gps, velodyne::StatusGps::pulse_and_sentence);
  EXPECT_EQ(reader.live().hour, 8);
  EXPECT_EQ(reader.live().minute, 59);
  EXPECT_EQ(reader.live().year, 26);
  EXPECT_EQ(reader.rejected(), 0U);
  EXPECT_TRUE(position.sent.empty()) << "no position packets";
  EXPECT_EQ(lidar.next_event(), kStart + seconds{3}) << "the next pulse";
}

TEST_F(Hdl64eTest, StatusChannelWithoutReceiverSaysSo) {
  VelodyneSettings alone = settings();
  alone.time_source = VelodyneTimeSource::none;
  VelodyneLidar lidar(alone, calendar, data, position);
  velodyne::StatusReader reader;
  fire(lidar, 6 * 40);
  for (const auto& sent : data.sent) {
    reader.add({sent.bytes[1204], sent.bytes[1205]});
  }
  EXPECT_EQ(reader.live().gps, velodyne::StatusGps::none);
  EXPECT_EQ(reader.live().hour, 0);
}

TEST_F(Hdl64eTest, NearerThanTheLaserCanTellIsNothing) {
  VelodyneSettings near = settings();
  near.minimum_range_m = 0.5;
  VelodyneLidar lidar(near, calendar, data, position);
  see = [](LidarFiring& bank) { bank.strongest.fill({1.0F, 0.5F}); };
  fire(lidar, 6);
  EXPECT_EQ(packet(0).distance(0, 0), 0) << "its correction is 1.3 m";
  EXPECT_EQ(packet(0).reflectivity(0, 0), 0);
}

TEST_F(Hdl64eTest, RefusesThirtyOneLasers) {
  VelodyneSettings few = settings();
  few.calibration->lasers.resize(31);
  EXPECT_THAT([&] { VelodyneLidar(few, calendar, data, position); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("31 lasers, allowed: 64")));
  VelodyneSettings other;
  other.calibration = various();
  EXPECT_THAT([&] { VelodyneLidar(other, calendar, data, position); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("HDL-32E measures true ranges")));
}

}  // namespace
}  // namespace rigwire::emulators
