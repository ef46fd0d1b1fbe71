// What cameras need of Wavefront's files beyond triangles: which material has which colour and
// picture, and whether the file's own numbers hold. Triangles are read by assimp (mesh_file.h),
// which knows no lines, leaves options of textures out and takes what is no number for 0.
//
// Sources: Wavefront, "Advanced Visualizer Manual", appendix B1, "Object Files (.obj)"; D. Ramey,
// L. Rose, L. Tyerman, "MTL material format (Lightwave, OBJ)", 1995. A line that ends in a
// backslash goes on; the rest of a line after `mtllib`, `usemtl`, `newmtl` or a map's options is
// one name, blanks in it included.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {

/// A name with the line that says it, counted from 1.
struct WavefrontName {
  std::string name;
  std::size_t line = 0;
};

struct WavefrontMesh {
  std::vector<WavefrontName> libraries;  ///< Files, as they are called.
  /// By material: line of its first face with a corner that has no texture coordinate.
  std::map<std::string, std::size_t, std::less<>> bare_faces;
};

/// Reads the lines that have to do with textures: v, vt, vn, f, mtllib, usemtl. `who` is the file's
/// name. Throws std::invalid_argument "FILE:LINE: what, found, allowed" for texture coordinates
/// that are no finite numbers, and corners that name a vertex, a coordinate or a normal that the
/// file does not have.
[[nodiscard]] WavefrontMesh scan_wavefront_mesh(std::string_view text, const std::string& who);

struct WavefrontMap {
  std::string file;  ///< Name of the file in the library, with slashes.
  std::size_t line = 0;
  /// A texture coordinate c becomes scale * c + offset (-s, -o).
  std::array<double, 2> scale{1.0, 1.0};
  std::array<double, 2> offset{0.0, 0.0};
  bool clamp = false;  ///< -clamp on: the edge's colour goes on outside.
};

struct WavefrontMaterial {
  std::string name;
  std::size_t line = 0;
  std::optional<std::array<double, 3>> colour;  ///< Kd, linear, 0 .. 1.
  std::optional<WavefrontMap> map;              ///< map_Kd
};

/// Materials in their order, of each name the first. `notes` get a line for each option and
/// material that has no effect. Statements other than newmtl, Kd and map_Kd are left to others.
/// Throws std::invalid_argument "FILE:LINE: what, found, allowed".
[[nodiscard]] std::vector<WavefrontMaterial> read_wavefront_materials(
    std::string_view text, const std::string& who, std::vector<std::string>& notes);

}  // namespace rigwire::hil
