#include "sim/gnss/gnss_parameters.h"

#include <stdexcept>

#include "sim/gnss/parameter_check.h"

namespace rigwire::sim {

bool GnssSystems::receives(GnssSystem system) const {
  switch (system) {
    case GnssSystem::gps:
      return gps;
    case GnssSystem::glonass:
      return glonass;
    case GnssSystem::galileo:
      return galileo;
    case GnssSystem::beidou:
      return beidou;
    case GnssSystem::sbas:
      return sbas;
    case GnssSystem::qzss:
      return qzss;
    case GnssSystem::imes:
      return false;
  }
  return false;
}

void validate(const GnssParameters& p) {
  const GnssSystems& s = p.systems;
  if (!(s.gps || s.glonass || s.galileo || s.beidou || s.sbas || s.qzss)) {
    throw std::invalid_argument("gnss: no system is received, allowed: at least one");
  }
  check_parameter("circular_error_m", p.circular_error_m, 0.0, 1000.0);
  check_parameter("correlation_time_s", p.correlation_time_s, 0.0, 86'400.0);
  check_parameter("speed_sigma_mps", p.speed_sigma_mps, 0.0, 100.0);
  validate(p.clock);
  validate(p.sky);
  validate(p.ranges);
  validate(p.multipath);
  validate(p.corrections);
  for (const GnssFault& fault : p.faults) {
    validate(fault);
  }
}

}  // namespace rigwire::sim
