// Satellite receivers' physics from the configuration of a rig.
#pragma once

#include <string_view>

#include "hil/configuration/rig.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/local_frame.h"

namespace rigwire::hil {

[[nodiscard]] sim::LocalFrame make_local_frame(const OriginConfiguration& origin);

/// The sensor of the receiver `name`. Throws std::invalid_argument for parameters out of range.
[[nodiscard]] sim::GnssSensor make_gnss_sensor(const RigConfiguration& rig,
                                               const sim::GnssParameters& parameters,
                                               const sim::LocalFrame& frame, std::string_view name);

}  // namespace rigwire::hil
