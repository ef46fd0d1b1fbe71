#include "hil/stream/scene_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>

#include "hil/record/truth_messages.h"
#include "protocols/gltf/glb.h"
#include "sim/camera/painted_looks.h"

namespace rigwire::hil {
namespace {

namespace gltf = protocols::gltf;
using Json = nlohmann::ordered_json;

constexpr std::string_view kScheme = "rigwire:";
constexpr std::string_view kWorld = "world";

std::string model_name(std::size_t number) {
  return fmt::format("{}mesh/{}", kScheme, number);
}

/// Returns at most about `most` triangles of a part, evenly picked in pairs, which are the two
/// halves of a leaf.
std::vector<std::uint32_t> thinned(const std::vector<std::uint32_t>& corners, std::size_t most) {
  const std::size_t pairs = corners.size() / 6;
  if (corners.size() / 3 <= most) {
    return corners;
  }
  const std::size_t every = (2 * pairs + most - 1) / most;
  std::vector<std::uint32_t> taken;
  for (std::size_t pair = 0; pair < pairs; pair += every) {
    const auto from = corners.begin() + static_cast<std::ptrdiff_t>(6 * pair);
    taken.insert(taken.end(), from, from + 6);
  }
  return taken;
}

bool of_leaves(const sim::Material& material) {
  return material.loose_leaves || material.foliage;
}

/// The middle of its two tints.
std::array<float, 3> colour_of(const sim::Shade& shade) {
  return {0.5F * (shade.one.red + shade.two.red), 0.5F * (shade.one.green + shade.two.green),
          0.5F * (shade.one.blue + shade.two.blue)};
}

/// Returns a surface's colour as a camera with the default materials sees it.
std::array<float, 3> colour_of(const sim::SceneContents::Surface& surface) {
  const sim::Shade shade = sim::shade_of(surface.material, {});
  return colour_of(surface.colour ? sim::painted(shade, *surface.colour) : shade);
}

}  // namespace

SceneModel::SceneModel(const sim::SceneContents& contents, std::int64_t start_unix_ns)
    : stamp_(timestamp(start_unix_ns, kStart)) {
  for (const sim::SceneContents::Terrain& terrain : contents.terrains) {
    add_terrain(terrain);
  }
  add_things(contents);
  // Laid out before the run, so that who comes in the middle of it costs copying alone.
  for (std::size_t terrain = 0; terrain < terrains_.size(); ++terrain) {
    for (std::size_t row = 0; row < terrains_[terrain].rows; ++row) {
      for (std::size_t column = 0; column < terrains_[terrain].columns; ++column) {
        terrains_[terrain].texts.push_back(text_of(tile_entity(terrain, row, column)));
      }
    }
  }
  std::ranges::transform(entities_, std::back_inserter(texts_),
                         [this](const Entity& entity) { return text_of(entity); });
}

void SceneModel::add_terrain(const sim::SceneContents::Terrain& terrain) {
  Terrain& kept = terrains_.emplace_back();
  kept.field = terrain.field;
  kept.cells = terrain.cells;
  kept.label = terrain.material.label;
  const auto own = colour_of({terrain.material, nullptr});
  for (const std::string& label : terrain.labels) {
    const auto shade = sim::shade_of_soil(label, {});
    kept.colours.push_back(shade ? colour_of(*shade) : own);
  }
  kept.colours.push_back(own);
  kept.columns = (kept.field.columns - 2) / kTileCells + 1;
  kept.rows = (kept.field.rows - 2) / kTileCells + 1;
  kept.versions.resize(kept.columns * kept.rows);
}

void SceneModel::add_things(const sim::SceneContents& contents) {
  // Things of one mesh and the same surfaces share a model.
  std::vector<std::pair<std::size_t, std::vector<sim::Material>>> made;
  std::vector<std::size_t> numbers;
  std::map<std::size_t, std::vector<std::size_t>> made_of;
  for (const sim::SceneContents::Thing& thing : contents.things) {
    const sim::SceneContents::Mesh& mesh = contents.meshes[thing.mesh];
    std::vector<sim::Material> materials;
    std::ranges::transform(thing.surfaces, std::back_inserter(materials),
                           &sim::SceneContents::Surface::material);
    auto& same_mesh = made_of[thing.mesh];
    const auto known = std::ranges::find_if(
        same_mesh, [&](std::size_t index) { return made[index].second == materials; });
    std::size_t number = 0;
    if (known != same_mesh.end()) {
      number = *known;
    } else {
      number = made.size();
      std::vector<std::vector<std::uint32_t>> corners;
      std::vector<gltf::Part> parts;
      corners.reserve(mesh.parts.size());
      for (std::size_t k = 0; k < mesh.parts.size() && k < thing.surfaces.size(); ++k) {
        corners.push_back(thinned(mesh.parts[k].corners, of_leaves(materials[k])
                                                             ? kMostLeaves
                                                             : mesh.parts[k].corners.size()));
        parts.push_back(
            {mesh.parts[k].vertices_m, corners.back(), colour_of(thing.surfaces[k]), {}});
      }
      models_[model_name(number)] = std::make_shared<const std::string>(gltf::glb(parts));
      same_mesh.push_back(number);
      made.emplace_back(thing.mesh, std::move(materials));
    }
    Entity entity;
    entity.id = fmt::format("{}/{}", thing.instance, thing.name);
    entity.model = model_name(number);
    entity.label = thing.surfaces.front().material.label;
    entity.frame = kWorld;
    entity.scale = thing.scale;
    entity.X_FE = thing.X_PM;
    if (thing.body && contents.bodies[*thing.body].loose) {
      of_body_[*thing.body].push_back(entities_.size());
    } else if (thing.body) {
      entity.frame = contents.bodies[*thing.body].name;
    } else {
      of_instance_[thing.instance] = entities_.size();
      fixed_[thing.instance] = thing;
      // Pieces are cut from plain meshes alone (Scene::displace()).
      if (mesh.parts.size() == 1) {
        meshes_.try_emplace(static_cast<std::uint32_t>(thing.mesh), mesh);
      }
    }
    entities_.push_back(std::move(entity));
  }
}

SceneModel::Entity SceneModel::tile_entity(std::size_t terrain, std::size_t row,
                                           std::size_t column) const {
  const Terrain& kept = terrains_[terrain];
  Entity entity;
  entity.id = fmt::format("terrain/{}/{}/{}", terrain, row, column);
  entity.frame = kWorld;
  entity.model = fmt::format("{}terrain/{}/{}/{}/{}", kScheme, terrain, row, column,
                             kept.versions[row * kept.columns + column]);
  entity.label = kept.label;
  entity.X_FE.translation() = kept.field.centre_m();
  return entity;
}

std::shared_ptr<const std::string> SceneModel::tile(std::size_t terrain, std::size_t row,
                                                    std::size_t column) const {
  const Terrain& kept = terrains_[terrain];
  const sim::HeightField& field = kept.field;
  const std::size_t first_column = column * kTileCells;
  const std::size_t first_row = row * kTileCells;
  const std::size_t columns = std::min(kTileCells + 1, field.columns - first_column);
  const std::size_t rows = std::min(kTileCells + 1, field.rows - first_row);
  const Eigen::Vector3d centre = field.centre_m();
  std::vector<float> vertices;
  std::vector<std::uint8_t> colours;
  vertices.reserve(3 * columns * rows);
  for (std::size_t r = first_row; r < first_row + rows; ++r) {
    for (std::size_t c = first_column; c < first_column + columns; ++c) {
      vertices.push_back(static_cast<float>(field.origin_m.x() - centre.x() +
                                            field.cell_m * static_cast<double>(c)));
      vertices.push_back(static_cast<float>(field.origin_m.y() - centre.y() +
                                            field.cell_m * static_cast<double>(r)));
      vertices.push_back(static_cast<float>(field.node(c, r) - centre.z()));
      const std::size_t cell =
          std::min(r, field.rows - 2) * (field.columns - 1) + std::min(c, field.columns - 2);
      const std::size_t label = cell < kept.cells.size() ? kept.cells[cell] : kept.colours.size();
      for (const float band : kept.colours[std::min(label, kept.colours.size() - 1)]) {
        colours.push_back(static_cast<std::uint8_t>(255.0F * std::clamp(band, 0.0F, 1.0F)));
      }
      colours.push_back(255);
    }
  }
  std::vector<std::uint32_t> corners;
  corners.reserve(6 * (columns - 1) * (rows - 1));
  for (std::uint32_t r = 0; r + 1 < rows; ++r) {
    for (std::uint32_t c = 0; c + 1 < columns; ++c) {
      const auto width = static_cast<std::uint32_t>(columns);
      const std::uint32_t south_west = r * width + c;
      // Parted as rays see it (HeightField): from south-east to north-west.
      for (const std::uint32_t corner :
           std::array{south_west, south_west + 1, south_west + width, south_west + 1,
                      south_west + width + 1, south_west + width}) {
        corners.push_back(corner);
      }
    }
  }
  const gltf::Part part{vertices, corners, {1.0F, 1.0F, 1.0F}, colours};
  return std::make_shared<const std::string>(gltf::glb({&part, 1}));
}

std::shared_ptr<const std::string> SceneModel::asset(std::string_view uri) const {
  if (const auto found = models_.find(uri); found != models_.end()) {
    return found->second;
  }
  constexpr std::string_view kTerrain = "rigwire:terrain/";
  if (!uri.starts_with(kTerrain)) {
    return nullptr;
  }
  // Whatever version is asked for, it is as it is now.
  std::array<std::size_t, 4> numbers{};
  const char* at = uri.data() + kTerrain.size();
  const char* const end = uri.data() + uri.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto [stop, error] = std::from_chars(at, end, numbers[i]);
    const bool last = i + 1 == numbers.size();
    if (error != std::errc{} || (last ? stop != end : stop == end || *stop != '/')) {
      return nullptr;
    }
    at = last ? stop : stop + 1;
  }
  const auto [terrain, row, column, version] = numbers;
  if (terrain >= terrains_.size() || row >= terrains_[terrain].rows ||
      column >= terrains_[terrain].columns) {
    return nullptr;
  }
  return tile(terrain, row, column);
}

std::string SceneModel::text_of(const Entity& entity) const {
  const Eigen::Vector3d p = entity.X_FE.translation();
  const Eigen::Quaterniond q(entity.X_FE.linear());
  return fmt::format(
      R"({{"timestamp":{},"frame_id":{},"id":{},"lifetime":{{"sec":0,"nsec":0}},)"
      R"("frame_locked":true,"metadata":[{{"key":"label","value":{}}}],"arrows":[],"cubes":[],)"
      R"("spheres":[],"cylinders":[],"lines":[],"triangles":[],"texts":[],"models":[{{"pose":)"
      R"({{"position":{{"x":{:.9g},"y":{:.9g},"z":{:.9g}}},)"
      R"("orientation":{{"x":{:.9g},"y":{:.9g},"z":{:.9g},"w":{:.9g}}}}},)"
      R"("scale":{{"x":{:.9g},"y":{:.9g},"z":{:.9g}}},"color":{{"r":1,"g":1,"b":1,"a":1}},)"
      R"("override_color":false,"url":"{}","media_type":"model/gltf-binary","data":""}}]}})",
      stamp_, Json(entity.frame).dump(), Json(entity.id).dump(), Json(entity.label).dump(), p.x(),
      p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), entity.scale, entity.scale, entity.scale,
      entity.model);
}

std::string SceneModel::update(std::span<const std::string* const> entities) {
  constexpr std::string_view kBegin = R"({"deletions":[],"entities":[)";
  constexpr std::string_view kEnd = "]}";
  std::size_t size = kBegin.size() + kEnd.size();
  for (const std::string* const entity : entities) {
    size += entity->size() + 1;
  }
  std::string text;
  text.reserve(size);
  text += kBegin;
  for (const std::string* const entity : entities) {
    text += entity == entities.front() ? "" : ",";
    text += *entity;
  }
  text += kEnd;
  return text;
}

std::string SceneModel::whole() const {
  std::vector<const std::string*> all;
  for (const Terrain& terrain : terrains_) {
    for (const std::string& tile : terrain.texts) {
      all.push_back(&tile);
    }
  }
  for (const std::string& entity : texts_) {
    all.push_back(&entity);
  }
  return update(all);
}

void SceneModel::show_displaced(const sim::DisplacedThing& thing,
                                std::vector<std::size_t>& changed) {
  const auto fixed = fixed_.find(thing.piece.thing);
  if (fixed == fixed_.end()) {
    return;
  }
  const std::size_t whole = of_instance_[thing.piece.thing];
  if (thing.piece.triangles == 0) {
    entities_[whole].X_FE = thing.X_WM;
    changed.push_back(whole);
    return;
  }
  const std::string name = fmt::format("{}piece/{}/{}/{}", kScheme, thing.piece.thing,
                                       thing.piece.first_triangle, thing.piece.triangles);
  const auto known = pieces_.find(name);
  if (known != pieces_.end()) {
    entities_[known->second].X_FE = thing.X_WM;
    changed.push_back(known->second);
    return;
  }
  const auto mesh = meshes_.find(static_cast<std::uint32_t>(fixed->second.mesh));
  if (mesh == meshes_.end()) {
    return;
  }
  // Triangles as the mesh was when it was whole: of the piece, and of all that is still fixed.
  std::vector<sim::ScenePiece>& taken = taken_out_[thing.piece.thing];
  taken.push_back(thing.piece);
  const sim::SceneContents::Part& part = mesh->second.parts.front();
  std::vector<std::uint32_t> piece;
  std::vector<std::uint32_t> rest;
  for (std::size_t t = 0; t < part.corners.size() / 3; ++t) {
    const auto within = [t](const sim::ScenePiece& one) {
      return t >= one.first_triangle && t < std::size_t{one.first_triangle} + one.triangles;
    };
    const auto from = part.corners.begin() + static_cast<std::ptrdiff_t>(3 * t);
    if (within(thing.piece)) {
      piece.insert(piece.end(), from, from + 3);
    } else if (std::ranges::none_of(taken, within)) {
      rest.insert(rest.end(), from, from + 3);
    }
  }
  const auto colour = colour_of(fixed->second.surfaces.front());
  const auto file = [&](const std::vector<std::uint32_t>& corners) {
    const gltf::Part one{part.vertices_m, corners, colour, {}};
    return std::make_shared<const std::string>(gltf::glb({&one, 1}));
  };
  models_[name] = file(piece);
  Entity entity = entities_[whole];
  entity.id = fmt::format("{}/{}", entity.id, thing.piece.first_triangle);
  entity.model = name;
  entity.X_FE = thing.X_WM;
  pieces_[name] = entities_.size();
  changed.push_back(entities_.size());
  entities_.push_back(std::move(entity));
  entities_[whole].model = fmt::format("{}rest/{}/{}", kScheme, thing.piece.thing, taken.size());
  models_[entities_[whole].model] = file(rest);
  changed.push_back(whole);
}

std::string SceneModel::apply(const ViewChange& change) {
  std::vector<std::size_t> changed;
  std::vector<const std::string*> told;
  if (change.dug && !terrains_.empty()) {
    Terrain& ground = terrains_.front();
    const sim::NodeRectangle& dug = change.dug->nodes;
    auto height = change.dug->heights_m.begin();
    for (std::size_t r = dug.first_row; r <= dug.last_row; ++r) {
      for (std::size_t c = dug.first_column; c <= dug.last_column; ++c) {
        ground.field.heights_m[r * ground.field.columns + c] = *height++;
      }
    }
    // A node on a border belongs to both tiles.
    const auto first = [](std::size_t node) { return node == 0 ? 0 : (node - 1) / kTileCells; };
    for (std::size_t row = first(dug.first_row);
         row <= std::min(dug.last_row / kTileCells, ground.rows - 1); ++row) {
      for (std::size_t column = first(dug.first_column);
           column <= std::min(dug.last_column / kTileCells, ground.columns - 1); ++column) {
        const std::size_t tile = row * ground.columns + column;
        ++ground.versions[tile];
        ground.texts[tile] = text_of(tile_entity(0, row, column));
        told.push_back(&ground.texts[tile]);
      }
    }
  }
  for (const ViewChange::Body& body : change.moved) {
    for (const std::size_t entity : of_body_[body.body]) {
      entities_[entity].X_FE = body.X_WB;
      changed.push_back(entity);
    }
  }
  for (const sim::DisplacedThing& thing : change.displaced) {
    show_displaced(thing, changed);
  }
  texts_.resize(entities_.size());
  for (const std::size_t entity : changed) {
    texts_[entity] = text_of(entities_[entity]);
    told.push_back(&texts_[entity]);
  }
  return update(told);
}

std::string SceneModel::schema() {
  const auto object = [](Json properties) {
    return Json{{"type", "object"}, {"properties", std::move(properties)}};
  };
  const auto list = [](Json items) { return Json{{"type", "array"}, {"items", std::move(items)}}; };
  const auto numbers = [&](std::initializer_list<const char*> names) {
    Json properties = Json::object();
    for (const char* const name : names) {
      properties[name] = {{"type", "number"}};
    }
    return object(properties);
  };
  const Json text{{"type", "string"}};
  const Json truth{{"type", "boolean"}};
  const Json whole{{"type", "integer"}};
  const Json time = object({{"sec", whole}, {"nsec", whole}});
  const Json pose = object(
      {{"position", numbers({"x", "y", "z"})}, {"orientation", numbers({"x", "y", "z", "w"})}});
  const Json model = object({{"pose", pose},
                             {"scale", numbers({"x", "y", "z"})},
                             {"color", numbers({"r", "g", "b", "a"})},
                             {"override_color", truth},
                             {"url", text},
                             {"media_type", text},
                             {"data", {{"type", "string"}, {"contentEncoding", "base64"}}}});
  const Json entity = object({{"timestamp", time},
                              {"frame_id", text},
                              {"id", text},
                              {"lifetime", time},
                              {"frame_locked", truth},
                              {"metadata", list(object({{"key", text}, {"value", text}}))},
                              {"models", list(model)}});
  // JSON schema of foxglove.SceneUpdate, without the primitives that are not used here.
  return object({{"deletions", list(object({{"timestamp", time}, {"type", whole}, {"id", text}}))},
                 {"entities", list(entity)}})
      .dump();
}

}  // namespace rigwire::hil
