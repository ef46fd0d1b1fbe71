// Keys of sim/integration_scheme.h.
#pragma once

#include <array>

#include "fields/visitor.h"
#include "sim/integration_scheme.h"

namespace rigwire::sim {

inline constexpr std::array<fields::Choice<sim::IntegrationScheme>, 3> kIntegrationSchemes{
    {{sim::IntegrationScheme::linearly_implicit_euler, "linearly_implicit_euler",
      "Stable for every stiffness that is let pass."},
     {sim::IntegrationScheme::rosenbrock2, "rosenbrock2", "Second order, for comparison."},
     {sim::IntegrationScheme::runge_kutta4, "runge_kutta4",
      "Fourth order, for comparison; short steps only."}}};

}  // namespace rigwire::sim
