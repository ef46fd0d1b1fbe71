#include "hil/files/mesh_file.h"

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <unistd.h>

#include <assimp/BaseImporter.h>
#include <assimp/DefaultIOStream.h>
#include <assimp/DefaultIOSystem.h>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/files/image_file.h"
#include "hil/files/ply_file.h"
#include "hil/files/wavefront_file.h"
#include "sim/scene/colour_texture.h"

namespace rigwire::hil {
namespace {

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// What a file's axes are in ours.
Eigen::Vector3f ours(const aiVector3D& p, bool gltf) {
  return gltf ? Eigen::Vector3f(p.z, p.x, p.y) : Eigen::Vector3f(p.x, p.y, p.z);
}

/// A file that is open, for assimp. Its size is that of the open file, not of what has its name.
class OpenedStream final : public Assimp::DefaultIOStream {
 public:
  OpenedStream(std::FILE* file, const std::string& name, std::uint64_t size)
      : DefaultIOStream(file, name), size_(static_cast<std::size_t>(size)) {}
  [[nodiscard]] std::size_t FileSize() const override { return size_; }

 private:
  std::size_t size_;
};

/// Opens what assimp asks for, and remembers it.
class OpenedFiles final : public Assimp::DefaultIOSystem {
 public:
  /// `refusal`: set where a file is there and is not opened. Both must outlive the object.
  OpenedFiles(std::vector<std::string>& names, std::string& refusal)
      : names_(names), refusal_(refusal) {}
  /// Without opening it, which assimp's own does.
  bool Exists(const char* file) const override {
    std::error_code error;
    return std::filesystem::exists(file, error);
  }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::strchr(mode, 'r') == nullptr) {
      return nullptr;
    }
    try {
      OutsideFile opened(file, kMeshFile);
      const std::uint64_t size = opened.size();
      const int descriptor = opened.release();
      std::FILE* const stream = ::fdopen(descriptor, "rb");
      if (stream == nullptr) {
        ::close(descriptor);
        return nullptr;
      }
      if (std::ranges::find(names_, file) == names_.end()) {
        names_.emplace_back(file);
      }
      return new OpenedStream(stream, file, size);  // the importer's from here on
    } catch (const FileRefused& refused) {
      if (!refused.missing() && refusal_.empty()) {
        refusal_ = refused.what();
      }
      return nullptr;
    }
  }

 private:
  std::vector<std::string>& names_;
  std::string& refusal_;
};

constexpr std::array<std::string_view, 5> kExtensions{".gltf", ".glb", ".obj", ".stl", ".ply"};

/// Triangles alone need no material library.
enum class Wanted { triangles, surfaces };

class File {
 public:
  File(const std::filesystem::path& file, const std::string& name, Wanted wanted)
      : path_(file), who_("mesh '" + name + "', file '" + file.string() + "': ") {
    require_file(file);
    const std::string extension = lower_case(file.extension().string());
    if (std::ranges::find(kExtensions, extension) == kExtensions.end()) {
      throw std::invalid_argument(
          fmt::format("{}no format of a mesh that is read, found \"{}\", allowed {}", who_,
                      printable(extension), fmt::join(kExtensions, ", ")));
    }
    files_.push_back(file.string());
    if (extension == ".ply") {
      const std::string content = read(path_, kMeshFile);
      plain_ =
          read_ply({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}, who_);
      return;
    }
    keep_own_formats();
    importer_.SetIOHandler(new OpenedFiles(files_, refusal_));  // the importer's from here on
    gltf_ = extension == ".gltf" || extension == ".glb";
    if (extension == ".obj") {
      scanned_ = scan_wavefront_mesh(read(path_, kMeshFile), path_.string());
      if (wanted == Wanted::surfaces) {
        read_libraries();
      }
    }
    importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                 aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    scene_ = importer_.ReadFile(file.string(),
                                aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                    aiProcess_PreTransformVertices | aiProcess_SortByPType);
    if (!refusal_.empty()) {
      throw std::invalid_argument(who_ + refusal_);
    }
    if (scene_ == nullptr) {
      throw std::invalid_argument(who_ + importer_.GetErrorString());
    }
    for (const Library& library : libraries_) {
      if (std::ranges::find(files_, library.file.string()) == files_.end()) {
        files_.push_back(library.file.string());
      }
    }
  }

  /// All of a file without materials; null: it is a scene.
  [[nodiscard]] const sim::TriangleMesh* plain() const { return plain_ ? &*plain_ : nullptr; }
  /// Precondition: it is not plain.
  [[nodiscard]] const aiScene& scene() const { return *scene_; }
  /// Opened so far.
  [[nodiscard]] const std::vector<std::string>& files() const { return files_; }

  void append(const aiMesh& part, sim::TriangleMesh& mesh) const {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      mesh.vertices.push_back(ours(part.mVertices[v], gltf_));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices == 3) {
        mesh.triangles.push_back(
            {base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
      }
    }
  }

  /// Null when the material has no holes.
  [[nodiscard]] std::shared_ptr<const sim::AlphaMask> mask(const aiMaterial& material) {
    aiString mode;
    if (material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == AI_SUCCESS &&
        std::string(mode.C_Str()) == "OPAQUE") {
      return nullptr;
    }
    aiString opacity;
    // An opacity map of its own goes before the colour's alpha.
    const bool own = material.GetTexture(aiTextureType_OPACITY, 0, &opacity) == AI_SUCCESS;
    const auto picture = own ? std::optional(picture_of(opacity, material)) : colours(material);
    if (!picture) {
      return nullptr;
    }
    const auto image = open(*picture);
    if (!image || (!own && !image->has_alpha())) {
      return nullptr;
    }
    auto mask = std::make_shared<sim::AlphaMask>();
    mask->name = picture->name;
    mask->columns = image->columns;
    mask->rows = image->rows;
    float cutoff = 0.5F;
    (void)material.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff);
    mask->cutoff = static_cast<std::uint8_t>(std::clamp(cutoff * 255.0F + 0.5F, 1.0F, 255.0F));
    const std::size_t channel = image->has_alpha() ? image->channels - 1 : 0;
    // assimp's v runs upwards, an image's rows downwards.
    for (std::size_t r = image->rows; r-- > 0;) {
      for (std::size_t c = 0; c < image->columns; ++c) {
        const unsigned sample = image->sample(c, r, channel);
        mask->opacity.push_back(
            static_cast<std::uint8_t>(image->bits == 16 ? sample >> 8U : sample));
      }
    }
    return mask;
  }

  /// What cameras see of the material; null when it says nothing. `holes`: those that have a
  /// mask do not colour what is left.
  [[nodiscard]] std::shared_ptr<const sim::MeshColour> colour(const aiMaterial& material,
                                                              bool holes) {
    sim::MeshColour colour;
    const WavefrontMaterial* entry = library_entry(material);
    bool says = false;
    if (entry != nullptr && entry->colour) {
      std::ranges::transform(*entry->colour, colour.factor.begin(),
                             [](double share) { return static_cast<float>(share); });
      says = true;
    } else if (aiColor4D factor;
               gltf_ && material.Get(AI_MATKEY_BASE_COLOR, factor) == AI_SUCCESS) {
      colour.factor = {factor.r, factor.g, factor.b};
      says = colour.factor != std::array{1.0F, 1.0F, 1.0F};
    }
    if (const auto picture = colours(material)) {
      if (const auto image = open(*picture)) {
        colour.texture = texture(*image, *picture, holes);
        colour.edge_u = edge(material, AI_MATKEY_MAPPINGMODE_U(aiTextureType_BASE_COLOR, 0), entry);
        colour.edge_v = edge(material, AI_MATKEY_MAPPINGMODE_V(aiTextureType_BASE_COLOR, 0), entry);
        says = true;
      } else {
        note(fmt::format("{}is no PNG: it has no effect", picture->what));
      }
      aiUVTransform transform;
      if (gltf_ && material.Get(AI_MATKEY_UVTRANSFORM(aiTextureType_BASE_COLOR, 0), transform) ==
                       AI_SUCCESS) {
        note(fmt::format("{}its transform (KHR_texture_transform) has no effect", picture->what));
      }
    }
    return says ? std::make_shared<const sim::MeshColour>(colour) : nullptr;
  }

  /// Where a mesh's vertex lies in its material's pictures; 0 where it does not say.
  [[nodiscard]] Eigen::Vector2f coordinates(const aiMesh& mesh, unsigned vertex) const {
    if (!mesh.HasTextureCoords(0)) {
      return Eigen::Vector2f::Zero();
    }
    const aiVector3D& uv = mesh.mTextureCoords[0][vertex];
    const WavefrontMaterial* entry = library_entry(*scene_->mMaterials[mesh.mMaterialIndex]);
    if (entry == nullptr || !entry->map) {
      return {uv.x, uv.y};
    }
    const WavefrontMap& map = *entry->map;
    return {static_cast<float>(map.scale[0] * static_cast<double>(uv.x) + map.offset[0]),
            static_cast<float>(map.scale[1] * static_cast<double>(uv.y) + map.offset[1])};
  }

  /// Throws where a surface with a picture says nowhere what of it is where.
  void require_coordinates(const aiMesh& mesh, const aiMaterial& material) const {
    const auto bare = scanned_.bare_faces.find(std::string_view(material.GetName().C_Str()));
    if (mesh.HasTextureCoords(0) && bare == scanned_.bare_faces.end()) {
      return;
    }
    const auto picture = colours(material);
    throw std::invalid_argument(fmt::format(
        "{}needs texture coordinates; {}", picture->what,
        bare == scanned_.bare_faces.end()
            ? std::string("the surface has none")
            : fmt::format("the face of line {} has corners without (allowed: vertex/coordinate)",
                          bare->second)));
  }

  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

 private:
  /// A material's picture: what of it the file says.
  struct Picture {
    std::string name;
    std::filesystem::path file;
    const aiTexture* embedded = nullptr;
    std::string what;  ///< For messages, to go on from.
  };

  /// A library's materials with the folder that its pictures are in.
  struct Library {
    std::filesystem::path file;
    std::vector<WavefrontMaterial> materials;
  };

  /// Removes assimp's readers of other formats: it tries every format that it knows, whatever the
  /// file's name says.
  void keep_own_formats() {
    for (std::size_t i = importer_.GetImporterCount(); i-- > 0;) {
      std::set<std::string> extensions;
      Assimp::BaseImporter* const reader = importer_.GetImporter(i);
      reader->GetExtensionList(extensions);
      const bool ours = std::ranges::any_of(kExtensions, [&](std::string_view extension) {
        return extension != ".ply" && extensions.contains(std::string(extension.substr(1)));
      });
      if (!ours) {
        importer_.UnregisterLoader(reader);
        removed_.emplace_back(reader);
      }
    }
  }

  void require_file(const std::filesystem::path& file) const {
    try {
      const OutsideFile opened(file, kMeshFile);
    } catch (const FileRefused& refused) {
      throw std::invalid_argument(who_ +
                                  (refused.missing() ? "there is no such file" : refused.rest()));
    }
  }

  [[nodiscard]] std::string read(const std::filesystem::path& file, FileLimit limit) const {
    try {
      return read_outside_file(file, limit);
    } catch (const FileRefused& refused) {
      throw std::invalid_argument(who_ + refused.rest());
    }
  }

  void read_libraries() {
    for (const WavefrontName& library : scanned_.libraries) {
      std::string name = library.name;
      std::ranges::replace(name, '\\', '/');
      const std::filesystem::path file = path_.parent_path() / name;
      std::string content;
      try {
        content = read_outside_file(file, kMaterialFile);
      } catch (const FileRefused& refused) {
        throw std::invalid_argument(
            refused.missing()
                ? fmt::format("{}:{}: mtllib: found '{}', but there is no file {}", path_.string(),
                              library.line, library.name, file.string())
                : fmt::format("{}:{}: mtllib: {}", path_.string(), library.line, refused.what()));
      }
      libraries_.push_back({file, read_wavefront_materials(content, file.string(), notes_)});
    }
  }

  /// Null where no library has it.
  [[nodiscard]] const WavefrontMaterial* library_entry(
      const aiMaterial& material, std::filesystem::path* folder = nullptr) const {
    const std::string name = material.GetName().C_Str();
    for (const Library& library : libraries_) {
      const auto found = std::ranges::find(library.materials, name, &WavefrontMaterial::name);
      if (found != library.materials.end()) {
        if (folder != nullptr) {
          *folder = library.file;
        }
        return &*found;
      }
    }
    return nullptr;
  }

  [[nodiscard]] Picture picture_of(const aiString& texture, const aiMaterial& material) const {
    std::string name = texture.C_Str();
    std::ranges::replace(name, '\\', '/');
    return {texture.C_Str(), path_.parent_path() / name,
            scene_->GetEmbeddedTexture(texture.C_Str()),
            fmt::format("{}texture '{}' of material '{}': ", who_, texture.C_Str(),
                        material.GetName().C_Str())};
  }

  /// The picture of a material's own colour.
  [[nodiscard]] std::optional<Picture> colours(const aiMaterial& material) const {
    std::filesystem::path library;
    if (const WavefrontMaterial* entry = library_entry(material, &library)) {
      if (!entry->map) {
        return std::nullopt;
      }
      return Picture{
          entry->map->file, library.parent_path() / entry->map->file, nullptr,
          fmt::format("{}texture '{}' of material '{}' ({}:{}): ", who_, entry->map->file,
                      entry->name, library.string(), entry->map->line)};
    }
    aiString texture;
    if (material.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) != AI_SUCCESS &&
        material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) != AI_SUCCESS) {
      return std::nullopt;
    }
    return picture_of(texture, material);
  }

  /// Null for an image that is no PNG. Each is opened once.
  [[nodiscard]] std::shared_ptr<const Image> open(const Picture& picture) {
    const auto [known, fresh] = images_.try_emplace(
        picture.embedded != nullptr ? "*" + picture.name : picture.file.string());
    if (!fresh) {
      return known->second;
    }
    if (const aiTexture* embedded = picture.embedded) {
      if (embedded->mHeight == 0 && lower_case(embedded->achFormatHint) == "png") {
        known->second = std::make_shared<Image>(
            decode_png({reinterpret_cast<const std::uint8_t*>(embedded->pcData), embedded->mWidth},
                       picture.what));
      }
    } else if (lower_case(picture.file.extension().string()) == ".png") {
      files_.push_back(picture.file.string());
      known->second = std::make_shared<Image>(read_png(picture.file, picture.what));
    }
    return known->second;
  }

  /// Returns the texture of an image in sRGB. It is made once of each image with holes and once
  /// without.
  [[nodiscard]] std::shared_ptr<const sim::ColourTexture> texture(const Image& image,
                                                                  const Picture& picture,
                                                                  bool holes) {
    std::shared_ptr<const sim::ColourTexture>& known = textures_[{&image, holes}];
    if (known) {
      return known;
    }
    constexpr std::size_t kMost = sim::ColourTexture::kMostTexels;
    if (image.columns > kMost || image.rows > kMost) {
      throw std::invalid_argument(fmt::format("{}is {} x {} pixels, allowed: 1 to {} along a side",
                                              picture.what, image.columns, image.rows, kMost));
    }
    const std::size_t most = image.bits == 16 ? 65535 : 255;
    std::vector<std::uint16_t> linear(most + 1);
    for (std::size_t value = 0; value <= most; ++value) {
      linear[value] = static_cast<std::uint16_t>(std::lround(
          65535.0 * sim::linear_of_srgb(static_cast<double>(value) / static_cast<double>(most))));
    }
    const bool grey = image.channels < 3;
    std::vector<sim::Texel> texels;
    texels.reserve(image.columns * image.rows);
    // assimp's v runs upwards, an image's rows downwards.
    for (std::size_t r = image.rows; r-- > 0;) {
      for (std::size_t c = 0; c < image.columns; ++c) {
        sim::Texel& texel = texels.emplace_back();
        for (std::size_t band = 0; band < 3; ++band) {
          texel[band] = linear[image.sample(c, r, grey ? 0 : band)];
        }
        texel[3] = 65535;
        if (holes && image.has_alpha()) {
          texel[3] = static_cast<std::uint16_t>(image.sample(c, r, image.channels - 1) *
                                                (image.bits == 16 ? 1U : 257U));
        }
      }
    }
    known = std::make_shared<sim::ColourTexture>(picture.name, image.columns, image.rows,
                                                 std::move(texels));
    return known;
  }

  static sim::TextureEdge edge(const aiMaterial& material, const char* key, unsigned type,
                               unsigned index, const WavefrontMaterial* entry) {
    if (entry != nullptr) {
      return entry->map->clamp ? sim::TextureEdge::stays : sim::TextureEdge::repeats;
    }
    int mode = aiTextureMapMode_Wrap;
    (void)material.Get(key, type, index, mode);
    return mode == aiTextureMapMode_Wrap     ? sim::TextureEdge::repeats
           : mode == aiTextureMapMode_Mirror ? sim::TextureEdge::mirrors
                                             : sim::TextureEdge::stays;
  }

  /// Each once.
  void note(const std::string& text) {
    if (std::ranges::find(notes_, text) == notes_.end()) {
      notes_.push_back(text);
    }
  }

  std::filesystem::path path_;
  std::string who_;
  bool gltf_ = false;
  std::vector<std::string> files_;
  std::string refusal_;  ///< Reason why a file that assimp asked for was refused; empty: none.
  std::vector<std::string> notes_;
  WavefrontMesh scanned_;  ///< Contents of an OBJ file.
  std::vector<Library> libraries_;
  std::optional<sim::TriangleMesh> plain_;
  std::map<std::string, std::shared_ptr<const Image>> images_;
  std::map<std::pair<const Image*, bool>, std::shared_ptr<const sim::ColourTexture>> textures_;
  std::vector<std::unique_ptr<Assimp::BaseImporter>> removed_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
};

void check(const sim::TriangleMesh& mesh, const std::filesystem::path& file) {
  try {
    sim::validate(mesh);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("file '" + file.string() + "': " + error.what());
  }
}

/// Removes triangles that no ray can hit; throws when none is left.
void finish(LoadedModel& model, const std::filesystem::path& file, const std::string& name) {
  for (sim::TriangleMesh& part : model.parts) {
    model.dropped += sim::drop_bad_triangles(part);
    if (!part.triangles.empty()) {
      check(part, file);
    }
  }
  std::erase_if(model.parts, [](const sim::TriangleMesh& part) { return part.triangles.empty(); });
  if (model.parts.empty()) {
    throw std::invalid_argument(fmt::format(
        "mesh '{}', file '{}': has no triangle that a ray can meet ({} not finite, {} over {} m "
        "from its origin, {} without area)",
        name, file.string(), model.dropped.not_finite, model.dropped.too_far,
        sim::kFarthestVertex_m, model.dropped.no_area));
  }
}

}  // namespace

sim::TriangleMesh load_mesh(const std::filesystem::path& file, const std::string& name) {
  const File opened(file, name, Wanted::triangles);
  sim::TriangleMesh mesh = opened.plain() != nullptr ? *opened.plain() : sim::TriangleMesh{};
  mesh.name = name;
  for (unsigned m = 0; opened.plain() == nullptr && m < opened.scene().mNumMeshes; ++m) {
    opened.append(*opened.scene().mMeshes[m], mesh);
  }
  check(mesh, file);
  return mesh;
}

LoadedModel load_model(const std::filesystem::path& file, const std::string& name) {
  File opened(file, name, Wanted::surfaces);
  LoadedModel model;
  if (opened.plain() != nullptr) {
    model.parts.push_back(*opened.plain());
    model.parts.back().name = name;
    finish(model, file, name);
    return model;
  }
  const aiScene& scene = opened.scene();
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    sim::TriangleMesh part;
    part.name = name;
    // One part for each material: all triangles of the scene that have it.
    part.material = scene.mMaterials[i]->GetName().C_Str();
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[m];
      if (mesh.mMaterialIndex != i) {
        continue;
      }
      opened.append(mesh, part);
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        part.texture_coordinates.push_back(opened.coordinates(mesh, v));
      }
    }
    if (part.triangles.empty()) {
      continue;
    }
    const aiMaterial& material = *scene.mMaterials[i];
    part.alpha = opened.mask(material);
    part.colour = opened.colour(material, part.alpha != nullptr);
    const bool textured = part.colour && part.colour->texture;
    for (unsigned m = 0; m < scene.mNumMeshes && textured; ++m) {
      if (scene.mMeshes[m]->mMaterialIndex == i) {
        opened.require_coordinates(*scene.mMeshes[m], material);
      }
    }
    if (!part.alpha && !textured) {
      part.texture_coordinates.clear();
    }
    model.parts.push_back(std::move(part));
  }
  model.notes = opened.notes();
  finish(model, file, name);
  return model;
}

std::vector<std::string> mesh_files(const std::filesystem::path& file) {
  File opened(file, file.string(), Wanted::surfaces);
  for (unsigned i = 0; opened.plain() == nullptr && i < opened.scene().mNumMaterials; ++i) {
    const aiMaterial& material = *opened.scene().mMaterials[i];
    (void)opened.colour(material, opened.mask(material) != nullptr);
  }
  return opened.files();
}

std::vector<sim::TriangleMesh> load_meshes(const std::vector<sim::FixedObject>& objects,
                                           std::vector<std::string>& report) {
  std::vector<sim::TriangleMesh> meshes;
  std::set<std::string> known;
  for (const sim::FixedObject& object : objects) {
    if (!known.insert(object.mesh).second) {
      continue;
    }
    LoadedModel model = load_model(object.mesh, object.mesh);
    report.insert(report.end(), model.notes.begin(), model.notes.end());
    const sim::DroppedTriangles& dropped = model.dropped;
    if (dropped.total() > 0) {
      report.push_back(fmt::format(
          "mesh '{}': {} triangles left out ({} not finite, {} over {} m from the origin, {} "
          "without area)",
          object.mesh, dropped.total(), dropped.not_finite, dropped.too_far, sim::kFarthestVertex_m,
          dropped.no_area));
    }
    std::ranges::move(model.parts, std::back_inserter(meshes));
  }
  return meshes;
}

}  // namespace rigwire::hil
