#include "hil/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <stdexcept>

namespace rigwire::hil {

sim::TriangleMesh load_mesh(const std::filesystem::path& file, const std::string& name) {
  const std::string who = "mesh '" + name + "', file '" + file.string() + "': ";
  if (!std::filesystem::is_regular_file(file)) {
    throw std::invalid_argument(who + "there is no such file");
  }
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                              aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                                           aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (scene == nullptr) {
    throw std::invalid_argument(who + importer.GetErrorString());
  }
  sim::TriangleMesh mesh;
  mesh.name = name;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D& p = part.mVertices[v];
      mesh.vertices.emplace_back(p.x, p.y, p.z);
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices == 3) {
        mesh.triangles.push_back(
            {base + face.mIndices[0], base + face.mIndices[1], base + face.mIndices[2]});
      }
    }
  }
  try {
    sim::validate(mesh);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("file '" + file.string() + "': " + error.what());
  }
  return mesh;
}

}  // namespace rigwire::hil
