#include "sim/gnss/constellation.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "sim/gnss/dilution.h"
#include "sim/gnss/ephemeris.h"
#include "sim/gnss/nominal_slots.h"
#include "sim/local_frame.h"

namespace rigwire::sim {
namespace {

constexpr std::int64_t kConstellationSecond_ns = 1'000'000'000;
constexpr std::array kGps{GnssSystem::gps};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// A day of open sky, every five minutes.
struct SkyStatistics {
  std::size_t least = 99;
  std::size_t most = 0;
  double mean = 0.0;
  double horizontal = 0.0;  ///< Medians.
  double vertical = 0.0;
  double position = 0.0;
};

SkyStatistics sky(const Constellation& constellation, double latitude_deg, double mask_deg) {
  const LocalFrame frame({latitude_deg, 7.75, 280.0, 0.0});
  const Eigen::Vector3d p_E = frame.to_ecef(Eigen::Vector3d::Zero());
  const auto model = make_geometric_dilution();
  SkyStatistics statistics;
  std::vector<double> horizontal;
  std::vector<double> vertical;
  std::vector<double> position;
  double sum = 0.0;
  for (std::int64_t t = 0; t < 86'400; t += 300) {
    std::vector<Eigen::Vector3d> directions_W;
    for (std::size_t i = 0; i < constellation.satellites().size(); ++i) {
      const SatelliteState state = constellation.state(i, {2421, t * kConstellationSecond_ns}, 0.0);
      const Eigen::Vector3d e = (frame.world_from_ecef() * (state.position_E_m - p_E)).normalized();
      if (e.z() > std::sin(mask_deg * kDegree)) {
        directions_W.push_back(e);
      }
    }
    statistics.least = std::min(statistics.least, directions_W.size());
    statistics.most = std::max(statistics.most, directions_W.size());
    sum += static_cast<double>(directions_W.size());
    const Dilution dilution = model->reported(directions_W);
    horizontal.push_back(dilution.horizontal);
    vertical.push_back(dilution.vertical);
    position.push_back(dilution.position);
  }
  statistics.mean = sum / static_cast<double>(horizontal.size());
  statistics.horizontal = median(horizontal);
  statistics.vertical = median(vertical);
  statistics.position = median(position);
  return statistics;
}

TEST(NominalConstellationTest, GpsSkiesHaveTheirPublishedDilutions) {
  // Medians over a day of the 24 circular slots, 5 degrees of mask; our slight eccentricities move
  // a satellite by up to 1.1 degrees.
  const auto gps = make_nominal_constellation(kGps);
  struct Row {
    double latitude_deg;
    double mask_deg;
    std::size_t least;
    std::size_t most;
    double mean;
    double horizontal;
    double vertical;
    double position;
  };
  for (const Row& row :
       {Row{0.0, 5.0, 7, 10, 8.65, 0.86, 1.50, 1.73}, Row{0.0, 15.0, 5, 9, 6.8, 1.08, 1.99, 2.28},
        Row{25.0, 5.0, 6, 10, 7.7, 0.95, 1.52, 1.81}, Row{49.42, 5.0, 6, 10, 7.7, 1.02, 1.47, 1.83},
        Row{49.42, 10.0, 5, 9, 6.7, 1.19, 1.79, 2.15},
        Row{70.0, 5.0, 7, 11, 8.7, 0.88, 1.74, 1.96}}) {
    const SkyStatistics s = sky(*gps, row.latitude_deg, row.mask_deg);
    SCOPED_TRACE(testing::Message() << row.latitude_deg << " deg, mask " << row.mask_deg);
    EXPECT_NEAR(static_cast<double>(s.least), static_cast<double>(row.least), 1.0);
    EXPECT_NEAR(static_cast<double>(s.most), static_cast<double>(row.most), 1.0);
    EXPECT_NEAR(s.mean, row.mean, 0.1);
    EXPECT_NEAR(s.horizontal, row.horizontal, 0.04);
    EXPECT_NEAR(s.vertical, row.vertical, 0.08);
    EXPECT_NEAR(s.position, row.position, 0.08);
  }
}

TEST(NominalConstellationTest, MoreSystemsDiluteLess) {
  const std::array kTwo{GnssSystem::gps, GnssSystem::glonass};
  const SkyStatistics two = sky(*make_nominal_constellation(kTwo), 49.42, 5.0);
  EXPECT_NEAR(two.mean, 16.0, 0.6);
  EXPECT_NEAR(two.horizontal, 0.66, 0.04);
  EXPECT_NEAR(two.vertical, 0.95, 0.08);
  const std::array kFour{GnssSystem::gps, GnssSystem::glonass, GnssSystem::galileo,
                         GnssSystem::beidou};
  const SkyStatistics four = sky(*make_nominal_constellation(kFour), 49.42, 5.0);
  EXPECT_NEAR(four.mean, 32.0, 1.0);
  EXPECT_NEAR(four.horizontal, 0.47, 0.03);
  EXPECT_NEAR(four.vertical, 0.67, 0.05);
}

TEST(NominalConstellationTest, SatellitesAreInOrder) {
  const std::array kMixed{GnssSystem::glonass, GnssSystem::sbas,   GnssSystem::gps,
                          GnssSystem::qzss,    GnssSystem::beidou, GnssSystem::gps,
                          GnssSystem::galileo};
  const auto all = make_nominal_constellation(kMixed);
  const auto satellites = all->satellites();
  EXPECT_EQ(satellites.size(), 24U * 4U + 8U + 4U);
  EXPECT_TRUE(std::ranges::is_sorted(
      satellites, {}, [](const Satellite& s) { return std::pair(s.system, s.number); }));
  for (std::size_t i = 0; i < satellites.size(); ++i) {
    EXPECT_GT(all->state(i, {2421, 0}, -0.07).position_E_m.norm(), 25e6);
  }
}

TEST(NominalConstellationTest, SystemsWithoutSlotsAreRefused) {
  const std::array kImes{GnssSystem::gps, GnssSystem::imes};
  EXPECT_THROW(static_cast<void>(make_nominal_constellation(kImes)), std::invalid_argument);
}

TEST(NominalConstellationTest, EverySystemBroadcastsItsOwnOrbits) {
  const std::array kStanding{GnssSystem::sbas, GnssSystem::qzss};
  EXPECT_EQ(make_nominal_constellation(kStanding)->navigation({2421, 0}), nullptr);
  const std::array kGlonass{GnssSystem::glonass};
  const auto glonass = make_nominal_constellation(kGlonass)->navigation({2421, 0});
  ASSERT_NE(glonass, nullptr);
  EXPECT_EQ(glonass->glonass.size(), 24U);
  EXPECT_TRUE(glonass->galileo.empty() && glonass->beidou.empty());
  EXPECT_FALSE(glonass->ephemerides[0]);
  const std::array kFour{GnssSystem::gps, GnssSystem::glonass, GnssSystem::galileo,
                         GnssSystem::beidou};
  const auto all = make_nominal_constellation(kFour);
  const auto at_once = all->navigation({2421, 1'000 * kConstellationSecond_ns});
  EXPECT_EQ(at_once->galileo.size(), 24U);
  EXPECT_EQ(at_once->beidou.size(), 24U);
  EXPECT_TRUE(at_once->ephemerides[0]);
  // Until GLONASS' next half hour of UTC.
  EXPECT_EQ(all->navigation({2421, 1'817 * kConstellationSecond_ns}), at_once);
  EXPECT_NE(all->navigation({2421, 1'818 * kConstellationSecond_ns}), at_once);
}

TEST(NominalConstellationTest, OneBroadcastLastsTwoHoursAndIsShared) {
  const auto gps = make_nominal_constellation(kGps);
  const auto first = gps->navigation({2421, 7'200 * kConstellationSecond_ns});
  EXPECT_EQ(gps->navigation({2421, 14'400 * kConstellationSecond_ns - 1}), first);
  const auto second = gps->navigation({2421, 14'400 * kConstellationSecond_ns});
  EXPECT_NE(second, first);
  EXPECT_EQ(gps->navigation({2421, 7'201 * kConstellationSecond_ns}),
            first);  // a receiver a little behind
  EXPECT_NE(first->ephemerides[0]->issue_of_ephemeris, second->ephemerides[0]->issue_of_ephemeris);
  EXPECT_FALSE(first->ephemerides[24].has_value());
}

TEST(NominalConstellationTest, SatellitesMoveAsTheyBroadcast) {
  const auto gps = make_nominal_constellation(kGps);
  for (const std::int64_t t_ns :
       {std::int64_t{0}, 7'199'999'999'999, 7'200'000'000'000, 604'799'999'999'999}) {
    const GpsTime time{2316, t_ns};
    const auto navigation = gps->navigation(time);
    for (std::size_t i = 0; i < gps->satellites().size(); ++i) {
      const auto& set = navigation->ephemerides[gps->satellites()[i].number - 1U];
      const SatelliteState own = gps->state(i, time, 0.0);
      const SatelliteState users = satellite_state(*set, time);
      EXPECT_EQ(own.position_E_m, users.position_E_m);
      EXPECT_EQ(own.clock_s, users.clock_s);
    }
  }
}

TEST(NominalConstellationTest, AnyThreadMayAsk) {
  const auto gps = make_nominal_constellation(kGps);
  std::array<std::shared_ptr<const GpsNavigation>, 4> seen;
  {
    std::vector<std::jthread> threads;
    for (auto& one : seen) {
      threads.emplace_back([&gps, &one] {
        for (std::int64_t hour = 0; hour <= 24; ++hour) {
          one = gps->navigation({2421, hour * 3'600 * kConstellationSecond_ns});
        }
      });
    }
  }
  for (const auto& one : seen) {
    EXPECT_EQ(one->ephemerides[3], seen[0]->ephemerides[3]);
  }
}

class FileConstellationTest : public testing::Test {
 protected:
  /// Sets of PRN 3 and 8, toe 01:00, 03:00, 05:00 of week 2421; PRN 8 lacks that of 03:00.
  std::vector<GpsEphemeris> sets() const {
    std::vector<GpsEphemeris> all;
    for (const std::int64_t interval : {0, 1, 2}) {
      for (const int prn : {8, 3}) {
        if (prn == 3 || interval != 1) {
          all.push_back(nominal_gps_set(prn, std::int64_t{2421} * 84 + interval));
        }
      }
    }
    return all;
  }
  static GpsTime hour(double hours) {
    return {2421, std::llround(hours * 3'600.0) * kConstellationSecond_ns};
  }
  std::shared_ptr<const Constellation> constellation_ =
      make_gps_constellation(sets(), nominal_ionosphere(), nominal_utc(2421 * 84));
};

TEST_F(FileConstellationTest, EverySatelliteBroadcastsItsNearestSet) {
  ASSERT_EQ(constellation_->satellites().size(), 2U);
  EXPECT_EQ(constellation_->satellites()[0].number, 3);
  EXPECT_EQ(constellation_->satellites()[1].number, 8);
  const auto toe = [&](std::size_t prn, double hours) {
    return constellation_->navigation(hour(hours))->ephemerides[prn - 1]->ephemeris_time_s /
           3'600.0;
  };
  EXPECT_EQ(toe(3, 0.5), 1.0);
  EXPECT_EQ(toe(3, 1.9), 1.0);
  EXPECT_EQ(toe(3, 2.1), 3.0);
  EXPECT_EQ(toe(3, 4.1), 5.0);
  EXPECT_EQ(toe(8, 2.9), 1.0);
  EXPECT_EQ(toe(8, 3.1), 5.0);
  EXPECT_EQ(constellation_->navigation(hour(1.0))->utc.leap_seconds, 18);
}

TEST_F(FileConstellationTest, BeyondTheFileTheNearestSetIsIssuedAnew) {
  for (const double hours : {7.5, 30.3, 100.0, 167.9}) {
    const auto navigation = constellation_->navigation(hour(hours));
    const GpsEphemeris& set = *navigation->ephemerides[2];
    EXPECT_LE(std::abs(seconds_between(set.week, set.ephemeris_time_s, hour(hours))), 3'601.0);
    EXPECT_EQ(quantised(set), set);
    // And the satellite is about where its orbit takes it.
    const SatelliteState made = constellation_->state(0, hour(hours), 0.0);
    const GpsEphemeris nominal = nominal_gps_set(3, broadcast_interval(hour(hours)));
    EXPECT_LT((made.position_E_m - satellite_state(nominal, hour(hours)).position_E_m).norm(), 0.2);
    EXPECT_EQ(made.position_E_m, satellite_state(set, hour(hours)).position_E_m);
  }
  EXPECT_NE(constellation_->navigation(hour(8.5))->ephemerides[2]->issue_of_ephemeris,
            constellation_->navigation(hour(10.5))->ephemerides[2]->issue_of_ephemeris);
}

TEST_F(FileConstellationTest, YearsFromTheFileAllIsStillInRange) {
  for (const std::int32_t week : {1100, 1700, 3000}) {
    const GpsTime time{week, 300'000 * kConstellationSecond_ns};
    const SatelliteState state = constellation_->state(0, time, -0.07);
    EXPECT_NEAR(state.position_E_m.norm(), 26.56e6, 0.3e6);
    EXPECT_LT(std::abs(state.clock_s), 1e-3);
    EXPECT_EQ(constellation_->navigation(time)->ephemerides[2]->week, week);
  }
}

TEST_F(FileConstellationTest, OneObjectAsLongAsNothingChanges) {
  EXPECT_EQ(constellation_->navigation(hour(1.1)), constellation_->navigation(hour(1.8)));
  EXPECT_NE(constellation_->navigation(hour(1.1)), constellation_->navigation(hour(2.1)));
}

TEST_F(FileConstellationTest, NeighboursOfOneIssueAreToldApart) {
  std::vector<GpsEphemeris> same = sets();  // as of an almanac, which knows no issues
  for (auto& set : same) {
    set.issue_of_ephemeris = 0;
    set.issue_of_clock = 0;
  }
  const auto made = make_gps_constellation(same, {}, {});
  EXPECT_NE(made->navigation(hour(1.0))->ephemerides[2]->issue_of_ephemeris,
            made->navigation(hour(3.0))->ephemerides[2]->issue_of_ephemeris);
}

TEST_F(FileConstellationTest, RefusesNothingAndStrangeSatellites) {
  EXPECT_THROW(static_cast<void>(make_gps_constellation({}, {}, {})), std::invalid_argument);
  std::vector<GpsEphemeris> strange = sets();
  strange[0].prn = 33;
  EXPECT_THROW(static_cast<void>(make_gps_constellation(strange, {}, {})), std::invalid_argument);
}

// Receivers share the last state of each satellite: of another instant, of other satellites, from
// another thread it must be that which is asked for.
TEST(Constellation, SharedStatesAreThoseOfTheInstantThatIsAskedFor) {
  const auto constellation = make_nominal_constellation(
      std::array{GnssSystem::gps, GnssSystem::galileo, GnssSystem::glonass, GnssSystem::sbas});
  const std::size_t count = constellation->satellites().size();
  const auto ask = [&](std::size_t first, std::int64_t step_ms) {
    std::vector<std::size_t> indices;
    for (std::size_t i = first; i < count; i += 3) {
      indices.push_back(i);
    }
    std::vector<SatelliteState> states(indices.size());
    for (std::int64_t epoch = 0; epoch < 40; ++epoch) {
      const GpsTime time{2421, 100'000 * kConstellationSecond_ns + epoch / 2 * step_ms * 1'000'000};
      constellation->states(indices, time, states);
      for (std::size_t i = 0; i < indices.size(); ++i) {
        const SatelliteState alone = constellation->state(indices[i], time, 0.0);
        ASSERT_EQ(states[i].position_E_m, alone.position_E_m);
        ASSERT_EQ(states[i].velocity_E_mps, alone.velocity_E_mps);
        ASSERT_EQ(states[i].clock_s, alone.clock_s);
      }
    }
  };
  std::thread other([&] { ask(0, 100); });
  ask(0, 250);
  ask(1, 100);
  other.join();
}

// One field of errors for all receivers of a rig, another one for another seed.
TEST(Constellation, ErrorsOfASeedAreOneObject) {
  const auto constellation = make_nominal_constellation(kGps);
  const auto first = constellation->errors(1);
  EXPECT_EQ(constellation->errors(1), first);
  EXPECT_NE(constellation->errors(2), first);
}

}  // namespace
}  // namespace rigwire::sim
