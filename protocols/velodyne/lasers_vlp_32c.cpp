// VLP-32C: user's manual 63-9325 Rev. B, tables 9-2 (elevations) and 9-6 (azimuth offsets).
// Heights: 42.4 mm * tan(-elevation), the common focus of the beams in the envelope drawing. Lasers
// fire in pairs.
#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

// Elevation deg, azimuth offset deg, vertical offset mm.
constexpr std::array<Laser, 32> kRows{{
    {-25.000, 1.4, 19.77}, {-1.000, -4.2, 0.74},   {-1.667, 1.4, 1.23},  {-15.639, -1.4, 11.87},
    {-11.310, 1.4, 8.48},  {0.000, -1.4, 0.00},    {-0.667, 4.2, 0.49},  {-8.843, -1.4, 6.60},
    {-7.254, 1.4, 5.40},   {0.333, -4.2, -0.25},   {-0.333, 1.4, 0.25},  {-6.148, -1.4, 4.57},
    {-5.333, 4.2, 3.96},   {1.333, -1.4, -0.99},   {0.667, 4.2, -0.49},  {-4.000, -1.4, 2.96},
    {-4.667, 1.4, 3.46},   {1.667, -4.2, -1.23},   {1.000, 1.4, -0.74},  {-3.667, -4.2, 2.72},
    {-3.333, 4.2, 2.47},   {3.333, -1.4, -2.47},   {2.333, 1.4, -1.73},  {-2.667, -1.4, 1.98},
    {-3.000, 1.4, 2.22},   {7.000, -1.4, -5.21},   {4.667, 1.4, -3.46},  {-2.333, -4.2, 1.73},
    {-2.000, 4.2, 1.48},   {15.000, -1.4, -11.36}, {10.333, 1.4, -7.73}, {-1.333, -1.4, 0.99},
}};

constexpr std::int32_t fires_at_ns(std::int32_t laser) {
  return laser / 2 * 2304;
}

}  // namespace

constexpr std::array<Laser, 32> kVlp32cLasers = timed(kRows, fires_at_ns);

}  // namespace rigwire::protocols::velodyne
