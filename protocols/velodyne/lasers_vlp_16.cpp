// VLP-16 (and Puck LITE): user's manual 63-9243 Rev. D, section 9.2; envelope drawing 86-0101.
// Puck Hi-Res: the same manual's table of that model; envelope drawing 86-0129. Its printed heights
// grow evenly from laser to laser and obey no common focus.
#include "protocols/velodyne/laser_tables.h"

namespace rigwire::protocols::velodyne {
namespace {

// Elevation deg, azimuth offset deg, vertical offset mm.
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

constexpr std::int32_t fires_at_ns(std::int32_t laser) {
  return laser * 2304;
}

}  // namespace

constexpr std::array<Laser, 16> kVlp16Lasers = timed(kVlp16Rows, fires_at_ns);
constexpr std::array<Laser, 16> kPuckHiResLasers = timed(kPuckHiResRows, fires_at_ns);

}  // namespace rigwire::protocols::velodyne
