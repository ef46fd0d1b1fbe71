// A triangle mesh as binary glTF, which every viewer of 3D models reads.
//
// Source: Khronos Group, "glTF 2.0 Specification" (ISO/IEC 12113:2022), 3 "Concepts", 4 "GLB File
// Format". A file is a header (magic, version, length), a JSON chunk and a binary chunk, each
// padded to 4 bytes; everything little-endian. One node with one mesh, one primitive for each part,
// no normals (viewers shade flat without, 3.7.2.1). glTF's y is up: the node carries no rotation,
// so that the coordinates are those that were given.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace rigwire::protocols::gltf {

/// A surface of one colour. What it refers to is valid during the call.
struct Part {
  std::span<const float> vertices;         ///< x y z each.
  std::span<const std::uint32_t> corners;  ///< Three for each triangle; each a vertex there is.
  std::array<float, 3> colour{1.0F, 1.0F, 1.0F};  ///< Linear, 0 .. 1, times the vertices' own.
  /// Red, green, blue and 255 for each vertex, linear; empty: one colour.
  std::span<const std::uint8_t> vertex_colours{};
};

/// Parts without a triangle are left out.
[[nodiscard]] std::string glb(std::span<const Part> parts);

}  // namespace rigwire::protocols::gltf
