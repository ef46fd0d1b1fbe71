#include "sim/camera/surface_look.h"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::plain;

namespace {

constexpr std::array<fields::Choice<SurfaceKind>, 13> kKinds{
    {{SurfaceKind::gravel, "gravel", "Sand and gravel, dry."},
     {SurfaceKind::litter, "litter", "Forest floor: old leaves, soil, moss."},
     {SurfaceKind::rock, "rock", "Broken rock."},
     {SurfaceKind::grass, "grass", "Blades of grass, lawn."},
     {SurfaceKind::leaves, "leaves", "Leaves and needles that light passes through."},
     {SurfaceKind::bark, "bark", "Trunks and branches."},
     {SurfaceKind::asphalt, "asphalt", "A road's surface."},
     {SurfaceKind::concrete, "concrete", "Smooth; poor in texture."},
     {SurfaceKind::plaster, "plaster", "Walls of houses; poor in texture."},
     {SurfaceKind::paint, "paint", "Painted steel: even, with dirt and gloss."},
     {SurfaceKind::rubber, "rubber", "Tyres and tracks."},
     {SurfaceKind::steel, "steel", "Bare, worn steel."},
     {SurfaceKind::reflector, "reflector", "White sheeting of signs and markers."}}};

struct LabelLook {
  std::string_view label;
  SurfaceKind kind;
  std::array<float, 3> colour;  ///< All 0: the kind's.
};

constexpr std::array<LabelLook, 19> kLabels{
    {{"ground", SurfaceKind::gravel, {}},
     {"rock", SurfaceKind::rock, {}},
     {"grass", SurfaceKind::grass, {}},
     {"lawn", SurfaceKind::grass, {}},
     {"crown", SurfaceKind::leaves, {}},
     {"bush", SurfaceKind::leaves, {}},
     {"trunk", SurfaceKind::bark, {}},
     {"fallen trunk", SurfaceKind::bark, {}},
     {"road", SurfaceKind::asphalt, {}},
     {"kerb", SurfaceKind::concrete, {}},
     {"building", SurfaceKind::plaster, {}},
     {"machine", SurfaceKind::paint, {0.55F, 0.29F, 0.025F}},
     {"truck", SurfaceKind::paint, {0.58F, 0.20F, 0.03F}},
     {"bucket", SurfaceKind::steel, {}},
     {"drum", SurfaceKind::steel, {}},
     {"wheel", SurfaceKind::rubber, {}},
     {"track", SurfaceKind::rubber, {}},
     {"marker", SurfaceKind::reflector, {}},
     {"sign", SurfaceKind::reflector, {}}}};

void tint(Shade& shade, const std::array<float, 3>& colour) {
  // The second tint keeps its ratio to the first one.
  const float keep = (shade.red2 + shade.green2 + shade.blue2) /
                     std::max(shade.red + shade.green + shade.blue, 1e-3F);
  shade.red = colour[0];
  shade.green = colour[1];
  shade.blue = colour[2];
  shade.red2 = keep * colour[0];
  shade.green2 = keep * colour[1];
  shade.blue2 = keep * colour[2];
}

}  // namespace

void visit(fields::Visitor& v, SurfaceLook& p) {
  v.required("label");
  v.text("label", p.label, "Of the materials that look like this.");
  v.choice("kind", p.kind, kKinds, "What the surface is.");
  v.vector3("colour", p.colour, plain().between(0, 1),
            "Albedo red, green, blue; [0, 0, 0] = that of the kind.");
}

void validate(const SurfaceLook& look) {
  fields::check(look);
  fields::require(!look.label.empty(), "label", "nothing", "the label of a material");
}

Shade shade_of(SurfaceKind kind) {
  Shade s;
  const auto colours = [&](std::array<float, 3> a, std::array<float, 3> b) {
    s.red = a[0], s.green = a[1], s.blue = a[2];
    s.red2 = b[0], s.green2 = b[1], s.blue2 = b[2];
  };
  switch (kind) {
    case SurfaceKind::gravel:
      colours({0.34F, 0.27F, 0.185F}, {0.20F, 0.15F, 0.10F});
      s.frequency_pm = 0.5F, s.grain = 0.16F, s.persistence = 0.93F, s.relief = 0.12F;
      s.soaks = 1.0F;
      break;
    case SurfaceKind::litter:
      colours({0.130F, 0.090F, 0.052F}, {0.075F, 0.065F, 0.032F});
      s.frequency_pm = 0.7F, s.grain = 0.22F, s.persistence = 0.95F, s.relief = 0.15F;
      s.soaks = 1.0F;
      break;
    case SurfaceKind::rock:
      colours({0.30F, 0.285F, 0.265F}, {0.165F, 0.155F, 0.150F});
      s.frequency_pm = 1.2F, s.grain = 0.18F, s.persistence = 0.85F, s.relief = 0.14F;
      s.variation = 0.06F, s.soaks = 0.8F;
      break;
    case SurfaceKind::grass:
      colours({0.075F, 0.125F, 0.030F}, {0.14F, 0.135F, 0.050F});
      s.frequency_pm = 0.6F, s.grain = 0.20F, s.persistence = 0.95F, s.relief = 0.22F;
      s.transmission = 0.25F, s.variation = 0.20F, s.soaks = 0.3F;
      break;
    case SurfaceKind::leaves:
      colours({0.045F, 0.085F, 0.018F}, {0.085F, 0.120F, 0.026F});
      s.frequency_pm = 0.35F, s.grain = 0.14F, s.persistence = 0.95F, s.relief = 0.16F;
      s.transmission = 0.25F, s.variation = 0.25F;
      break;
    case SurfaceKind::bark:
      colours({0.155F, 0.120F, 0.090F}, {0.070F, 0.058F, 0.045F});
      s.frequency_pm = 2.5F, s.grain = 0.22F, s.persistence = 0.90F, s.relief = 0.25F;
      s.soaks = 0.8F;
      break;
    case SurfaceKind::asphalt:
      colours({0.095F, 0.093F, 0.090F}, {0.065F, 0.064F, 0.063F});
      s.frequency_pm = 0.6F, s.grain = 0.06F, s.persistence = 1.0F, s.relief = 0.05F;
      s.soaks = 1.0F;
      break;
    case SurfaceKind::concrete:
      colours({0.36F, 0.35F, 0.33F}, {0.30F, 0.29F, 0.27F});
      s.frequency_pm = 0.8F, s.grain = 0.025F, s.persistence = 0.7F, s.relief = 0.01F;
      s.soaks = 0.8F;
      break;
    case SurfaceKind::plaster:
      colours({0.58F, 0.54F, 0.46F}, {0.50F, 0.46F, 0.39F});
      s.frequency_pm = 0.4F, s.grain = 0.02F, s.persistence = 0.7F, s.relief = 0.01F;
      s.soaks = 0.3F;
      break;
    case SurfaceKind::paint:
      colours({0.40F, 0.40F, 0.40F}, {0.30F, 0.29F, 0.28F});
      s.frequency_pm = 0.9F, s.grain = 0.05F, s.persistence = 0.8F, s.relief = 0.004F;
      s.gloss = 0.04F, s.sharpness = 60.0F;
      break;
    case SurfaceKind::rubber:
      colours({0.040F, 0.039F, 0.038F}, {0.075F, 0.066F, 0.055F});
      s.frequency_pm = 4.0F, s.grain = 0.12F, s.persistence = 0.8F, s.relief = 0.10F;
      s.gloss = 0.03F, s.sharpness = 12.0F;
      break;
    case SurfaceKind::steel:
      colours({0.17F, 0.155F, 0.145F}, {0.13F, 0.095F, 0.070F});
      s.frequency_pm = 2.0F, s.grain = 0.12F, s.persistence = 0.8F, s.relief = 0.03F;
      s.gloss = 0.25F, s.sharpness = 40.0F;
      break;
    case SurfaceKind::reflector:
      colours({0.75F, 0.75F, 0.74F}, {0.70F, 0.70F, 0.68F});
      s.frequency_pm = 1.0F, s.grain = 0.02F, s.persistence = 0.7F;
      s.gloss = 0.05F, s.sharpness = 80.0F;
      break;
  }
  return s;
}

Shade shade_of(std::string_view label, double reflectance, const std::vector<SurfaceLook>& looks) {
  const auto chosen = std::ranges::find(looks, label, &SurfaceLook::label);
  if (chosen != looks.end()) {
    Shade shade = shade_of(chosen->kind);
    if (chosen->colour != Eigen::Vector3d::Zero()) {
      const Eigen::Vector3f colour = chosen->colour.cast<float>();
      tint(shade, {colour.x(), colour.y(), colour.z()});
    }
    return shade;
  }
  const auto known = std::ranges::find(kLabels, label, &LabelLook::label);
  if (known == kLabels.end()) {
    Shade shade = shade_of(SurfaceKind::paint);
    const auto grey = static_cast<float>(reflectance);
    tint(shade, {grey, grey, grey});
    return shade;
  }
  Shade shade = shade_of(known->kind);
  if (known->colour != std::array<float, 3>{}) {
    tint(shade, known->colour);
  }
  return shade;
}

}  // namespace rigwire::sim
