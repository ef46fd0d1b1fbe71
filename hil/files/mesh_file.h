// Meshes from files: glTF 2.0, Wavefront OBJ and STL as assimp reads them, PLY (ply_file.h). Others
// are refused.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scene/mesh_repair.h"
#include "sim/scene/scene_description.h"
#include "sim/scene/triangle_mesh.h"

namespace rigwire::hil {

/// Returns all triangles of the file as one mesh named `name`, x forward, y left, z up, in the
/// file's unit; polygons are split into triangles, points and lines left out, textures ignored. Of
/// glTF (.gltf, .glb), whose y is up and whose z is forward (Khronos, glTF 2.0, 3.3), axes are
/// exchanged; other formats keep theirs. Throws std::invalid_argument naming the file when it is
/// missing or cannot be read, or holds no mesh that sim::validate() accepts.
[[nodiscard]] sim::TriangleMesh load_mesh(const std::filesystem::path& file,
                                          const std::string& name);

/// A file's triangles, one mesh for each of its materials, all named `name`.
struct LoadedModel {
  std::vector<sim::TriangleMesh> parts;
  sim::DroppedTriangles dropped;
  std::vector<std::string> notes;  ///< Messages to the user: what of the file has no effect.
};

/// Loads like load_mesh(), with colours and textures.
///
/// Where a material's base colour is a PNG image with an alpha channel, beside the file or
/// embedded, rays pass its holes. The cutoff is glTF's alphaCutoff, else half.
///
/// Colours (TriangleMesh::colour) are those of OBJ and glTF: Kd and map_Kd of a material library
/// with -s, -o and -clamp (hil/files/wavefront_file.h; the picture beside the library), base colour
/// factor and texture with the sampler's wrapping. Factors are linear, pictures sRGB (glTF 2.0,
/// 3.9.2). A glTF factor of white without a texture, also by default, is no colour.
///
/// Pictures of other formats than PNG are not opened, nor are glTF's texture transforms followed:
/// there is a note. Bad triangles (sim/scene/mesh_repair.h) are left out and counted. Throws also
/// when a material library or a PNG picture is missing, damaged, or over
/// sim::ColourTexture::kMostTexels along a side, when a surface with a picture has no texture
/// coordinates, as scan_wavefront_mesh() and read_wavefront_materials() do, and when no good
/// triangle is left.
[[nodiscard]] LoadedModel load_model(const std::filesystem::path& file, const std::string& name);

/// The files that load_model() opens, the mesh's own first: those of its materials, buffers and PNG
/// textures too. Throws as load_model() does for a file that is none.
[[nodiscard]] std::vector<std::string> mesh_files(const std::filesystem::path& file);

/// The meshes of all objects, each file once, for sim::build_scene(). `report` gets a line for each
/// file of which triangles were left out.
[[nodiscard]] std::vector<sim::TriangleMesh> load_meshes(
    const std::vector<sim::FixedObject>& objects, std::vector<std::string>& report);

}  // namespace rigwire::hil
