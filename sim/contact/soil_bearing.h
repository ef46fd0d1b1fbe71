// The pressure under which soil fails below a body that is pressed into it.
//
// Soft soil by its strength, the three-term formula of shallow footings (K. Terzaghi, Theoretical
// Soil Mechanics, 1943, chapter 8):
//
//     q = c N_c + gamma z N_q + gamma b N_gamma / 2
//     N_q = exp(pi tan phi) tan^2(45 deg + phi / 2),   N_c = (N_q - 1) / tan phi
//     N_gamma = 2 (N_q + 1) tan phi
//
// with cohesion c, internal friction phi, weight gamma, depth z of the body's lowest point, width
// b. N_q after Prandtl (1921) and Reissner (1924), N_gamma after Vesic (J. Soil Mech. Found. Div.
// ASCE 99 SM1, 1973). Without factors of shape, slope and inclination of the load: a strip's under
// a load along the normal, which errs by some tens of per cent to either side.
//
// Hard ground has no strength in its parameters: 2 MPa, about three times, the usual factor of
// safety, what BS 8004:1986, table 1, presumes dense gravel to carry (600 kPa); an estimate.
#pragma once

#include "sim/ground/soil.h"

namespace rigwire::sim {

class SoilBearing {
 public:
  explicit SoilBearing(const SoilParameters& soil);

  /// Returns the pressure that the soil bears, at least 1 kPa. Depth and width must be at least 0.
  [[nodiscard]] double pressure_pa(double depth_m, double width_m) const;

 private:
  double strength_pa_ = 0.0;
  double by_depth_papm_ = 0.0;
  double by_width_papm_ = 0.0;
};

}  // namespace rigwire::sim
