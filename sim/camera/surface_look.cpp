#include "sim/camera/surface_look.h"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::plain;

namespace {

constexpr std::array<fields::Choice<SurfaceKind>, 19> kKinds{
    {{SurfaceKind::gravel, "gravel", "Sand and gravel, dry."},
     {SurfaceKind::soil, "soil", "Bare earth with a few stones."},
     {SurfaceKind::mud, "mud", "Wet clay: dark, with a film of water."},
     {SurfaceKind::litter, "litter", "Forest floor: old leaves, soil, moss."},
     {SurfaceKind::rock, "rock", "Broken rock."},
     {SurfaceKind::grass, "grass", "Blades of grass, lawn."},
     {SurfaceKind::leaves, "leaves", "Leaves and needles that light passes through."},
     {SurfaceKind::canopy, "canopy", "Crowns and bushes as closed surfaces."},
     {SurfaceKind::bark, "bark", "Trunks and branches."},
     {SurfaceKind::asphalt, "asphalt", "A road's surface."},
     {SurfaceKind::concrete, "concrete", "Smooth; poor in texture."},
     {SurfaceKind::plaster, "plaster", "Walls of houses; poor in texture."},
     {SurfaceKind::facade, "facade", "Plaster with rows of windows in upright walls."},
     {SurfaceKind::paint, "paint", "Painted steel: even, with dirt and gloss."},
     {SurfaceKind::cab, "cab", "Paint with panes of glass in upright sides."},
     {SurfaceKind::rubber, "rubber", "Tyres and tracks."},
     {SurfaceKind::steel, "steel", "Bare, worn steel."},
     {SurfaceKind::glass, "glass", "Dark panes that mirror the sky."},
     {SurfaceKind::reflector, "reflector", "White sheeting of signs and markers."}}};

struct LabelLook {
  std::string_view label;
  SurfaceKind kind;
  std::array<float, 3> colour;  ///< All 0: the kind's.
};

constexpr std::array<LabelLook, 24> kLabels{
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
     {"building", SurfaceKind::facade, {}},
     {"machine", SurfaceKind::paint, {0.55F, 0.29F, 0.025F}},
     {"truck", SurfaceKind::paint, {0.58F, 0.20F, 0.03F}},
     {"bucket", SurfaceKind::steel, {}},
     {"drum", SurfaceKind::steel, {}},
     {"wheel", SurfaceKind::rubber, {}},
     {"track", SurfaceKind::rubber, {}},
     {"chassis", SurfaceKind::paint, {0.035F, 0.035F, 0.037F}},
     {"cab", SurfaceKind::cab, {0.55F, 0.29F, 0.025F}},
     {"truck cab", SurfaceKind::cab, {0.58F, 0.20F, 0.03F}},
     {"window", SurfaceKind::glass, {}},
     {"wall", SurfaceKind::plaster, {}},
     {"marker", SurfaceKind::reflector, {}},
     {"sign", SurfaceKind::reflector, {}}}};

/// Soils by their names. The first of the lists that has the name counts.
constexpr std::array<LabelLook, 14> kSoils{{{"gravel", SurfaceKind::gravel, {}},
                                            {"sand", SurfaceKind::gravel, {0.42F, 0.34F, 0.23F}},
                                            {"soil", SurfaceKind::soil, {}},
                                            {"earth", SurfaceKind::soil, {}},
                                            {"loam", SurfaceKind::soil, {}},
                                            {"clay", SurfaceKind::soil, {0.21F, 0.135F, 0.085F}},
                                            {"mud", SurfaceKind::mud, {}},
                                            {"forest_floor", SurfaceKind::litter, {}},
                                            {"lawn", SurfaceKind::grass, {}},
                                            {"grass", SurfaceKind::grass, {}},
                                            {"verge", SurfaceKind::grass, {0.12F, 0.125F, 0.045F}},
                                            {"rock", SurfaceKind::rock, {}},
                                            {"asphalt", SurfaceKind::asphalt, {}},
                                            {"concrete", SurfaceKind::concrete, {}}}};

void tint(Shade& shade, const std::array<float, 3>& colour) {
  // The second tint and the stones keep their ratios to the first one.
  const float before = std::max(shade.red + shade.green + shade.blue, 1e-3F);
  const float keep = (shade.red2 + shade.green2 + shade.blue2) / before;
  shade.red = colour[0];
  shade.green = colour[1];
  shade.blue = colour[2];
  shade.red2 = keep * colour[0];
  shade.green2 = keep * colour[1];
  shade.blue2 = keep * colour[2];
  const float stone = (shade.stone_red + shade.stone_green + shade.stone_blue) / before;
  shade.stone_red = stone * colour[0];
  shade.stone_green = stone * colour[1];
  shade.stone_blue = stone * colour[2];
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
  const auto stones = [&](float share, std::array<float, 3> colour) {
    s.stones = share;
    s.stone_red = colour[0], s.stone_green = colour[1], s.stone_blue = colour[2];
  };
  switch (kind) {
    case SurfaceKind::gravel:
      colours({0.275F, 0.223F, 0.162F}, {0.230F, 0.180F, 0.124F});
      stones(0.55F, {0.265F, 0.243F, 0.212F});
      s.frequency_pm = 0.5F, s.grain = 0.055F, s.persistence = 1.05F, s.relief = 0.12F;
      s.soaks = 1.0F, s.bare_from = 0.95F;
      s.film = 0.10F;
      break;
    case SurfaceKind::soil:
      colours({0.185F, 0.130F, 0.085F}, {0.145F, 0.100F, 0.062F});
      stones(0.15F, {0.24F, 0.22F, 0.19F});
      s.frequency_pm = 0.6F, s.grain = 0.07F, s.persistence = 1.05F, s.relief = 0.16F;
      s.soaks = 1.0F, s.bare_from = 1.1F;
      s.film = 0.15F;
      break;
    case SurfaceKind::mud:
      colours({0.085F, 0.060F, 0.040F}, {0.060F, 0.043F, 0.029F});
      s.frequency_pm = 0.8F, s.grain = 0.07F, s.persistence = 0.9F, s.relief = 0.10F;
      s.gloss = 0.02F, s.sharpness = 90.0F, s.soaks = 0.5F, s.bare_from = 1.2F;
      s.film = 1.00F;
      break;
    case SurfaceKind::litter:
      colours({0.112F, 0.076F, 0.043F}, {0.078F, 0.063F, 0.034F});
      stones(0.35F, {0.165F, 0.105F, 0.055F});
      s.frequency_pm = 0.7F, s.grain = 0.10F, s.persistence = 1.02F, s.relief = 0.18F;
      s.soaks = 1.0F, s.bare_from = 1.2F;
      s.film = 0.05F;
      break;
    case SurfaceKind::rock:
      colours({0.250F, 0.235F, 0.215F}, {0.175F, 0.162F, 0.148F});
      s.frequency_pm = 1.2F, s.grain = 0.15F, s.persistence = 0.88F, s.relief = 0.16F;
      s.variation = 0.06F, s.soaks = 0.8F;
      s.film = 0.35F;
      break;
    case SurfaceKind::grass:
      colours({0.068F, 0.105F, 0.027F}, {0.098F, 0.118F, 0.038F});
      s.frequency_pm = 0.5F, s.grain = 0.045F, s.persistence = 1.12F, s.relief = 0.20F;
      s.transmission = 0.25F, s.variation = 0.0F, s.soaks = 0.3F, s.bare_from = 1.2F;
      break;
    case SurfaceKind::leaves:
      colours({0.042F, 0.078F, 0.018F}, {0.062F, 0.092F, 0.022F});
      s.frequency_pm = 0.6F, s.grain = 0.14F, s.persistence = 1.0F, s.relief = 0.30F;
      s.transmission = 0.25F, s.variation = 0.22F;
      break;
    case SurfaceKind::canopy:
      colours({0.020F, 0.036F, 0.010F}, {0.028F, 0.044F, 0.012F});
      stones(1.4F, {0.062F, 0.104F, 0.025F});
      s.frequency_pm = 0.5F, s.grain = 0.10F, s.persistence = 1.0F, s.relief = 0.30F;
      s.transmission = 0.15F;
      break;
    case SurfaceKind::bark:
      colours({0.135F, 0.104F, 0.078F}, {0.080F, 0.064F, 0.050F});
      s.frequency_pm = 9.0F, s.upright = 0.2F, s.grain = 0.17F, s.persistence = 0.9F;
      s.relief = 0.25F, s.soaks = 0.8F;
      s.film = 0.10F;
      break;
    case SurfaceKind::asphalt:
      colours({0.090F, 0.088F, 0.085F}, {0.080F, 0.079F, 0.077F});
      s.frequency_pm = 0.6F, s.grain = 0.022F, s.persistence = 1.2F, s.relief = 0.07F;
      s.soaks = 1.0F;
      s.film = 0.80F;
      break;
    case SurfaceKind::concrete:
      colours({0.36F, 0.35F, 0.33F}, {0.30F, 0.29F, 0.27F});
      s.frequency_pm = 0.8F, s.grain = 0.025F, s.persistence = 0.7F, s.relief = 0.01F;
      s.soaks = 0.8F;
      s.film = 0.60F;
      break;
    case SurfaceKind::plaster:
      colours({0.58F, 0.54F, 0.46F}, {0.50F, 0.46F, 0.39F});
      s.frequency_pm = 0.4F, s.grain = 0.02F, s.persistence = 0.7F, s.relief = 0.01F;
      s.soaks = 0.3F;
      s.film = 0.10F;
      break;
    case SurfaceKind::facade:
      colours({0.56F, 0.52F, 0.44F}, {0.52F, 0.48F, 0.405F});
      s.frequency_pm = 0.4F, s.grain = 0.015F, s.persistence = 0.9F, s.relief = 0.01F;
      s.soaks = 0.3F, s.panes = {.across_m = 2.8F};
      s.film = 0.10F;
      break;
    case SurfaceKind::paint:
      colours({0.40F, 0.40F, 0.40F}, {0.36F, 0.355F, 0.345F});
      s.frequency_pm = 0.9F, s.grain = 0.025F, s.persistence = 0.8F, s.relief = 0.004F;
      s.gloss = 0.04F, s.sharpness = 60.0F;
      break;
    case SurfaceKind::cab:
      s = shade_of(SurfaceKind::paint);
      s.panes = {1.6F, 4.0F, 0.07F, 0.93F, 0.44F, 0.93F};
      break;
    case SurfaceKind::rubber:
      colours({0.036F, 0.035F, 0.034F}, {0.052F, 0.047F, 0.041F});
      s.frequency_pm = 2.0F, s.grain = 0.05F, s.persistence = 1.0F, s.relief = 0.03F;
      s.gloss = 0.03F, s.sharpness = 12.0F;
      break;
    case SurfaceKind::steel:
      colours({0.17F, 0.155F, 0.145F}, {0.13F, 0.095F, 0.070F});
      s.frequency_pm = 2.0F, s.grain = 0.12F, s.persistence = 0.8F, s.relief = 0.03F;
      s.gloss = 0.25F, s.sharpness = 40.0F;
      break;
    case SurfaceKind::glass:
      colours({0.020F, 0.022F, 0.022F}, {0.026F, 0.027F, 0.027F});
      s.frequency_pm = 0.8F, s.grain = 0.02F, s.persistence = 0.8F;
      s.gloss = 0.06F, s.sharpness = 120.0F;
      break;
    case SurfaceKind::reflector:
      colours({0.75F, 0.75F, 0.74F}, {0.70F, 0.70F, 0.68F});
      s.frequency_pm = 1.0F, s.grain = 0.02F, s.persistence = 0.7F;
      s.gloss = 0.05F, s.sharpness = 80.0F;
      break;
  }
  return s;
}

namespace {

/// Of the first entry of that label; nothing when there is none.
std::optional<Shade> find_look(std::string_view label, const std::vector<SurfaceLook>& looks) {
  const auto given = std::ranges::find(looks, label, &SurfaceLook::label);
  if (given == looks.end()) {
    return std::nullopt;
  }
  Shade shade = shade_of(given->kind);
  if (!given->colour.isZero()) {
    tint(shade, {static_cast<float>(given->colour.x()), static_cast<float>(given->colour.y()),
                 static_cast<float>(given->colour.z())});
  }
  return shade;
}

std::optional<Shade> find_look(std::string_view label, std::span<const LabelLook> known) {
  const auto found = std::ranges::find(known, label, &LabelLook::label);
  if (found == known.end()) {
    return std::nullopt;
  }
  Shade shade = shade_of(found->kind);
  if (found->colour != std::array<float, 3>{}) {
    tint(shade, found->colour);
  }
  return shade;
}

}  // namespace

Shade cut_face() {
  Shade s = shade_of(SurfaceKind::rock);
  s.red = 0.255F, s.green = 0.200F, s.blue = 0.145F;
  s.red2 = 0.200F, s.green2 = 0.160F, s.blue2 = 0.120F;
  s.frequency_pm = 0.35F, s.upright = 2.2F, s.grain = 0.10F, s.persistence = 0.95F;
  s.relief = 0.13F, s.variation = 0.0F;
  s.stones = 0.25F;
  s.stone_red = 0.28F, s.stone_green = 0.25F, s.stone_blue = 0.21F;
  return s;
}

Shade shade_of(const Material& material, const std::vector<SurfaceLook>& looks) {
  if (const auto shade = find_look(material.label, looks)) {
    return *shade;
  }
  if (material.foliage) {
    return shade_of(SurfaceKind::canopy);
  }
  if (const auto shade = find_look(material.label, kLabels)) {
    return *shade;
  }
  Shade shade = shade_of(SurfaceKind::paint);
  const auto grey = static_cast<float>(material.reflectance);
  tint(shade, {grey, grey, grey});
  return shade;
}

std::optional<Shade> shade_of_soil(std::string_view name, const std::vector<SurfaceLook>& looks) {
  const auto shade = find_look(name, looks);
  return shade ? shade : find_look(name, kSoils);
}

}  // namespace rigwire::sim
