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

struct KindLook {
  SurfaceKind kind;
  Shade shade;
};

constexpr std::array<KindLook, 19> kKindLooks{
    {{SurfaceKind::gravel,
      {.one = {0.275F, 0.223F, 0.162F},
       .two = {0.230F, 0.180F, 0.124F},
       .frequency_pm = 0.5F,
       .grain = 0.075F,
       .persistence = 1.10F,
       .relief = 0.20F,
       .soaks = 1.0F,
       .film = 0.10F,
       .stones = 0.55F,
       .stone = {0.265F, 0.243F, 0.212F},
       .bare_from = 0.95F}},
     {SurfaceKind::soil,
      {.one = {0.185F, 0.130F, 0.085F},
       .two = {0.145F, 0.100F, 0.062F},
       .frequency_pm = 0.6F,
       .grain = 0.09F,
       .persistence = 1.10F,
       .relief = 0.24F,
       .soaks = 1.0F,
       .film = 0.15F,
       .stones = 0.15F,
       .stone = {0.24F, 0.22F, 0.19F},
       .bare_from = 1.1F}},
     {SurfaceKind::mud,
      {.one = {0.085F, 0.060F, 0.040F},
       .two = {0.060F, 0.043F, 0.029F},
       .frequency_pm = 0.8F,
       .grain = 0.07F,
       .persistence = 0.9F,
       .relief = 0.10F,
       .gloss = 0.02F,
       .sharpness = 90.0F,
       .soaks = 0.5F,
       .film = 1.00F,
       .bare_from = 1.2F}},
     {SurfaceKind::litter,
      {.one = {0.112F, 0.076F, 0.043F},
       .two = {0.078F, 0.063F, 0.034F},
       .frequency_pm = 0.7F,
       .grain = 0.12F,
       .persistence = 1.07F,
       .relief = 0.26F,
       .soaks = 1.0F,
       .film = 0.05F,
       .stones = 0.35F,
       .stone = {0.165F, 0.105F, 0.055F},
       .bare_from = 1.2F}},
     {SurfaceKind::rock,
      {.one = {0.250F, 0.235F, 0.215F},
       .two = {0.175F, 0.162F, 0.148F},
       .frequency_pm = 1.2F,
       .grain = 0.19F,
       .persistence = 1.0F,
       .relief = 0.22F,
       .variation = 0.06F,
       .soaks = 0.8F,
       .film = 0.35F}},
     {SurfaceKind::grass,
      {.one = {0.068F, 0.105F, 0.027F},
       .two = {0.098F, 0.118F, 0.038F},
       .frequency_pm = 0.5F,
       .grain = 0.06F,
       .persistence = 1.16F,
       .relief = 0.30F,
       .transmission = 0.25F,
       .soaks = 0.3F,
       .bare_from = 1.2F}},
     {SurfaceKind::leaves,
      {.one = {0.042F, 0.078F, 0.018F},
       .two = {0.062F, 0.092F, 0.022F},
       .frequency_pm = 0.6F,
       .grain = 0.14F,
       .persistence = 1.0F,
       .relief = 0.30F,
       .transmission = 0.25F,
       .variation = 0.22F}},
     {SurfaceKind::canopy,
      {.one = {0.020F, 0.036F, 0.010F},
       .two = {0.028F, 0.044F, 0.012F},
       .frequency_pm = 0.5F,
       .grain = 0.10F,
       .persistence = 1.0F,
       .relief = 0.30F,
       .transmission = 0.15F,
       .stones = 1.4F,
       .stone = {0.062F, 0.104F, 0.025F}}},
     {SurfaceKind::bark,
      {.one = {0.135F, 0.104F, 0.078F},
       .two = {0.080F, 0.064F, 0.050F},
       .frequency_pm = 9.0F,
       .upright = 0.2F,
       .grain = 0.17F,
       .persistence = 0.9F,
       .relief = 0.25F,
       .soaks = 0.8F,
       .film = 0.10F}},
     {SurfaceKind::asphalt,
      {.one = {0.090F, 0.088F, 0.085F},
       .two = {0.080F, 0.079F, 0.077F},
       .frequency_pm = 0.6F,
       .grain = 0.022F,
       .persistence = 1.2F,
       .relief = 0.07F,
       .soaks = 1.0F,
       .film = 0.80F}},
     {SurfaceKind::concrete,
      {.one = {0.36F, 0.35F, 0.33F},
       .two = {0.30F, 0.29F, 0.27F},
       .frequency_pm = 0.8F,
       .grain = 0.025F,
       .persistence = 0.7F,
       .relief = 0.01F,
       .soaks = 0.8F,
       .film = 0.60F}},
     {SurfaceKind::plaster,
      {.one = {0.58F, 0.54F, 0.46F},
       .two = {0.50F, 0.46F, 0.39F},
       .frequency_pm = 0.4F,
       .grain = 0.02F,
       .persistence = 0.7F,
       .relief = 0.01F,
       .soaks = 0.3F,
       .film = 0.10F}},
     {SurfaceKind::facade,
      {.one = {0.56F, 0.52F, 0.44F},
       .two = {0.52F, 0.48F, 0.405F},
       .frequency_pm = 0.4F,
       .grain = 0.015F,
       .persistence = 0.9F,
       .relief = 0.01F,
       .soaks = 0.3F,
       .film = 0.10F,
       .panes = {.across_m = 2.8F}}},
     {SurfaceKind::paint,
      {.one = {0.40F, 0.40F, 0.40F},
       .two = {0.36F, 0.355F, 0.345F},
       .frequency_pm = 0.9F,
       .grain = 0.025F,
       .persistence = 0.8F,
       .relief = 0.004F,
       .gloss = 0.04F,
       .sharpness = 60.0F}},
     {SurfaceKind::cab,
      {.one = {0.40F, 0.40F, 0.40F},
       .two = {0.36F, 0.355F, 0.345F},
       .frequency_pm = 0.9F,
       .grain = 0.025F,
       .persistence = 0.8F,
       .relief = 0.004F,
       .gloss = 0.04F,
       .sharpness = 60.0F,
       .panes = {1.6F, 4.0F, 0.07F, 0.93F, 0.44F, 0.93F}}},
     {SurfaceKind::rubber,
      {.one = {0.036F, 0.035F, 0.034F},
       .two = {0.052F, 0.047F, 0.041F},
       .frequency_pm = 2.0F,
       .grain = 0.05F,
       .persistence = 1.0F,
       .relief = 0.03F,
       .gloss = 0.03F,
       .sharpness = 12.0F}},
     {SurfaceKind::steel,
      {.one = {0.17F, 0.155F, 0.145F},
       .two = {0.13F, 0.095F, 0.070F},
       .frequency_pm = 2.0F,
       .grain = 0.12F,
       .persistence = 0.8F,
       .relief = 0.03F,
       .gloss = 0.25F,
       .sharpness = 40.0F}},
     {SurfaceKind::glass,
      {.one = {0.020F, 0.022F, 0.022F},
       .two = {0.026F, 0.027F, 0.027F},
       .frequency_pm = 0.8F,
       .grain = 0.02F,
       .persistence = 0.8F,
       .gloss = 0.06F,
       .sharpness = 120.0F}},
     {SurfaceKind::reflector,
      {.one = {0.75F, 0.75F, 0.74F},
       .two = {0.70F, 0.70F, 0.68F},
       .frequency_pm = 1.0F,
       .grain = 0.02F,
       .persistence = 0.7F,
       .gloss = 0.05F,
       .sharpness = 80.0F}}}};

/// The second tint and the stones keep their ratios to the first one.
void tint(Shade& shade, const Albedo& colour) {
  const auto sum = [](const Albedo& a) { return a.red + a.green + a.blue; };
  const float before = std::max(sum(shade.one), 1e-3F);
  const auto scaled = [&](const Albedo& second) {
    const float keep = sum(second) / before;
    return Albedo{keep * colour.red, keep * colour.green, keep * colour.blue};
  };
  shade.two = scaled(shade.two);
  shade.stone = scaled(shade.stone);
  shade.one = colour;
}

}  // namespace

void visit(fields::Visitor& v, SurfaceLook& p) {
  v.required("label");
  v.text("label", p.label, "Label of the materials that look like this.");
  v.choice("kind", p.kind, kKinds, "What the surface is.");
  v.vector3("colour", p.colour, plain().between(0, 1),
            "Albedo red, green, blue; [0, 0, 0] = that of the kind.");
}

void validate(const SurfaceLook& look) {
  fields::check(look);
  fields::require(!look.label.empty(), "label", "nothing", "the label of a material");
}

Shade shade_of(SurfaceKind kind) {
  return std::ranges::find(kKindLooks, kind, &KindLook::kind)->shade;
}

namespace {

/// Returns the shade of the first entry with that label, tinted if it has a colour; nothing if
/// there is none.
template <class Look>
std::optional<Shade> find_look(std::string_view label, std::span<const Look> known) {
  const auto found = std::ranges::find(known, label, &Look::label);
  if (found == known.end()) {
    return std::nullopt;
  }
  Shade shade = shade_of(found->kind);
  const Albedo colour{static_cast<float>(found->colour[0]), static_cast<float>(found->colour[1]),
                      static_cast<float>(found->colour[2])};
  if (!(colour == Albedo{0.0F, 0.0F, 0.0F})) {
    tint(shade, colour);
  }
  return shade;
}

}  // namespace

Shade cut_face() {
  Shade s = shade_of(SurfaceKind::rock);
  s.one = {0.255F, 0.200F, 0.145F};
  s.two = {0.200F, 0.160F, 0.120F};
  s.frequency_pm = 0.35F, s.upright = 2.2F, s.grain = 0.10F, s.persistence = 0.95F;
  s.relief = 0.13F, s.variation = 0.0F;
  s.stones = 0.25F;
  s.stone = {0.28F, 0.25F, 0.21F};
  return s;
}

Shade shade_of(const Material& material, const std::vector<SurfaceLook>& looks) {
  if (const auto shade = find_look<SurfaceLook>(material.label, looks)) {
    return *shade;
  }
  if (material.foliage) {
    return shade_of(SurfaceKind::canopy);
  }
  if (const auto shade = find_look<LabelLook>(material.label, kLabels)) {
    return *shade;
  }
  Shade shade = shade_of(SurfaceKind::paint);
  const auto grey = static_cast<float>(material.reflectance);
  tint(shade, {grey, grey, grey});
  return shade;
}

std::optional<Shade> shade_of_soil(std::string_view name, const std::vector<SurfaceLook>& looks) {
  const auto shade = find_look<SurfaceLook>(name, looks);
  return shade ? shade : find_look<LabelLook>(name, kSoils);
}

}  // namespace rigwire::sim
