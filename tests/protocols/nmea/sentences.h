// What the tests of sentences share.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "protocols/nmea/epoch.h"
#include "protocols/nmea/sentence.h"

namespace rigwire::protocols::nmea {

inline std::string text(Sentence sentence) {
  return std::string(sentence.text());
}

inline std::span<const std::uint8_t> bytes_of(const std::string& s) {
  return {reinterpret_cast<const std::uint8_t*>(s.data()), s.size()};
}

// An epoch recorded from a NEO-7P.
inline Epoch recorded_epoch(std::vector<SatelliteInView>& satellites) {
  for (const int number : {3, 23, 10, 7, 27, 32, 48, 51, 30, 16, 9}) {
    satellites.push_back({number, 10, 20, 30, true});
  }
  Epoch epoch;
  epoch.time = TimeOfDay{19, 53, 18, 0};
  epoch.date = Date{2015, 4, 3};
  epoch.fix_dimensions = 3;
  epoch.differential = true;
  epoch.latitude_deg = 34.0 + 1.21530 / 60.0;
  epoch.longitude_deg = -(118.0 + 17.41346 / 60.0);
  epoch.altitude_m = 86.1;
  epoch.separation_m = -32.8;
  epoch.ground_speed_mps = 0.039 * 1852.0 / 3600.0;
  epoch.satellites_used = 11;
  epoch.position_dilution = 2.59;
  epoch.horizontal_dilution = 1.37;
  epoch.vertical_dilution = 2.19;
  epoch.satellites = satellites;
  return epoch;
}

}  // namespace rigwire::protocols::nmea
