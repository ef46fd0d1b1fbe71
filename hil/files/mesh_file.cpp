#include "hil/files/mesh_file.h"

#include <assimp/GltfMaterial.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/DefaultIOSystem.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cctype>
#include <memory>
#include <set>
#include <stdexcept>

#include "hil/files/image_file.h"

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

/// Remembers what assimp opens.
class OpenedFiles final : public Assimp::DefaultIOSystem {
 public:
  explicit OpenedFiles(std::vector<std::string>& names) : names_(names) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    Assimp::IOStream* stream = DefaultIOSystem::Open(file, mode);
    if (stream != nullptr && std::ranges::find(names_, file) == names_.end()) {
      names_.emplace_back(file);
    }
    return stream;
  }

 private:
  std::vector<std::string>& names_;
};

class File {
 public:
  File(const std::filesystem::path& file, const std::string& name)
      : path_(file), who_("mesh '" + name + "', file '" + file.string() + "': ") {
    if (!std::filesystem::is_regular_file(file)) {
      throw std::invalid_argument(who_ + "there is no such file");
    }
    importer_.SetIOHandler(new OpenedFiles(files_));  // the importer's from here on
    const std::string extension = lower_case(file.extension().string());
    gltf_ = extension == ".gltf" || extension == ".glb";
    importer_.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                                 aiPrimitiveType_POINT | aiPrimitiveType_LINE);
    scene_ = importer_.ReadFile(file.string(),
                                aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                    aiProcess_PreTransformVertices | aiProcess_SortByPType);
    if (scene_ == nullptr) {
      throw std::invalid_argument(who_ + importer_.GetErrorString());
    }
  }

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
    aiString texture;
    // An opacity map of its own goes before the colour's alpha.
    const bool own = material.GetTexture(aiTextureType_OPACITY, 0, &texture) == AI_SUCCESS;
    if (!own && material.GetTexture(aiTextureType_BASE_COLOR, 0, &texture) != AI_SUCCESS &&
        material.GetTexture(aiTextureType_DIFFUSE, 0, &texture) != AI_SUCCESS) {
      return nullptr;
    }
    const std::string what = who_ + "texture '" + texture.C_Str() + "' of material '" +
                             material.GetName().C_Str() + "': ";
    const auto image = open(texture, what);
    if (!image || (!own && !image->has_alpha())) {
      return nullptr;
    }
    auto mask = std::make_shared<sim::AlphaMask>();
    mask->name = texture.C_Str();
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

 private:
  /// Nothing for an image that is no PNG: it has no alpha.
  [[nodiscard]] std::unique_ptr<Image> open(const aiString& texture, const std::string& what) {
    if (const aiTexture* embedded = scene_->GetEmbeddedTexture(texture.C_Str())) {
      if (embedded->mHeight != 0 || lower_case(embedded->achFormatHint) != "png") {
        return nullptr;
      }
      return std::make_unique<Image>(decode_png(
          {reinterpret_cast<const std::uint8_t*>(embedded->pcData), embedded->mWidth}, what));
    }
    std::string name = texture.C_Str();
    std::ranges::replace(name, '\\', '/');
    const std::filesystem::path file = path_.parent_path() / name;
    if (lower_case(file.extension().string()) != ".png") {
      return nullptr;
    }
    files_.push_back(file.string());
    return std::make_unique<Image>(read_png(file, what));
  }

  std::filesystem::path path_;
  std::string who_;
  bool gltf_ = false;
  std::vector<std::string> files_;
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

}  // namespace

sim::TriangleMesh load_mesh(const std::filesystem::path& file, const std::string& name) {
  const File opened(file, name);
  sim::TriangleMesh mesh;
  mesh.name = name;
  for (unsigned m = 0; m < opened.scene().mNumMeshes; ++m) {
    opened.append(*opened.scene().mMeshes[m], mesh);
  }
  check(mesh, file);
  return mesh;
}

LoadedModel load_model(const std::filesystem::path& file, const std::string& name) {
  File opened(file, name);
  const aiScene& scene = opened.scene();
  LoadedModel model;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    sim::TriangleMesh part;
    part.name = name;
    part.material = scene.mMaterials[i]->GetName().C_Str();
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene.mMeshes[m];
      if (mesh.mMaterialIndex != i) {
        continue;
      }
      opened.append(mesh, part);
      for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        // Without coordinates the surface is the texture's first texel.
        const aiVector3D uv =
            mesh.HasTextureCoords(0) ? mesh.mTextureCoords[0][v] : aiVector3D(0.0F);
        part.texture_coordinates.emplace_back(uv.x, uv.y);
      }
    }
    if (part.triangles.empty()) {
      continue;
    }
    part.alpha = opened.mask(*scene.mMaterials[i]);
    if (!part.alpha) {
      part.texture_coordinates.clear();
    }
    model.dropped += sim::drop_bad_triangles(part);
    if (!part.triangles.empty()) {
      check(part, file);
      model.parts.push_back(std::move(part));
    }
  }
  if (model.parts.empty()) {
    throw std::invalid_argument(fmt::format(
        "mesh '{}', file '{}': has no triangle that a ray can meet ({} not finite, {} over {} m "
        "from its origin, {} without area)",
        name, file.string(), model.dropped.not_finite, model.dropped.too_far,
        sim::kFarthestVertex_m, model.dropped.no_area));
  }
  return model;
}

std::vector<std::string> mesh_files(const std::filesystem::path& file) {
  File opened(file, file.string());
  for (unsigned i = 0; i < opened.scene().mNumMaterials; ++i) {
    (void)opened.mask(*opened.scene().mMaterials[i]);
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
