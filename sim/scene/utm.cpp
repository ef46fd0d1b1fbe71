#include "sim/scene/utm.h"

#include <GeographicLib/UTMUPS.hpp>
#include <stdexcept>
#include <string>

namespace rigwire::sim {

UtmPlace utm_place(double latitude_deg, double longitude_deg, int zone, bool north) {
  constexpr double kSouthernFalseNorthing_m = 10e6;
  try {
    int found_zone = 0;
    bool found_north = false;
    double convergence_deg = 0.0;
    UtmPlace place;
    GeographicLib::UTMUPS::Forward(latitude_deg, longitude_deg, found_zone, found_north,
                                   place.easting_m, place.northing_m, convergence_deg,
                                   place.grid_scale, zone);
    if (found_north != north) {
      place.northing_m += north ? -kSouthernFalseNorthing_m : kSouthernFalseNorthing_m;
    }
    return place;
  } catch (const GeographicLib::GeographicErr& error) {
    throw std::invalid_argument("latitude " + std::to_string(latitude_deg) + ", longitude " +
                                std::to_string(longitude_deg) + " is not near UTM zone " +
                                std::to_string(zone) + ": " + error.what());
  }
}

}  // namespace rigwire::sim
