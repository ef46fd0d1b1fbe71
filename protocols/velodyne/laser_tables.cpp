#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

/// The rows with the time of each laser filled in: `fires_at_ns(laser)`, after the first laser.
template <std::size_t Count, class FiresAt>
constexpr std::array<Laser, Count> timed(std::array<Laser, Count> rows, FiresAt fires_at_ns) {
  for (std::size_t laser = 0; laser < Count; ++laser) {
    rows[laser].time_offset_ns = fires_at_ns(static_cast<std::int32_t>(laser));
  }
  return rows;
}

// Rows: elevation deg, azimuth offset deg, vertical offset mm.

// HDL-32E: optical drawing 86-0106 (elevations, heights), user's manual 63-9113 Rev. H, "Laser
// firing sequence". The heights obey 28.83 mm * tan(-elevation).

constexpr std::array<Laser, 32> kHdl32eRows{{
    {-30.67, 0.0, 17.17}, {-9.33, 0.0, 4.76}, {-29.33, 0.0, 16.27}, {-8.00, 0.0, 4.07},
    {-28.00, 0.0, 15.40}, {-6.67, 0.0, 3.38}, {-26.67, 0.0, 14.54}, {-5.33, 0.0, 2.70},
    {-25.33, 0.0, 13.71}, {-4.00, 0.0, 2.02}, {-24.00, 0.0, 12.89}, {-2.67, 0.0, 1.35},
    {-22.67, 0.0, 12.09}, {-1.33, 0.0, 0.67}, {-21.33, 0.0, 11.31}, {0.00, 0.0, 0.00},
    {-20.00, 0.0, 10.54}, {1.33, 0.0, -0.67}, {-18.67, 0.0, 9.78},  {2.67, 0.0, -1.35},
    {-17.33, 0.0, 9.04},  {4.00, 0.0, -2.02}, {-16.00, 0.0, 8.30},  {5.33, 0.0, -2.70},
    {-14.67, 0.0, 7.58},  {6.67, 0.0, -3.38}, {-13.33, 0.0, 6.86},  {8.00, 0.0, -4.07},
    {-12.00, 0.0, 6.15},  {9.33, 0.0, -4.76}, {-10.67, 0.0, 5.45},  {10.67, 0.0, -5.45},
}};

constexpr std::int32_t hdl_32e_fires_at_ns(std::int32_t laser) {
  return laser * 1152;
}

// VLP-16 (and Puck LITE): user's manual 63-9243 Rev. D, section 9.2; envelope drawing 86-0101.
// Puck Hi-Res: the same manual's table of that model; envelope drawing 86-0129. Its printed heights
// grow evenly from laser to laser and obey no common focus.

constexpr std::array<Laser, 16> kVlp16Rows{{
    {-15.0, 0.0, 11.2},
    {1.0, 0.0, -0.7},
    {-13.0, 0.0, 9.7},
    {3.0, 0.0, -2.2},
    {-11.0, 0.0, 8.1},
    {5.0, 0.0, -3.7},
    {-9.0, 0.0, 6.6},
    {7.0, 0.0, -5.1},
    {-7.0, 0.0, 5.1},
    {9.0, 0.0, -6.6},
    {-5.0, 0.0, 3.7},
    {11.0, 0.0, -8.1},
    {-3.0, 0.0, 2.2},
    {13.0, 0.0, -9.7},
    {-1.0, 0.0, 0.7},
    {15.0, 0.0, -11.2},
}};
constexpr std::array<Laser, 16> kPuckHiResRows{{
    {-10.000, 0.0, 7.4},
    {0.667, 0.0, -0.9},
    {-8.667, 0.0, 6.5},
    {2.000, 0.0, -1.8},
    {-7.333, 0.0, 5.5},
    {3.333, 0.0, -2.7},
    {-6.000, 0.0, 4.6},
    {4.667, 0.0, -3.7},
    {-4.667, 0.0, 3.7},
    {6.000, 0.0, -4.6},
    {-3.333, 0.0, 2.7},
    {7.333, 0.0, -5.5},
    {-2.000, 0.0, 1.8},
    {8.667, 0.0, -6.5},
    {-0.667, 0.0, 0.9},
    {10.000, 0.0, -7.4},
}};

constexpr std::int32_t vlp_16_fires_at_ns(std::int32_t laser) {
  return laser * 2304;
}

// VLP-32C: user's manual 63-9325 Rev. B, tables 9-2 (elevations) and 9-6 (azimuth offsets).
// Heights: 42.4 mm * tan(-elevation), the common focus of the beams in the envelope drawing. Lasers
// fire in pairs.

constexpr std::array<Laser, 32> kVlp32cRows{{
    {-25.000, 1.4, 19.77}, {-1.000, -4.2, 0.74},   {-1.667, 1.4, 1.23},  {-15.639, -1.4, 11.87},
    {-11.310, 1.4, 8.48},  {0.000, -1.4, 0.00},    {-0.667, 4.2, 0.49},  {-8.843, -1.4, 6.60},
    {-7.254, 1.4, 5.40},   {0.333, -4.2, -0.25},   {-0.333, 1.4, 0.25},  {-6.148, -1.4, 4.57},
    {-5.333, 4.2, 3.96},   {1.333, -1.4, -0.99},   {0.667, 4.2, -0.49},  {-4.000, -1.4, 2.96},
    {-4.667, 1.4, 3.46},   {1.667, -4.2, -1.23},   {1.000, 1.4, -0.74},  {-3.667, -4.2, 2.72},
    {-3.333, 4.2, 2.47},   {3.333, -1.4, -2.47},   {2.333, 1.4, -1.73},  {-2.667, -1.4, 1.98},
    {-3.000, 1.4, 2.22},   {7.000, -1.4, -5.21},   {4.667, 1.4, -3.46},  {-2.333, -4.2, 1.73},
    {-2.000, 4.2, 1.48},   {15.000, -1.4, -11.36}, {10.333, 1.4, -7.73}, {-1.333, -1.4, 0.99},
}};

constexpr std::int32_t vlp_32c_fires_at_ns(std::int32_t laser) {
  return laser / 2 * 2304;
}

// HDL-64E: nominal tables. A real unit is described by its calibration (hdl_64e_calibration.h), and
// so is an emulated one; these figures apply where no calibration is given.
//
// Elevations: data sheet, upper bank +2 to -8.33 degrees in thirds, lower bank -8.83 to -24.33 in
// halves. Common to the calibrations that are published for S2.1 and S3 units are the elevation and
// column of each laser (laser numbers in the order of firing, two and two from alternating parts of
// the bank; columns repeat every twelve heights), the mean heights of the banks and the offset to
// the side. Times: S2.1 and S3 manuals, "Laser firing time table"; the two banks fire together.

constexpr std::size_t kBank = 32;

/// From the top, within a bank: how many lasers look higher than this one.
constexpr std::array<std::uint8_t, kBank> kRank{27, 26, 5,  4,  25, 24, 31, 30, 23, 22, 29,
                                                28, 15, 14, 21, 20, 13, 12, 19, 18, 11, 10,
                                                17, 16, 3,  2,  9,  8,  1,  0,  7,  6};

/// Azimuth offsets by rank modulo twelve, clockwise.
using Columns = std::array<double, 12>;
constexpr Columns kWideColumns_deg{-2.6, 0.7, 3.9, 7.2, -7.9, -4.7,
                                   -1.4, 1.9, 5.1, 8.3, -9.1, -5.8};
constexpr Columns kNarrowColumns_deg{-2.1, 0.1, 2.2, 4.4, -5.6, -3.4,
                                     -1.3, 0.9, 3.0, 5.2, -6.4, -4.2};

/// Beams of even lasers leave on the left, of odd ones on the right of the rotor's middle.
constexpr double kHorizontalOffset_mm = 26.0;

struct Bank {
  double top_deg;
  double pitch_deg;
  Columns columns_deg;
  double height_mm;
};

constexpr std::array<Laser, 64> hdl_64e_rows(const Bank& upper, const Bank& lower) {
  std::array<Laser, 64> lasers{};
  for (std::size_t laser = 0; laser < lasers.size(); ++laser) {
    const Bank& bank = laser < kBank ? upper : lower;
    const std::size_t rank = kRank[laser % kBank];
    lasers[laser] = {
        .elevation_deg = bank.top_deg - bank.pitch_deg * static_cast<double>(rank),
        .azimuth_offset_deg = bank.columns_deg[rank % bank.columns_deg.size()],
        .vertical_offset_mm = bank.height_mm,
        .horizontal_offset_mm = laser % 2 == 0 ? -kHorizontalOffset_mm : kHorizontalOffset_mm};
  }
  return lasers;
}

constexpr double kThird = 1.0 / 3.0;
constexpr double kLowerTop_deg = -8.0 - 5.0 / 6.0;

/// Eight groups of four in each bank.
constexpr std::int32_t s2_fires_at_ns(std::int32_t laser) {
  constexpr std::array<std::int32_t, 4> kWithinGroup_ns{0, 1260, 2460, 3660};
  return laser % 32 / 4 * 6000 + kWithinGroup_ns[static_cast<std::size_t>(laser % 4)];
}

constexpr std::int32_t s3_fires_at_ns(std::int32_t laser) {
  constexpr std::array<std::int32_t, 4> kWithinGroup_ns{0, 1300, 2500, 3700};
  return laser % 32 / 4 * 7200 + kWithinGroup_ns[static_cast<std::size_t>(laser % 4)];
}

// VLS-128 (Alpha Prime): user's manual 63-9483 Rev. A (draft), section 9.3 and figure 9-8; the
// figures are those of the calibration that the maker publishes for this model in VeloView.
// Heights: 58.63 mm * tan(-elevation), the common focus of its beams.

// Eight to a group.
constexpr std::array<Laser, 128> kVls128Rows{{
    {-11.742, 6.354, 12.19},  {-1.990, 4.548, 2.04},   {3.400, 2.732, -3.48},
    {-5.290, 0.911, 5.43},    {-0.780, -0.911, 0.80},  {4.610, -2.732, -4.73},
    {-4.080, -4.548, 4.18},   {1.310, -6.354, -1.34},  {-6.500, 6.354, 6.68},
    {-1.110, 4.548, 1.14},    {4.280, 2.732, -4.39},   {-4.410, 0.911, 4.52},
    {0.100, -0.911, -0.10},   {6.480, -2.732, -6.66},  {-3.200, -4.548, 3.28},
    {2.190, -6.354, -2.24},   {-3.860, 6.354, 3.96},   {1.530, 4.548, -1.57},
    {-9.244, 2.732, 9.54},    {-1.770, 0.911, 1.81},   {2.740, -0.911, -2.81},
    {-5.950, -2.732, 6.11},   {-0.560, -4.548, 0.57},  {4.830, -6.354, -4.95},
    {-2.980, 6.354, 3.05},    {2.410, 4.548, -2.47},   {-6.280, 2.732, 6.45},
    {-0.890, 0.911, 0.91},    {3.620, -0.911, -3.71},  {-5.070, -2.732, 5.20},
    {0.320, -4.548, -0.33},   {7.580, -6.354, -7.80},  {-0.340, 6.354, 0.35},
    {5.180, 4.548, -5.32},    {-3.640, 2.732, 3.73},   {1.750, 0.911, -1.79},
    {-25.000, -0.911, 27.34}, {-2.430, -2.732, 2.49},  {2.960, -4.548, -3.03},
    {-5.730, -6.354, 5.88},   {0.540, 6.354, -0.55},   {9.700, 4.548, -10.02},
    {-2.760, 2.732, 2.83},    {2.630, 0.911, -2.69},   {-7.650, -0.911, 7.87},
    {-1.550, -2.732, 1.59},   {3.840, -4.548, -3.94},  {-4.850, -6.354, 4.97},
    {3.180, 6.354, -3.26},    {-5.510, 4.548, 5.66},   {-0.120, 2.732, 0.12},
    {5.730, 0.911, -5.88},    {-4.300, -0.911, 4.41},  {1.090, -2.732, -1.12},
    {-16.042, -4.548, 16.86}, {-2.210, -6.354, 2.26},  {4.060, 6.354, -4.16},
    {-4.630, 4.548, 4.75},    {0.760, 2.732, -0.78},   {15.000, 0.911, -15.71},
    {-3.420, -0.911, 3.50},   {1.970, -2.732, -2.02},  {-6.850, -4.548, 7.04},
    {-1.330, -6.354, 1.36},   {-5.620, 6.354, 5.77},   {-0.230, 4.548, 0.24},
    {5.430, 2.732, -5.57},    {-3.530, 0.911, 3.62},   {0.980, -0.911, -1.00},
    {-19.582, -2.732, 20.86}, {-2.320, -4.548, 2.38},  {3.070, -6.354, -3.14},
    {-4.740, 6.354, 4.86},    {0.650, 4.548, -0.67},   {11.750, 2.732, -12.20},
    {-2.650, 0.911, 2.71},    {1.860, -0.911, -1.90},  {-7.150, -2.732, 7.35},
    {-1.440, -4.548, 1.47},   {3.950, -6.354, -4.05},  {-2.100, 6.354, 2.15},
    {3.290, 4.548, -3.37},    {-5.400, 2.732, 5.54},   {-0.010, 0.911, 0.01},
    {4.500, -0.911, -4.61},   {-4.190, -2.732, 4.30},  {1.200, -4.548, -1.23},
    {-13.565, -6.354, 14.15}, {-1.220, 6.354, 1.25},   {4.170, 4.548, -4.27},
    {-4.520, 2.732, 4.63},    {0.870, 0.911, -0.89},   {6.080, -0.911, -6.25},
    {-3.310, -2.732, 3.39},   {2.080, -4.548, -2.13},  {-6.650, -6.354, 6.84},
    {1.420, 6.354, -1.45},    {-10.346, 4.548, 10.70}, {-1.880, 2.732, 1.92},
    {3.510, 0.911, -3.60},    {-6.060, -0.911, 6.22},  {-0.670, -2.732, 0.69},
    {4.720, -4.548, -4.84},   {-3.970, -6.354, 4.07},  {2.300, 6.354, -2.35},
    {-6.390, 4.548, 6.57},    {-1.000, 2.732, 1.02},   {4.390, 0.911, -4.50},
    {-5.180, -0.911, 5.32},   {0.210, -2.732, -0.21},  {6.980, -4.548, -7.18},
    {-3.090, -6.354, 3.17},   {4.980, 6.354, -5.11},   {-3.750, 4.548, 3.84},
    {1.640, 2.732, -1.68},    {-8.352, 0.911, 8.61},   {-2.540, -0.911, 2.60},
    {2.850, -2.732, -2.92},   {-5.840, -4.548, 6.00},  {-0.450, -6.354, 0.46},
    {8.430, 6.354, -8.69},    {-2.870, 4.548, 2.94},   {2.520, 2.732, -2.58},
    {-6.170, 0.911, 6.34},    {-1.660, -0.911, 1.70},  {3.730, -2.732, -3.82},
    {-4.960, -4.548, 5.09},   {0.430, -6.354, -0.44},
}};

/// Eight at once, each in a column of its own. After eight groups the sensor pauses for the time of
/// one group.
template <std::int32_t kGroup_ns>
constexpr std::int32_t vls_128_fires_at_ns(std::int32_t laser) {
  return (laser / 8 + laser / 64) * kGroup_ns;
}

}  // namespace

constexpr std::array<Laser, 32> kHdl32eLasers = timed(kHdl32eRows, hdl_32e_fires_at_ns);
constexpr std::array<Laser, 16> kVlp16Lasers = timed(kVlp16Rows, vlp_16_fires_at_ns);
constexpr std::array<Laser, 16> kPuckHiResLasers = timed(kPuckHiResRows, vlp_16_fires_at_ns);
constexpr std::array<Laser, 32> kVlp32cLasers = timed(kVlp32cRows, vlp_32c_fires_at_ns);
constexpr std::array<Laser, 64> kHdl64eS2Lasers =
    timed(hdl_64e_rows({2.0, kThird, kWideColumns_deg, 203.0},
                       {kLowerTop_deg, 0.5, kWideColumns_deg, 115.0}),
          s2_fires_at_ns);

constexpr std::array<Laser, 64> kHdl64eS3Lasers =
    timed(hdl_64e_rows({2.0, kThird, kNarrowColumns_deg, 210.0},
                       {kLowerTop_deg, 0.5, kWideColumns_deg, 153.0}),
          s3_fires_at_ns);
constexpr std::array<Laser, 128> kVls128Lasers =
    timed(kVls128Rows, vls_128_fires_at_ns<kVls128Group_ns>);
constexpr std::array<Laser, 128> kVls128LasersUntil517 =
    timed(kVls128Rows, vls_128_fires_at_ns<kVls128GroupUntil517_ns>);

}  // namespace rigwire::protocols::velodyne
