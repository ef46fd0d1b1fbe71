#include "sim/weather/air_fault.h"

#include <limits>

#include "sim/weather/scene_weather.h"

namespace rigwire::sim {

using fields::in;

void FogFault::grow(double share) {
  visibility_m = share > 0.0 ? visibility_m / share : std::numeric_limits<double>::infinity();
}

void visit(fields::Visitor& v, RainFault& p) {
  v.number("rate", p.rate_mmph, in("mm/h").stored_as("mm/h").above(0).at_most(200),
           "Rate of rainfall.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, SnowFault& p) {
  v.number("rate", p.rate_mmph, in("mm/h").stored_as("mm/h").above(0).at_most(50),
           "Rate of snowfall, as water.");
  visit_ramp(v, p.ramp);
}

void visit(fields::Visitor& v, FogFault& p) {
  v.number("visibility", p.visibility_m, in("m").between(5, 10'000),
           "Meteorological optical range: there 5 % of the light is left.");
  visit_ramp(v, p.ramp);
}

void AirFaults::apply(const FaultChange<AirFault>& change) {
  const std::scoped_lock lock(mutex_);
  change.apply(book_);
}

void AirFaults::lay_over(SimTime time, AirState& state) const {
  const std::scoped_lock lock(mutex_);
  book_.each(time, [&](const AirFault& fault) {
    std::visit(
        [&]<class What>(const What& what) {
          const What present = grown(what, fault.when, time);
          if constexpr (std::is_same_v<What, RainFault>) {
            state.rain_mmph += present.rate_mmph;
          } else if constexpr (std::is_same_v<What, SnowFault>) {
            state.snow_mmph += present.rate_mmph;
          } else {
            state.inverse_fog_visibility_pm += 1.0 / present.visibility_m;
          }
        },
        fault.what);
  });
}

}  // namespace rigwire::sim
