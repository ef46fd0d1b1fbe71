#include "hil/files/height_map_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "sim/scene/utm.h"
#include "small_images.h"

namespace rigwire::hil {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using tests::Bytes;
using tests::doubles;
using tests::little_endian;
using tests::shorts;
using tests::tiff;

constexpr OriginPlace kOrigin{49.4247, 7.7517};
constexpr std::uint16_t kColumns = 5;
constexpr std::uint16_t kRows = 4;

/// A file of this test's own, gone with it.
class HeightMapFile : public testing::Test {
 protected:
  ~HeightMapFile() override { std::filesystem::remove(map.file); }

  void write(const std::string& extension, const Bytes& bytes) {
    std::filesystem::remove(map.file);
    map.file = (std::filesystem::temp_directory_path() /
                (std::string("rigwire_height_map_") +
                 testing::UnitTest::GetInstance()->current_test_info()->name() + extension))
                   .string();
    tests::write_file(map.file, bytes);
  }
  [[nodiscard]] auto load() const { return load_height_map(map, kOrigin); }
  void expect_refused(const std::string& what) {
    EXPECT_THAT([&] { (void)load(); },
                ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr(map.file), HasSubstr(what))));
  }

  /// Pixel (c, r) from the north-west is worth 10 r + c.
  template <class Number>
  [[nodiscard]] static std::vector<Number> ramp() {
    std::vector<Number> values;
    for (int i = 0; i < kColumns * kRows; ++i) {
      values.push_back(static_cast<Number>(10 * (i / kColumns) + i % kColumns));
    }
    return values;
  }
  /// Expects the ramp in the order of a height field, from the south-west.
  static void expect_ramp(const sim::HeightField& field) {
    ASSERT_EQ(field.columns, kColumns);
    ASSERT_EQ(field.rows, kRows);
    for (std::size_t r = 0; r < kRows; ++r) {
      for (std::size_t c = 0; c < kColumns; ++c) {
        EXPECT_DOUBLE_EQ(field.node(c, r), static_cast<double>(10 * (kRows - 1 - r) + c));
      }
    }
  }

  sim::HeightMapTerrain map;
};

TEST_F(HeightMapFile, PngOf8And16BitsIsScaledAndShifted) {
  map.pixel_m = 2.0;
  write(".png", tests::png(kColumns, kRows, 8, 1, ramp<std::uint16_t>()));
  expect_ramp(*load());
  std::vector<std::uint16_t> high = ramp<std::uint16_t>();
  for (auto& value : high) {
    value = static_cast<std::uint16_t>(value * 1000 + 7);
  }
  write(".png", tests::png(kColumns, kRows, 16, 1, high));
  map.scale = 1e-3;
  map.offset_m = -7e-3;
  const auto field = load();
  for (std::size_t i = 0; i < field->heights_m.size(); ++i) {
    EXPECT_NEAR(field->heights_m[i],
                static_cast<double>(10 * (kRows - 1 - i / kColumns) + i % kColumns), 1e-9);
  }
  EXPECT_DOUBLE_EQ(field->cell_m, 2.0);
  EXPECT_DOUBLE_EQ(field->origin_m.x(), -4.0) << "its middle at (0, 0)";
  EXPECT_DOUBLE_EQ(field->origin_m.y(), -3.0);
}

TEST_F(HeightMapFile, GeoTiffOfEveryNumberIsRead) {
  const std::vector<tests::TiffField> pixel{doubles(33550, {3.0, 3.0, 0.0})};
  write(".tif", tiff(kColumns, kRows, 8, 1, little_endian(ramp<std::uint8_t>()), pixel));
  expect_ramp(*load());
  write(".tif", tiff(kColumns, kRows, 16, 1, little_endian(ramp<std::uint16_t>()), pixel));
  expect_ramp(*load());
  write(".tif", tiff(kColumns, kRows, 16, 2, little_endian(ramp<std::int16_t>()), pixel));
  expect_ramp(*load());
  write(".tif", tiff(kColumns, kRows, 32, 2, little_endian(ramp<std::int32_t>()), pixel));
  expect_ramp(*load());
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()), pixel));
  expect_ramp(*load());
  write(".tif", tiff(kColumns, kRows, 64, 3, little_endian(ramp<double>()), pixel));
  expect_ramp(*load());
  EXPECT_DOUBLE_EQ(load()->cell_m, 3.0);
}

TEST_F(HeightMapFile, UtmMapLiesWhereItsTiePointSays) {
  map.place = sim::HeightMapPlace::georeferenced;
  const auto origin = sim::utm_place(kOrigin.latitude_deg, kOrigin.longitude_deg, 32, true);
  // The corner of the north-western pixel is 6 m west and 7 m north of the rig.
  const auto fields = [&](std::uint16_t raster_type) {
    return std::vector<tests::TiffField>{
        doubles(33550, {3.0, 3.0, 0.0}),
        doubles(33922, {0, 0, 0, origin.easting_m - 6.0, origin.northing_m + 7.0, 0}),
        shorts(34735, {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, raster_type, 3072, 0, 1, 32632})};
  };
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()), fields(1)));
  const auto field = load();
  EXPECT_NEAR(field->origin_m.x(), -6.0 + 1.5, 0.01);
  EXPECT_NEAR(field->origin_m.y(), 7.0 - 1.5 - 9.0, 0.01);
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()), fields(2)));
  EXPECT_NEAR(load()->origin_m.x(), -6.0, 0.01) << "pixel is point";
}

TEST_F(HeightMapFile, MapElsewhereOnEarthIsRefusedSayingWhere) {
  map.place = sim::HeightMapPlace::georeferenced;
  const auto origin = sim::utm_place(kOrigin.latitude_deg, kOrigin.longitude_deg, 32, true);
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()),
                     {doubles(33550, {3.0, 3.0, 0.0}),
                      doubles(33922, {0, 0, 0, origin.easting_m + 5000.0, origin.northing_m, 0}),
                      shorts(34735, {1, 1, 0, 1, 3072, 0, 1, 32632})}));
  expect_refused("must cover");
  expect_refused("49.4247");
}

TEST_F(HeightMapFile, WithoutPlaceOrKnownSystemGeoreferencingIsRefused) {
  map.place = sim::HeightMapPlace::georeferenced;
  const Bytes pixels = little_endian(ramp<float>());
  write(".tif", tiff(kColumns, kRows, 32, 3, pixels, {doubles(33550, {3.0, 3.0, 0.0})}));
  expect_refused("no place on Earth");
  write(".tif", tiff(kColumns, kRows, 32, 3, pixels,
                     {doubles(33550, {3.0, 3.0, 0.0}), doubles(33922, {0, 0, 0, 0, 0, 0}),
                      shorts(34735, {1, 1, 0, 1, 3072, 0, 1, 31466})}));
  expect_refused("EPSG 31466");
}

// One arc second a pixel both ways, as the elevation models of the world have it: 20.15 m by 30.89
// m.
TEST_F(HeightMapFile, DegreesBecomeSquareCellsOfMetres) {
  map.place = sim::HeightMapPlace::georeferenced;
  constexpr double kArcSecond = 1.0 / 3600.0;
  constexpr std::uint32_t kSide = 61;
  std::vector<float> heights;  // rises 0.2 m a pixel to the east, falls 0.1 m a pixel to the south
  for (std::uint32_t r = 0; r < kSide; ++r) {
    for (std::uint32_t c = 0; c < kSide; ++c) {
      heights.push_back(100.0F - 0.1F * static_cast<float>(r) + 0.2F * static_cast<float>(c));
    }
  }
  // The middle of the middle pixel is the rig's origin.
  write(".tif", tiff(kSide, kSide, 32, 3, little_endian(heights),
                     {doubles(33550, {kArcSecond, kArcSecond, 0.0}),
                      doubles(33922, {0, 0, 0, kOrigin.longitude_deg - 30.5 * kArcSecond,
                                      kOrigin.latitude_deg + 30.5 * kArcSecond, 0}),
                      shorts(34735, {1, 1, 0, 1, 2048, 0, 1, 4326})}));
  const auto field = load();
  EXPECT_NEAR(field->cell_m, 20.15, 0.01);
  const auto height = [&](double east_m, double north_m) {
    const double c = (east_m - field->origin_m.x()) / field->cell_m;
    const double r = (north_m - field->origin_m.y()) / field->cell_m;
    const auto c0 = static_cast<std::size_t>(c);
    const auto r0 = static_cast<std::size_t>(r);
    const double right = c - static_cast<double>(c0);
    const double up = r - static_cast<double>(r0);
    return (1 - up) * ((1 - right) * field->node(c0, r0) + right * field->node(c0 + 1, r0)) +
           up * ((1 - right) * field->node(c0, r0 + 1) + right * field->node(c0 + 1, r0 + 1));
  };
  EXPECT_NEAR(height(0.0, 0.0), 103.0, 0.01);
  // Ten seconds of arc to the east, and to the north, by the lengths of WGS 84.
  EXPECT_NEAR(height(201.46, 0.0), 105.0, 0.01);
  EXPECT_NEAR(height(0.0, 308.92), 104.0, 0.01);
  EXPECT_NEAR(height(-402.9, -617.8), 97.0, 0.02);
}

TEST_F(HeightMapFile, PixelsThatAreTooNarrowAreRefused) {
  map.place = sim::HeightMapPlace::georeferenced;
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()),
                     {doubles(33550, {1e-9, 1e-3, 0.0}),
                      doubles(33922, {0, 0, 0, kOrigin.longitude_deg - 2.5e-9,
                                      kOrigin.latitude_deg + 2e-3, 0}),
                      shorts(34735, {1, 1, 0, 1, 2048, 0, 1, 4326})}));
  expect_refused("square cells");
}

TEST_F(HeightMapFile, GapsAreRefusedOrFilled) {
  std::vector<float> values = ramp<float>();
  values[7] = -9999.0F;
  values[8] = std::numeric_limits<float>::quiet_NaN();
  write(".tif", tiff(kColumns, kRows, 32, 3, little_endian(values),
                     {doubles(33550, {3.0, 3.0, 0.0}), tests::text(42113, "-9999")}));
  expect_refused("2 of 20 pixels have no height");
  map.fill_gaps = true;
  const auto field = load();
  EXPECT_DOUBLE_EQ(field->node(2, 2), 0.0) << "the lowest";
  EXPECT_DOUBLE_EQ(field->node(3, 2), 0.0);
  EXPECT_DOUBLE_EQ(field->node(4, 2), 14.0);
}

TEST_F(HeightMapFile, BadFilesAreNamedWithWhatIsWrong) {
  map.file = "/nowhere/dem.tif";
  expect_refused("no such file");
  map.file = "/nowhere/dem.png";
  expect_refused("no such file");
  write(".png", {'h', 'e', 'l', 'l', 'o'});
  expect_refused("no PNG");
  Bytes cut = tests::png(kColumns, kRows, 8, 1, ramp<std::uint16_t>());
  cut.resize(cut.size() - 30);
  write(".png", cut);
  expect_refused("damaged");
  write(".png", tests::png(kColumns, kRows, 8, 1, ramp<std::uint16_t>()));
  expect_refused("size of its pixels");
  write(".tif", {'h', 'e', 'l', 'l', 'o'});
  expect_refused("cannot be read as TIFF");
  const Bytes whole = tiff(kColumns, kRows, 32, 3, little_endian(ramp<float>()), {});
  write(".tif", whole);
  expect_refused("size of its pixels");
  write(".tif", tiff(kColumns, 400, 32, 3, Bytes(80), {}));
  expect_refused("damaged or ends early");
  write(".tif", tiff(kColumns, kRows, 32, 5, little_endian(ramp<float>()), {}));
  expect_refused("format 5");
  write(".tif", tiff(1, 1, 8, 1, {1}, {}));
  expect_refused("1 x 1");
}

}  // namespace
}  // namespace rigwire::hil
