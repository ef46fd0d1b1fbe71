#include "hil/files/geoid_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// The points that NGA publishes with its program for the 15' grid (INPUT.DAT, OUTPUT.DAT of
/// EGM96), heights by a spline through the grid.
struct PublishedPoint {
  double latitude_deg;
  double longitude_deg;
  double height_m;
};
constexpr PublishedPoint kPublished[] = {
    {38.6281550, 269.7791550, -31.628}, {-14.6212170, 305.0211140, -2.969},
    {46.8743190, 102.4487290, -43.575}, {-23.6174460, 133.8747120, 15.871},
    {38.6254730, 359.9995000, 50.066},  {-0.4667440, 0.0023000, 17.329}};

class Egm96 : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(fs::exists(kEgm96File)) << "package proj-data is not installed";
  }
};

TEST_F(Egm96, BicubicAgreesWithThePublishedPoints) {
  const auto geoid = load_geoid(kEgm96File, sim::GeoidInterpolation::bicubic);
  for (const PublishedPoint& point : kPublished) {
    EXPECT_NEAR(geoid->separation_m(point.latitude_deg, point.longitude_deg), point.height_m, 0.012)
        << point.latitude_deg << " " << point.longitude_deg;
    EXPECT_NEAR(geoid->separation_m(point.latitude_deg, point.longitude_deg - 360.0),
                point.height_m, 0.012);
  }
}

TEST_F(Egm96, BilinearStaysWithinSixCentimetresOfThem) {
  const auto geoid = load_geoid(kEgm96File);
  for (const PublishedPoint& point : kPublished) {
    EXPECT_NEAR(geoid->separation_m(point.latitude_deg, point.longitude_deg), point.height_m, 0.06);
  }
}

TEST_F(Egm96, PolesAreWhereTheModelHasThem) {
  const auto geoid = load_geoid(kEgm96File);
  for (const double longitude_deg : {-180.0, -77.7, 0.0, 123.4, 180.0, 359.9}) {
    EXPECT_NEAR(geoid->separation_m(90.0, longitude_deg), 13.606, 1e-3);
    EXPECT_NEAR(geoid->separation_m(-90.0, longitude_deg), -29.534, 1e-3);
  }
}

class GeoidFile : public ::testing::Test {
 protected:
  void TearDown() override { fs::remove(file); }

  static void append(std::string& bytes, std::uint64_t value, int count) {
    for (int i = count - 1; i >= 0; --i) {
      bytes += static_cast<char>(value >> (8 * i));
    }
  }
  static void append(std::string& bytes, double value) {
    append(bytes, std::bit_cast<std::uint64_t>(value), 8);
  }
  static void append(std::string& bytes, float value) {
    append(bytes, std::bit_cast<std::uint32_t>(value), 4);
  }
  static std::string header(double south, double west, double step, std::uint32_t rows,
                            std::uint32_t columns) {
    std::string bytes;
    for (const double value : {south, west, step, step}) {
      append(bytes, value);
    }
    append(bytes, rows, 4);
    append(bytes, columns, 4);
    return bytes;
  }
  std::string refusal(const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      (void)load_geoid(file);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  }

  fs::path file = fs::temp_directory_path() / ("rigwire-geoid-" + std::to_string(::getpid()));
};

TEST_F(GeoidFile, RowsRunNorthAndColumnsEast) {
  std::string bytes = header(40.0, 5.0, 1.0, 2, 3);
  for (const float height : {1.0F, 2.0F, 3.0F, 11.0F, 12.0F, 13.0F}) {
    append(bytes, height);
  }
  std::ofstream(file, std::ios::binary) << bytes;
  const auto geoid = load_geoid(file);
  EXPECT_DOUBLE_EQ(geoid->separation_m(40.0, 7.0), 3.0);
  EXPECT_DOUBLE_EQ(geoid->separation_m(41.0, 5.0), 11.0);
  EXPECT_DOUBLE_EQ(geoid->separation_m(40.5, 6.0), 7.0);
}

TEST_F(GeoidFile, MissingFileIsNamed) {
  file = "/nowhere/egm96.gtx";
  try {
    (void)load_geoid(file);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("geoid file /nowhere/egm96.gtx: No such file"));
  }
}

TEST_F(GeoidFile, EveryTruncationIsRefusedWithWhatWasNeeded) {
  std::string whole = header(40.0, 5.0, 1.0, 2, 2);
  for (int i = 0; i < 4; ++i) {
    append(whole, 1.0F);
  }
  EXPECT_EQ(refusal(whole), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THAT(refusal(whole.substr(0, size)), HasSubstr("bytes")) << size;
  }
  EXPECT_THAT(refusal(whole + "x"), HasSubstr("it has 57 bytes, 2 rows of 2 heights need 56"));
}

TEST_F(GeoidFile, AbsurdHeadersAreRefusedBeforeAnyMemoryIsTaken) {
  EXPECT_THAT(refusal(header(40.0, 5.0, 1.0, 0x7FFFFFFF, 0x7FFFFFFF)), HasSubstr("rows is 2147"));
  EXPECT_THAT(refusal(header(40.0, 5.0, 1.0, 0xFFFFFFFF, 2)), HasSubstr("rows is -1"));
  EXPECT_THAT(refusal(header(40.0, 5.0, -1.0, 2, 2)), HasSubstr("step"));
  EXPECT_THAT(refusal(header(1e300, 5.0, 1.0, 2, 2)), HasSubstr("southern edge"));
  EXPECT_THAT(refusal(header(40.0, 5.0, 1.0, 65536, 2)), HasSubstr("northern edge"));
  EXPECT_THAT(refusal(std::string(56, '\xFF')), HasSubstr("geoid file"));
}

}  // namespace
}  // namespace rigwire::hil
