#include "bench/gnss_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/gnss_lap.h"
#include "hil/command_line/config_files.h"

namespace rigwire::bench {
namespace {

TEST(GnssBench, EveryMessageHoldsPositionsToHalfAUnitAnywhereOnEarth) {
  const auto rows = measure_position_encoding(2000);
  ASSERT_EQ(rows.size(), 5U);
  for (const PositionEncoding& row : rows) {
    EXPECT_GT(row.worst, 0.4) << row.message << ": nothing was compared";
    // What decimal fractions lose in binary is far below a thousandth of any of these units.
    EXPECT_LE(row.worst, row.half_unit + 1e-3) << row.message;
  }
}

TEST(GnssBench, TheWorldFrameIsExactWhereTheTangentPlaneIsNot) {
  const auto rows = measure_tangent(49.4247, {100.0, 10e3, 500e3});
  for (const TangentCost& row : rows) {
    EXPECT_LT(row.frame_error_m, 1e-6) << row.distance_m;
    // The sphere of radius R falls away by d^2 / 2R.
    EXPECT_NEAR(row.plane_height_error_m, row.distance_m * row.distance_m / 2.0 / 6.38e6,
                0.02 * row.plane_height_error_m);
  }
  EXPECT_LT(rows[0].plane_error_m, 0.01);
  EXPECT_GT(rows[2].plane_error_m, 1000.0);
}

TEST(GnssBench, RegressionIsPessimisticUnderOpenSkyAndKnowsNoGeometry) {
  const auto rows = measure_dilution(49.42, 7.75);
  ASSERT_GE(rows.size(), 5U);
  // Open sky, nominal slots: Eq. 1 exceeds the geometry in H and V by these factors at 8 and more
  // satellites (the table of medians of 24 h that Eq. 1 was compared with has 1.31..1.95).
  EXPECT_GT(rows[0].horizontal_ratio, 1.2);
  EXPECT_LT(rows[0].horizontal_ratio, 2.2);
  EXPECT_GT(rows[0].vertical_ratio, 1.4);
  EXPECT_LT(rows[0].vertical_ratio, 2.6);
  // In a street the count says less: the scatter grows.
  EXPECT_GT(rows.back().vertical_scatter, rows.front().vertical_scatter);
}

// Two NEO-7Ps on one drive through a town, against a carrier solution of a third receiver: error
// over HDOP 1.87 and 1.78 m at 50 %, 2.52 and 2.55 m at 68 %, 6.6 and 6.5 m at 95 %. The rig's
// campus is more open than a town and the canyon narrower than most of its streets: the recording
// lies between them.
TEST(GnssBench, ErrorsOverDilutionAreThoseOfRealReceivers) {
  const auto rows =
      measure_models(hil::load_rig(hil::find_rig("gator_campus"), {}).configuration, 10, 300,
                     [](std::string_view place, std::string_view model) {
                       return model == "engine" && (place == "campus" || place == "canyon");
                     });
  ASSERT_EQ(rows.size(), 2U);
  const auto expect_within = [](double value, double least, double greatest) {
    EXPECT_GT(value, least);
    EXPECT_LT(value, greatest);
  };
  for (const ModelError& row : rows) {
    SCOPED_TRACE(row.place);
    const bool campus = row.place == "campus";
    expect_within(row.over_dilution_50_m, campus ? 1.3 : 1.8, campus ? 1.9 : 2.8);
    expect_within(row.over_dilution_68_m, campus ? 1.8 : 2.5, campus ? 2.6 : 4.2);
    expect_within(row.over_dilution_95_m, campus ? 2.8 : 5.5, campus ? 6.6 : 9.0);
  }
}

// Integers are found with a base station's help alone, and then the error is centimetres.
TEST(GnssBench, WithABaseStationFiveHundredMetresAwayRtkFixesAtCentimetres) {
  const auto rows = measure_models(hil::load_rig(hil::find_rig("gator_campus"), {}).configuration,
                                   2, 60, [](std::string_view place, std::string_view model) {
                                     return place == "open" && model.starts_with("RTK");
                                   });
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].model, "RTK float");
  EXPECT_GT(rows[0].fixes, 0.9);
  EXPECT_GT(rows[0].error_median_m, 0.1);
  EXPECT_LT(rows[0].error_95_m, 2.5);
  EXPECT_EQ(rows[1].model, "RTK fixed");
  EXPECT_GT(rows[1].fixes, 0.5);
  EXPECT_LT(rows[1].error_95_m, 0.03);
}

// It was fixed there as under an open sky. A ZED-F9P in fields and forest together: half of the
// time and less (Stefal/rtkbase #351); these crowns are closed, and leave less of it.
TEST(GnssBench, UnderCrownsRtkIsFixedAPartOfTheTime) {
  const auto rows = measure_models(hil::load_rig(hil::find_rig("gator_campus"), {}).configuration,
                                   4, 300, [](std::string_view place, std::string_view model) {
                                     return place == "wood" && model == "RTK fixed";
                                   });
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_GT(rows[0].fixes, 0.005);
  EXPECT_LT(rows[0].fixes, 0.5);
}

/// Receivers as they are configured, at one place over several days.
class GnssAccuracy : public testing::Test {
 protected:
  static std::vector<ReceiverAccuracy> at(std::string_view wanted, int days) {
    return measure_accuracies(
        hil::load_rig(hil::find_rig("gator_campus"), {}).configuration,
        hil::load_rig(hil::find_rig("unimog_forest"), {}).configuration, days,
        [wanted](std::string_view place, std::string_view) { return place == wanted; });
  }
  static ReceiverAccuracy of(const std::vector<ReceiverAccuracy>& rows,
                             const std::string& receiver) {
    const auto found = std::ranges::find(rows, receiver, &ReceiverAccuracy::receiver);
    EXPECT_NE(found, rows.end()) << receiver;
    return *found;
  }
  static void expect_within(const char* what, double value, double least, double greatest) {
    EXPECT_GT(value, least) << what;
    EXPECT_LT(value, greatest) << what;
  }
};

// Recordings, hAcc and vAcc / hAcc: NEO-7P 2.63 m, 2.75 (30 dBHz); NEO-M8N 1.13, 1.41;
// NEO-M8P 2.49, 1.95 (31 dBHz); NEO-M8T 1.59 m in space; ZED-F9P 0.35, 1.48 and 5.25, 1.37 (24
// dBHz). Before: the sizes of a NEO-7P for all of one band, and ratios of 1.01.
TEST_F(GnssAccuracy, UnderAnOpenSkyEachReceiverSaysWhatItsOwnLogSaysAndIsRight) {
  const auto rows = at("open", 30);
  struct OpenSky {
    const char* receiver;
    double least_m;
    double greatest_m;
  };
  for (const OpenSky& log : {OpenSky{"NEO-7P", 2.2, 3.2}, OpenSky{"NEO-M8N", 0.9, 1.35},
                             OpenSky{"NEO-M8T", 0.9, 1.35}, OpenSky{"ZED-F9P", 0.3, 0.5}}) {
    SCOPED_TRACE(log.receiver);
    const ReceiverAccuracy row = of(rows, log.receiver);
    expect_within("hAcc", row.horizontal_accuracy_m, log.least_m, log.greatest_m);
    expect_within("vAcc / hAcc", row.vertical_over_horizontal, 1.35, 2.45);
    // One of thirty days counts three percent.
    expect_within("share inside hAcc", row.inside_horizontal, 0.55, 0.90);
    expect_within("share inside vAcc", row.inside_vertical, 0.50, 0.85);
    EXPECT_EQ(row.fixes, 1.0);
  }
}

// UrbanNav, Tsim Sha Tsui, a NEO-M8T's measurements: 4 to 10 m at 50 %, 20 to 50 m at 95 %, height
// 13 to 37 m; two NEO-7Ps on a drive through a town: error correlated by 0.92, 0.59 and 0.67 after
// 1, 5 and 10 s. Before, in the same street: 5.4 m at 95 %, 0.99, 0.94, 0.85, and a tenth of the
// errors within hAcc.
TEST_F(GnssAccuracy, ADeepCanyonHasTheTailOfARealOne) {
  const auto rows = at("deep canyon", 10);
  const ReceiverAccuracy row = of(rows, "NEO-M8T");
  expect_within("50 %", row.error_50_m, 4.0, 10.0);
  expect_within("95 %", row.error_95_m, 20.0, 50.0);
  expect_within("height", row.up_deviation_m, 13.0, 37.0);
  expect_within("1 s", row.correlation_1s, 0.85, 0.96);
  expect_within("5 s", row.correlation_5s, 0.45, 0.80);
  expect_within("10 s", row.correlation_10s, 0.25, 0.75);
  expect_within("hAcc", row.horizontal_accuracy_m, 4.0, 15.0);
  expect_within("share inside hAcc", row.inside_horizontal, 0.35, 0.80);
  expect_within("share inside vAcc", row.inside_vertical, 0.40, 0.80);
  EXPECT_GT(row.fixes, 0.9);
}

// A NEO-7P on a drive through a town: 6.9 m at 95 %. The campus has lawns between its buildings, so
// that its lap stays below. Before: 3.3 m, at most 4.0 m.
TEST_F(GnssAccuracy, ALapOfTheCampusIsBetterThanATown) {
  const ReceiverAccuracy row = of(at("campus", 10), "NEO-7P");
  expect_within("95 %", row.error_95_m, 3.8, 6.9);
  expect_within("most", row.error_most_m, 5.0, 20.0);
  expect_within("share inside hAcc", row.inside_horizontal, 0.5, 0.9);
}

// A ZED-F9P in fields and forest was fixed half of the time and less (Stefal/rtkbase #351). This
// track is open above, fourteen metres between trunks. Before: fixed 77 %, and all of the rest by a
// fault of its own.
TEST_F(GnssAccuracy, OnAForestTrackRtkIsFixedHalfOfTheTime) {
  const ReceiverAccuracy row = of(at("forest", 10), "ZED-F9P, RTK");
  expect_within("fixed", row.rtk_fixed, 0.3, 0.6);
  EXPECT_LT(row.error_95_m, 1.5);
  const ReceiverAccuracy wood = of(at("wood", 10), "ZED-F9P, RTK");
  EXPECT_LT(wood.rtk_fixed, row.rtk_fixed);
}

class CampusLap : public testing::Test {
 protected:
  static const std::vector<Lap>& laps() {
    static const std::vector<Lap> driven =
        drive_lap(hil::load_rig(hil::find_rig("gator_campus"), {}).configuration, 2.0, 2.0);
    return driven;
  }
  static const Lap& of_type(const std::string& type) {
    const auto found = std::ranges::find(laps(), type, &Lap::type);
    EXPECT_NE(found, laps().end()) << type;
    return *found;
  }
};

TEST_F(CampusLap, TheTrackIsFiveHundredMetresWithBothReceivers) {
  ASSERT_EQ(laps().size(), 2U);
  for (const Lap& lap : laps()) {
    EXPECT_GT(lap.epochs.back().along_m, 480.0);
    EXPECT_LT(lap.epochs.back().along_m, 620.0);
  }
}

TEST_F(CampusLap, CountsOfTheNeo7pSpanThoseOfTheRegression) {
  const LapRange range = lap_range(of_type("ublox-neo-7p"));
  EXPECT_GE(range.satellites.least, 0.0);
  EXPECT_LE(range.satellites.least, 5.0) << "buildings take satellites away";
  EXPECT_GE(range.satellites.greatest, 7.0);
  EXPECT_LE(range.satellites.greatest, 11.0);
  EXPECT_GE(range.horizontal.least, 1.02);
  EXPECT_LE(range.horizontal.greatest, 3.6);
}

TEST_F(CampusLap, DilutionPeaksAtTheBuildings) {
  const Lap& lap = of_type("ublox-neo-7p");
  std::vector<double> all;
  for (const LapEpoch& epoch : lap.epochs) {
    if (std::isfinite(epoch.horizontal_dilution)) {
      all.push_back(epoch.horizontal_dilution);
    }
  }
  std::ranges::sort(all);
  const double median = all[all.size() / 2];
  const double highest = all.back();
  const auto buildings =
      passed_buildings(hil::load_rig(hil::find_rig("gator_campus"), {}).configuration, 25.0);
  ASSERT_GE(buildings.size(), 3U);
  bool at_building = false;
  for (const LapEpoch& epoch : lap.epochs) {
    if (epoch.horizontal_dilution == highest) {
      at_building |= std::ranges::any_of(buildings, [&](const PassedBuilding& building) {
        return std::abs(building.along_m - epoch.along_m) < 40.0;
      });
    }
  }
  EXPECT_GT(highest, 1.2 * median);
  EXPECT_TRUE(at_building) << "the worst dilution is at no building";
}

TEST_F(CampusLap, TheStarfireSeesMoreAndIsFarBetter) {
  const Lap& ublox = of_type("ublox-neo-7p");
  const Lap& starfire = of_type("starfire-3000");
  std::size_t more = 0;
  for (std::size_t i = 0; i < ublox.epochs.size(); ++i) {
    more += starfire.epochs[i].satellites > ublox.epochs[i].satellites ? 1U : 0U;
  }
  EXPECT_GT(more, ublox.epochs.size() * 9 / 10);
}

}  // namespace
}  // namespace rigwire::bench
