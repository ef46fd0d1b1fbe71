#include "sim/camera/scene_looks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace rigwire::sim {
namespace {

constexpr std::uint32_t kNothing = RTC_INVALID_GEOMETRY_ID;

const Stones& no_stones() {
  static const Stones kNone = [] {
    Stones none{};
    none.tone.fill(1.0F);
    none.gap.fill(1.0F);
    return none;
  }();
  return kNone;
}

}  // namespace

std::uint16_t SceneLooks::add(const Shade& shade) {
  PreparedLook& look = looks_.emplace_back();
  look.shade = shade;
  GrainAnchor anchor;
  anchor.set(0, scene_->origin_W, static_cast<double>(shade.frequency_pm),
             static_cast<double>(shade.upright));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    look.cell[axis] = anchor.cell[axis][0];
    look.share[axis] = anchor.share[axis][0];
  }
  return static_cast<std::uint16_t>(looks_.size() - 1);
}

/// Numbers the looks: first those of the scene's materials, in their order, then the cut face, and
/// those of meshes with colours and of soils as they come.
void SceneLooks::prepare(const Scene::Internals& scene, const std::vector<SurfaceLook>& given) {
  scene_ = &scene;
  looks_.clear();
  for (const Material& material : scene.materials) {
    add(shade_of(material, given));
  }
  const std::uint16_t face = add(cut_face());
  stone_anchor_ = StoneAnchor(scene.origin_W);
  panes_.clear();
  infos_.assign(scene.instance_of.size(), {});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint16_t> painted_looks;
  for (std::size_t i = 0; i < infos_.size(); ++i) {
    const std::uint32_t instance = scene.instance_of[i];
    if (instance >= scene.instances.size()) {
      continue;
    }
    infos_[i].look = static_cast<std::uint16_t>(scene.instances[instance].material);
    if (const std::uint32_t paint = scene.instances[instance].painted; paint != 0) {
      const MeshColour& colour = *scene.painted[paint - 1U]->colour;
      const auto [known, fresh] =
          painted_looks.try_emplace({scene.instances[instance].material, paint});
      if (fresh) {
        known->second = add(painted(looks_[infos_[i].look].shade, colour));
      }
      infos_[i].look = known->second;
      infos_[i].painted = colour.texture ? paint : 0;
    }
    const Scene::Internals::Placed& placed = scene.placed_of(instance);
    infos_[i].on_body = placed.body != Scene::Internals::kFixed;
    for (std::size_t t = 0; t < scene.terrains.size(); ++t) {
      if (scene.terrains[t].instance == instance) {
        infos_[i].terrain = static_cast<std::uint8_t>(t + 1);
      }
    }
    const Panes& panes = looks_[infos_[i].look].shade.panes;
    if (panes.across_m > 0.0F) {
      PaneFrame& frame = panes_.emplace_back();
      const Eigen::Matrix3f R = placed.X_PM.linear().cast<float>();
      const Eigen::Vector3f p = (placed.X_PM.translation() - scene.origin_W).cast<float>();
      std::copy_n(R.data(), 9, frame.X.data());
      std::copy_n(p.data(), 3, frame.X.data() + 9);
      const auto scale = static_cast<float>(placed.scale);
      frame.bounds_M = {scale * placed.bounds_M.min(), scale * placed.bounds_M.max()};
      frame.panes = panes;
      infos_[i].panes = static_cast<std::uint32_t>(panes_.size());
    }
  }
  grounds_.resize(scene.terrains.size());
  for (std::size_t t = 0; t < grounds_.size(); ++t) {
    const Scene::Internals::Terrain& terrain = scene.terrains[t];
    GroundLooks& ground = grounds_[t];
    ground.prepare(scene, terrain);
    ground.own = static_cast<std::uint16_t>(scene.instances[terrain.instance].material);
    ground.face = face;
    if (!terrain.cover) {
      continue;
    }
    for (const std::string& label : terrain.cover->labels) {
      const auto shade = shade_of_soil(label, given);
      const std::uint16_t look = shade ? add(*shade) : ground.own;
      ground.add_label(look, looks_[look].shade);
    }
  }
}

void SceneLooks::find_looks(const RTCRayHit8& rays, const LaneArray& pixel_rad,
                            TexturedPacket& packet) const {
  MetSurfaces& met = packet.met;
  LookLanes look;
  packet.on_bodies = false;
  packet.stony = false;
  packet.glazed = false;
  packet.painted = false;
  alignas(32) std::array<int, kLanes> terrain;
  bool on_ground = false;
  if (met.one != ~0U) {
    const SurfaceInfo& info = infos_[met.one];
    for (std::size_t i = 0; i < kLanes; ++i) {
      look[i] = choose(met.number[i] == kNothing, ~0U, std::uint32_t{info.look});
      terrain[i] = met.number[i] == kNothing ? 0 : info.terrain;
    }
    on_ground = info.terrain != 0;
    packet.on_bodies = info.on_body;
    packet.glazed = info.panes != 0;
    packet.painted = info.painted != 0;
  } else {
    for (std::size_t i = 0; i < kLanes; ++i) {
      look[i] = ~0U;
      terrain[i] = 0;
      if (met.number[i] == kNothing) {
        continue;
      }
      const SurfaceInfo& info = infos_[met.number[i]];
      look[i] = info.look;
      terrain[i] = info.terrain;
      on_ground = on_ground || info.terrain != 0;
      packet.on_bodies = packet.on_bodies || info.on_body;
      packet.glazed = packet.glazed || info.panes != 0;
      packet.painted = packet.painted || info.painted != 0;
    }
  }
  for (std::size_t t = 0; on_ground && t < grounds_.size(); ++t) {
    alignas(32) std::array<int, kLanes> mine;
    int any = 0;
    for (std::size_t i = 0; i < kLanes; ++i) {
      mine[i] = terrain[i] == static_cast<int>(t) + 1 ? -1 : 0;
      any |= mine[i];
    }
    if (any != 0) {
      grounds_[t].find(mine, rays.ray, pixel_rad, looks_.data(), met, look);
    }
  }
  for (const std::uint32_t which : look) {
    packet.stony = packet.stony || (which != ~0U && looks_[which].shade.stones > 0.0F);
  }
  take_looks(looks_.data(), look, met);
}

void SceneLooks::paint_textures(const RTCRayHit8& rays, const LaneArray& pixel_rad,
                                TexturedPacket& packet) const {
  MetSurfaces& met = packet.met;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (met.number[i] == kNothing || infos_[met.number[i]].painted == 0) {
      continue;
    }
    const SurfaceInfo& info = infos_[met.number[i]];
    std::array<float, 9> X;
    if (info.on_body) {
      std::copy_n(packet.X[i].begin(), 9, X.begin());
    } else {
      const auto scale =
          static_cast<float>(scene_->placed_of(scene_->instance_of[met.number[i]]).scale);
      Eigen::Map<Eigen::Matrix3f>(X.data()) = scale * scene_->shading[met.number[i]].R_WM;
    }
    paint(*scene_->painted[info.painted - 1U], X.data(), rays, pixel_rad[i], i, met);
  }
  // The tints are not the look's any more.
  met.look = ~0U;
}

/// Points, normals and anchors in the own frame of what moves.
void SceneLooks::follow_bodies(const RTCRayHit8& rays, TexturedPacket& packet) const {
  MetSurfaces& met = packet.met;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (met.number[i] == kNothing || !infos_[met.number[i]].on_body) {
      continue;
    }
    // Where the link is at the ray's instant: columns of the linear part, then the origin.
    std::array<float, 12>& X = packet.X[i];
    rtcGetGeometryTransform(scene_->placed_of(scene_->instance_of[met.number[i]]).geometry.get(),
                            rays.ray.time[i], RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, X.data());
    const float x = met.x[i] - X[9];
    const float y = met.y[i] - X[10];
    const float z = met.z[i] - X[11];
    met.points.x[i] = X[0] * x + X[1] * y + X[2] * z;
    met.points.y[i] = X[3] * x + X[4] * y + X[5] * z;
    met.points.z[i] = X[6] * x + X[7] * y + X[8] * z;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // Each part has a pattern of its own.
      met.anchor.cell[axis][i] = static_cast<std::int32_t>(met.number[i] * 977U);
      met.anchor.share[axis][i] = 0.0F;
    }
    const RTCHit8& hit = rays.hit;
    const float gx = X[0] * hit.Ng_x[i] + X[3] * hit.Ng_y[i] + X[6] * hit.Ng_z[i];
    const float gy = X[1] * hit.Ng_x[i] + X[4] * hit.Ng_y[i] + X[7] * hit.Ng_z[i];
    const float gz = X[2] * hit.Ng_x[i] + X[5] * hit.Ng_y[i] + X[8] * hit.Ng_z[i];
    const RTCRay8& ray = rays.ray;
    const float along = gx * ray.dir_x[i] + gy * ray.dir_y[i] + gz * ray.dir_z[i];
    const float length = std::sqrt(gx * gx + gy * gy + gz * gz);
    const float size = (along > 0.0F ? -1.0F : 1.0F) / std::max(length, 1e-20F);
    met.nx[i] = met.gx[i] = gx * size;
    met.ny[i] = met.gy[i] = gy * size;
    met.nz[i] = met.gz[i] = gz * size;
  }
  // The anchors are not the look's any more.
  met.look = ~0U;
}

/// Slopes of the grain back from the frames of what moves.
void SceneLooks::turn_relief(const TexturedPacket& packet, Grain& grain) const {
  const MetSurfaces& met = packet.met;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (met.number[i] != kNothing && infos_[met.number[i]].on_body) {
      const std::array<float, 12>& X = packet.X[i];
      const float x = grain.slope_x[i];
      const float y = grain.slope_y[i];
      const float z = grain.slope_z[i];
      grain.slope_x[i] = X[0] * x + X[3] * y + X[6] * z;
      grain.slope_y[i] = X[1] * x + X[4] * y + X[7] * z;
      grain.slope_z[i] = X[2] * x + X[5] * y + X[8] * z;
    }
  }
}

bool SceneLooks::texture_hits(const RTCRayHit8& rays, const LaneArray& pixel_rad,
                              const LightTerms& light, TexturedPacket& packet) const {
  MetSurfaces& met = packet.met;
  if (!meet_points(scene_->shading.data(), rays, met)) {
    return false;
  }
  find_looks(rays, pixel_rad, packet);
  if (packet.on_bodies) {
    follow_bodies(rays, packet);
  }
  if (packet.painted) {
    paint_textures(rays, pixel_rad, packet);
  }
  find_footprints(rays, pixel_rad, met);
  Grain grain;
  sum_grain(met.points, met.anchor, grain);
  if (packet.on_bodies) {
    turn_relief(packet, grain);
  }
  Stones stones;
  if (packet.stony) {
    lay_stones(met.points, stone_anchor_, met.stones, stones);
  }
  texture(met, grain, packet.stony ? stones : no_stones(), light, packet.lit);
  if (packet.glazed) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      if (met.number[i] == kNothing || infos_[met.number[i]].panes == 0) {
        continue;
      }
      const SurfaceInfo& info = infos_[met.number[i]];
      const PaneFrame& pane = panes_[info.panes - 1U];
      glaze(pane, info.on_body ? packet.X[i] : pane.X, met, i, packet.lit);
    }
  }
  return true;
}

}  // namespace rigwire::sim
