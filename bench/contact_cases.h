// Contact with solid things: its cost by the number of near things, and its error by the step.
//
// Cases are bodies and machines with the numbers of their files. Energy gained from contacts is the
// maximum drop of the energy lost so far (sim/contact/contact_report.h): it is 0 for a dissipative
// contact. Cases with a closed form report it, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/vehicle/parameters.h"

namespace rigwire::bench {

/// CPU time of a Unimog's step, level full, at 5 m/s out of gear, the minimum of several runs.
struct ContactCost {
  std::string where;  ///< "about": all over 200 m, the way free. "along": on both sides of the
                      ///< way, 0.1 m clear of the tyres.
  std::size_t trees = 0;
  double us_per_step = 0.0;
};
[[nodiscard]] std::vector<ContactCost> measure_contact_cost(int runs = 5);

/// What became of one case at one step.
struct ContactOutcome {
  bool finite = true;
  double came_with_j = 0.0;  ///< Kinetic energy, and potential above where it ends.
  double gave_j = 0.0;       ///< See above.
  double deepest_m = 0.0;    ///< Overlap, beyond dents and of no tyre.
  double dent_m = 0.0;       ///< Bent in for good.
  double pressed_m = 0.0;    ///< The most that a tyre is pressed in.
  double greatest_n = 0.0;   ///< Force of all contacts together.
  double found = 0.0;        ///< The figure that has a closed form; 0 without one.
};

struct ContactCase {
  std::string name;
  std::string figure;  ///< What `found` is, with its unit; empty: there is none.
  double closed_form = 0.0;
  std::function<ContactOutcome(double step_s)> run;
};
/// Free bodies: a crate dropped on an edge and on a corner, a ball down a slope, a wheel pulled
/// over a step. The Unimog wedged between two trunks and at 50 km/h into a wall. The bucket swung
/// into a rock at five heights, one case for each of three openings of the valve.
[[nodiscard]] std::vector<ContactCase> contact_cases();

/// Three crates of 1 t on each other for an hour, at 1 ms.
struct StackRest {
  bool awake = false;  ///< Woken in each step: the model's rest state is excluded.
  double span_s = 0.0;
  double drift_m = 0.0;  ///< Drift of the crate that moved farthest from its place after 3 s.
  double gave_j = 0.0;
  double us_per_step = 0.0;  ///< CPU time.
};
[[nodiscard]] StackRest rest_stack(bool awake, double span_s = 3600.0);

/// Many runs in a shipped scene: the worst of each figure.
struct ContactSweep {
  std::string name;
  int runs = 0;
  int touched = 0;  ///< Runs with a contact.
  int thrown = 0;   ///< Runs in which anything was faster than when it came, by a tenth.
  ContactOutcome worst;
};
/// 24 low swings of the shipped pit's excavator, evenly about it, for each of `seeds` seeds; less
/// those that would begin inside something.
[[nodiscard]] ContactSweep sweep_pit(int seeds);
/// Straight drives of the Unimog through the shipped forest, evenly about its start, 10 s each.
[[nodiscard]] ContactSweep sweep_forest(sim::VehicleLevel level, int drives = 24);

}  // namespace rigwire::bench
