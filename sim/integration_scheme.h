// How a machine's equations of motion are stepped.
#pragma once

#include <cstdint>

namespace rigwire::sim {

/// The first is for work: it holds for any stiffness that a machine's validate lets pass. The
/// others serve comparison. Which levels know them: each machine's parameters.
enum class IntegrationScheme : std::uint8_t {
  linearly_implicit_euler,  ///< First order.
  rosenbrock2,   ///< Second order: ROS2 of Verwer et al., SIAM J. Sci. Comput. 20 (1999) 1456;
                 ///< gamma = 1 - 1 / sqrt 2, whatever Jacobian is used.
  runge_kutta4,  ///< Fourth order, explicit: bounded by the fastest oscillation.
};

}  // namespace rigwire::sim
