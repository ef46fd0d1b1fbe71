// HDL-64E: nominal tables. A real unit is known by its calibration (hdl_64e_calibration.h), and so
// is ours; these figures stand where no calibration is given.
//
// Elevations: data sheet, upper bank +2 to -8.33 degrees in thirds, lower bank -8.83 to -24.33 in
// halves. Which laser looks how high, and its column: common to the calibrations that are published
// for S2.1 and S3 units (laser numbers in the order of firing, two and two from alternating parts
// of the bank; columns repeat every twelve heights). Mean heights of the banks and the offset to
// the side likewise. Times: S2.1 and S3 manuals, "Laser firing time table"; the two banks fire
// together.
#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

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

constexpr std::array<Laser, 64> rows(const Bank& upper, const Bank& lower) {
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

}  // namespace

constexpr std::array<Laser, 64> kHdl64eS2Lasers = timed(
    rows({2.0, kThird, kWideColumns_deg, 203.0}, {kLowerTop_deg, 0.5, kWideColumns_deg, 115.0}),
    s2_fires_at_ns);

constexpr std::array<Laser, 64> kHdl64eS3Lasers = timed(
    rows({2.0, kThird, kNarrowColumns_deg, 210.0}, {kLowerTop_deg, 0.5, kWideColumns_deg, 153.0}),
    s3_fires_at_ns);

}  // namespace rigwire::protocols::velodyne
