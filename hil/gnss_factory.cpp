#include "hil/gnss_factory.h"

namespace rigwire::hil {

sim::LocalFrame make_local_frame(const OriginConfiguration& origin) {
  return sim::LocalFrame(
      {origin.latitude_deg, origin.longitude_deg, origin.height_m, origin.geoid_separation_m});
}

sim::GnssSensor make_gnss_sensor(const RigConfiguration& rig, const sim::GnssParameters& parameters,
                                 const sim::LocalFrame& frame, std::string_view name) {
  return {parameters, Calendar(rig.start), frame, rig.seed, name};
}

}  // namespace rigwire::hil
