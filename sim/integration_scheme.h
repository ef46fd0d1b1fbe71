// How a machine's equations of motion are stepped.
#pragma once

#include <array>
#include <cstdint>

#include "fields/rules.h"

namespace rigwire::sim {

/// The first is for work: it holds for any stiffness that a machine's validate lets pass. The
/// others serve comparison. Which levels know them: each machine's parameters.
enum class IntegrationScheme : std::uint8_t {
  linearly_implicit_euler,  ///< First order.
  rosenbrock2,   ///< Second order: ROS2 of Verwer et al., SIAM J. Sci. Comput. 20 (1999) 1456;
                 ///< gamma = 1 - 1 / sqrt 2, whatever Jacobian is used.
  runge_kutta4,  ///< Fourth order, explicit: bounded by the fastest oscillation.
};

inline constexpr std::array<fields::Choice<IntegrationScheme>, 3> kIntegrationSchemes{
    {{IntegrationScheme::linearly_implicit_euler, "linearly_implicit_euler",
      "Stable for every stiffness that is let pass."},
     {IntegrationScheme::rosenbrock2, "rosenbrock2", "Second order, for comparison."},
     {IntegrationScheme::runge_kutta4, "runge_kutta4",
      "Fourth order, for comparison; short steps only."}}};

}  // namespace rigwire::sim
