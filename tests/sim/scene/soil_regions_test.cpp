#include "sim/scene/soil_regions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/scene/open_ground.h"

namespace rigwire::sim {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

SoilParameters named(const char* name) {
  SoilParameters soil;
  soil.name = name;
  return soil;
}

class SoilRegions : public testing::Test {
 protected:
  SoilRegions() : field(make_level(LevelTerrain(), 1)) {
    track.name = "lane";
    track.soil = "asphalt";
    track.points = {{{-20.0, 0.0}}, {{20.0, 0.0}}};
  }
  std::string soil_at(const SoilMap& map, double x, double y) const {
    const auto c = static_cast<std::size_t>((x - field.origin_m.x()) / field.cell_m);
    const auto r = static_cast<std::size_t>((y - field.origin_m.y()) / field.cell_m);
    return map.soils[map.cells[r * (field.columns - 1) + c]].name;
  }
  SoilMap map(const std::vector<SoilRegion>& regions) const {
    const LaidTrack laid{track, track_line(track)};
    return make_soil_map(field, {named("grass"), named("asphalt"), named("mud")}, {&laid, 1},
                         regions);
  }

  HeightField field;
  Track track;
};

TEST_F(SoilRegions, TracksOverTheGroundRegionsOverTracks) {
  const SoilMap soils = map({{"mud", SoilDisc{{10.0, 10.0}, 3.0}},
                             {"mud", SoilRectangle{{-10.0, -15.0}, {8.0, 2.0}, 1.5707963}},
                             {"mud", SoilStretch{"lane", 5.0, 10.0}}});
  EXPECT_EQ(soils.cells.size(), (field.columns - 1) * (field.rows - 1));
  EXPECT_EQ(soil_at(soils, 0.1, 8.0), "grass");
  EXPECT_EQ(soil_at(soils, 0.1, 1.6), "asphalt");
  EXPECT_EQ(soil_at(soils, 0.1, 2.6), "grass");
  EXPECT_EQ(soil_at(soils, 10.1, 12.5), "mud");
  EXPECT_EQ(soil_at(soils, 10.1, 13.3), "grass");
  EXPECT_EQ(soil_at(soils, -10.1, -11.6), "mud") << "long side turned north";
  EXPECT_EQ(soil_at(soils, -8.1, -15.1), "grass");
  EXPECT_EQ(soil_at(soils, -12.4, 0.1), "mud") << "7.6 m along the lane";
  EXPECT_EQ(soil_at(soils, -18.0, 0.1), "asphalt");
}

TEST_F(SoilRegions, OneSoilEverywhereNeedsNoMap) {
  track.soil.clear();
  EXPECT_TRUE(map({}).cells.empty());
}

TEST_F(SoilRegions, UnknownNamesAreRefusedWithThoseThatExist) {
  EXPECT_THAT(
      [&] {
        (void)map({{"ice", SoilDisc{}}});
      },
      ThrowsMessage<std::invalid_argument>(
          HasSubstr("no soil 'ice'; there are: grass, asphalt, mud")));
  EXPECT_THAT(
      [&] {
        (void)map({{"mud", SoilStretch{"loop", 0.0, 1.0}}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("no track 'loop'; there are: lane")));
}

}  // namespace
}  // namespace rigwire::sim
