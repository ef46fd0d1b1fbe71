// HDL-32E: optical drawing 86-0106 (elevations, heights), user's manual 63-9113 Rev. H, "Laser
// firing sequence". The heights obey 28.83 mm * tan(-elevation).
#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

// Elevation deg, azimuth offset deg, vertical offset mm.
constexpr std::array<Laser, 32> kRows{{
    {-30.67, 0.0, 17.17}, {-9.33, 0.0, 4.76}, {-29.33, 0.0, 16.27}, {-8.00, 0.0, 4.07},
    {-28.00, 0.0, 15.40}, {-6.67, 0.0, 3.38}, {-26.67, 0.0, 14.54}, {-5.33, 0.0, 2.70},
    {-25.33, 0.0, 13.71}, {-4.00, 0.0, 2.02}, {-24.00, 0.0, 12.89}, {-2.67, 0.0, 1.35},
    {-22.67, 0.0, 12.09}, {-1.33, 0.0, 0.67}, {-21.33, 0.0, 11.31}, {0.00, 0.0, 0.00},
    {-20.00, 0.0, 10.54}, {1.33, 0.0, -0.67}, {-18.67, 0.0, 9.78},  {2.67, 0.0, -1.35},
    {-17.33, 0.0, 9.04},  {4.00, 0.0, -2.02}, {-16.00, 0.0, 8.30},  {5.33, 0.0, -2.70},
    {-14.67, 0.0, 7.58},  {6.67, 0.0, -3.38}, {-13.33, 0.0, 6.86},  {8.00, 0.0, -4.07},
    {-12.00, 0.0, 6.15},  {9.33, 0.0, -4.76}, {-10.67, 0.0, 5.45},  {10.67, 0.0, -5.45},
}};

constexpr std::int32_t fires_at_ns(std::int32_t laser) {
  return laser * 1152;
}

}  // namespace

constexpr std::array<Laser, 32> kHdl32eLasers = timed(kRows, fires_at_ns);

}  // namespace rigwire::protocols::velodyne
