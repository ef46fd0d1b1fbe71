// Eastings and northings of the transverse Mercator projection's zones.
#pragma once

namespace rigwire::sim {

struct UtmPlace {
  double easting_m = 0.0;
  double northing_m = 0.0;
  double grid_scale = 1.0;  ///< Length in the grid over length on the ellipsoid.
};

/// In a given zone of UTM (1 .. 60) of the northern or southern hemisphere, on WGS 84, by
/// GeographicLib (C. F. F. Karney, "Transverse Mercator with an accuracy of a few nanometers",
/// J. Geodesy 85, 2011). Throws std::invalid_argument when the place is too far from the zone.
[[nodiscard]] UtmPlace utm_place(double latitude_deg, double longitude_deg, int zone, bool north);

}  // namespace rigwire::sim
