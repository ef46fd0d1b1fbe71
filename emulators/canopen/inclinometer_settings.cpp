// Keys and checks of the inclinometer's settings.
#include <string>

#include "emulators/canopen/inclinometer.h"
#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using fields::IntegerRule;

void visit(fields::Visitor& v, InclinometerSettings& p) {
  visit_canopen(v, p.node, p.transmission_type, p.event_timer_ms, p.heartbeat_ms, p.serial);
  v.integer(
      "resolution", p.resolution_mdeg,
      IntegerRule{canopen::kSlopeResolutions_mdeg.front(), canopen::kSlopeResolutions_mdeg.back()},
      "Thousandths of a degree in one count of a slope: 1, 10, 100 or 1000.");
  v.check(canopen::is_slope_resolution(p.resolution_mdeg), "resolution", "not a power of ten",
          std::to_string(p.resolution_mdeg), "1, 10, 100, 1000");
  v.integer("filter", p.filter_step, IntegerRule{0, canopen::kFilterCutOffs_hz.size() - 1},
            "Low-pass on the force: 0 = none, 1 .. 4 = cut off at 10, 5, 1, 0.5 Hz.");
  v.integer("quadrants", p.quadrants, IntegerRule{0, canopen::QuadrantCorrection::kFullTurn},
            "Slopes that it tells apart: 0 = -90 .. 90, 1 = -180 .. 180, 2 = 0 .. 360 deg.");
  v.number("range", p.range_rad, fields::in("deg").above(0).at_most(180),
           "Greatest slope to either side; an axis beyond it is not valid.");
  v.integer("product", p.product, IntegerRule{0, 0xFFFFFFFF},
            "Product code that its identity object tells.");
  v.duration("sampling", p.sampling, {100'000, 1'000'000'000},
             "Time between two readings of the force.");
  visit(v, p.supply);
}

void validate(const InclinometerSettings& settings) {
  fields::check(settings);
  validate(settings.supply);
  validate(settings.node);
}

}  // namespace rigwire::emulators
