// The solid body of a machine, as its file gives it: boxes on its links.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fields/rules.h"
#include "sim/contact/contact_set.h"

namespace rigwire::sim {

/// A box on a link.
struct ContactBox {
  std::string name;
  std::string link;
  /// Middle of the box, in the link's frame.
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  ///< Full lengths.
  double pitch_rad = 0.0;                            ///< About the link's y, nose down positive.

  friend bool operator==(const ContactBox&, const ContactBox&) = default;
};
void visit(fields::Visitor& v, ContactBox& p);

/// Bodies of a machine that contact obstacles, and their stiffness.
struct SolidBodyParameters {
  std::vector<ContactBox> boxes;
  double stiffness_npm = 1.5e6;  ///< Stiffness of each point of contact.
  double damping_ratio = 0.3;    ///< Damping of one point that carries the machine's whole mass.
  double crush_n = 0.0;          ///< Force at which a point is dented for good; 0: never.
  double crush_npm = 0.0;        ///< Rise of the crush force with the depth of the dent.

  friend bool operator==(const SolidBodyParameters&, const SolidBodyParameters&) = default;
};
void visit(fields::Visitor& v, SolidBodyParameters& p);

/// Throws std::invalid_argument naming the box whose link the machine does not have, and a
/// stiffness whose frequency with `least_kg`, the lightest link of those with a box, is more than
/// one radian per step of `step_s`, or per part of it where the machine divides its step in reach
/// of an obstacle into up to `parts`: the contact would still be stable and lose energy, but what
/// it pushed with would be the step's doing. Where the crush force limits it, any stiffness will
/// do.
void validate(const SolidBodyParameters& parameters, std::span<const std::string_view> links,
              double least_kg, double step_s, int parts = 1);

/// Into how many parts a step of `step_s` is divided so that each is at most half a radian of the
/// contact's frequency with `least_kg`; `most` at most.
[[nodiscard]] int contact_parts(const SolidBodyParameters& parameters, double least_kg,
                                double step_s, int most);

/// Bodies of those boxes; damping 2 zeta sqrt(k m) with `mass_kg`.
[[nodiscard]] std::vector<ContactBody> contact_bodies(const SolidBodyParameters& parameters,
                                                      std::span<const std::string_view> links,
                                                      double mass_kg);

}  // namespace rigwire::sim
