#include "sim/contact/contact_boxes.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

void visit(fields::Visitor& v, ContactBox& p) {
  v.text("name", p.name, "Name of the part that the box represents.");
  v.text("link", p.link, "Link of the machine that carries the box.");
  v.vector3("position", p.position_m, in("m").between(-100, 100),
            "Middle of the box in the link's frame.");
  v.vector3("size", p.size_m, in("m").between(0.01, 100), "Full lengths of the box.");
  v.number("pitch", p.pitch_rad, in("deg").between(-180, 180),
           "Turn of the box about the link's y, nose down positive.");
}

void visit(fields::Visitor& v, SolidBodyParameters& p) {
  v.list("boxes", p.boxes, "Boxes on the links that meet trunks, rocks and walls.");
  v.number("stiffness", p.stiffness_npm, in("MN/m").between(0.01, 5000),
           "Stiffness of each point of contact.");
  v.number("damping_ratio", p.damping_ratio, plain().between(0, 2),
           "Damping of a contact that carries the machine's mass.");
  v.number("crush_force", p.crush_n, in("MN").between(0, 1000),
           "Force at which a point of contact is bent in for good; 0: never.");
  v.number("crush_hardening", p.crush_npm, in("MN/m").between(0, 1000),
           "Rise of the crush force by the depth of the dent.");
}

void validate(const SolidBodyParameters& p, std::span<const std::string_view> links,
              double least_kg, double step_s, int parts) {
  fields::check(p);
  for (std::size_t i = 0; i < p.boxes.size(); ++i) {
    std::string names;
    for (const std::string_view link : links) {
      names += (names.empty() ? "" : ", ") + std::string(link);
    }
    fields::require(std::ranges::find(links, std::string_view(p.boxes[i].link)) != links.end(),
                    "boxes." + std::to_string(i) + ".link", "'" + p.boxes[i].link + "'",
                    "a link of the machine: " + names);
  }
  const double part_s = step_s / parts;
  const double most = least_kg / (part_s * part_s);
  fields::require(p.boxes.empty() || p.crush_n > 0.0 || p.stiffness_npm <= most, "stiffness",
                  in("MN/m").print(p.stiffness_npm),
                  "at most " + in("MN/m").print(most) + " at a step of " + in("ms").print(step_s) +
                      ", or a step of at most " +
                      in("ms").print(parts * std::sqrt(least_kg / p.stiffness_npm)));
}

int contact_parts(const SolidBodyParameters& p, double least_kg, double step_s, int most) {
  const double wanted = std::ceil(2.0 * step_s * std::sqrt(p.stiffness_npm / least_kg));
  return static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(most)));
}

std::vector<ContactBody> contact_bodies(const SolidBodyParameters& p,
                                        std::span<const std::string_view> links, double mass_kg) {
  std::vector<ContactBody> bodies;
  for (const ContactBox& box : p.boxes) {
    const auto link = std::ranges::find(links, std::string_view(box.link));
    Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
    X_LS.translation() = box.position_m;
    X_LS.linear() = Eigen::AngleAxisd(box.pitch_rad, Eigen::Vector3d::UnitY()).matrix();
    bodies.push_back(
        {box.name.empty() ? box.link : box.name, static_cast<std::size_t>(link - links.begin()),
         X_LS, ConvexShape::box(0.5 * box.size_m), p.stiffness_npm,
         2.0 * p.damping_ratio * std::sqrt(p.stiffness_npm * mass_kg), p.crush_n, p.crush_npm});
  }
  return bodies;
}

}  // namespace rigwire::sim
