// How well a lidar measures, and by which model.
#pragma once

#include "hil/configuration/fields.h"
#include "hil/configuration/units.h"
#include "sim/lidar/spinning_lidar.h"

namespace rigwire::hil {

template <class Visitor>
void visit(Visitor& v, sim::SpinningLidarParameters& p) {
  v.number("range_sigma", p.range_sigma_m, in("mm").between(0, 1000), "Gaussian, per shot.");
  v.number("housing_radius", p.housing_radius_m, in("mm").between(0, 1000), "Where rays begin.");
  v.integer("threads", p.threads, IntegerRule{1, 256}, "That cast rays; results do not change.");
}

}  // namespace rigwire::hil
