// Any bytes as a Stanford polygon file are refused with the file's name in front, or give triangles
// whose corners exist.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string_view>

#include "hil/files/ply_file.h"

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const rigwire::sim::TriangleMesh mesh =
        rigwire::hil::read_ply(std::span<const std::uint8_t>(data, size), "input");
    require(!mesh.triangles.empty());
    for (const auto& triangle : mesh.triangles) {
      for (const auto corner : triangle) {
        require(corner < mesh.vertices.size());
      }
    }
  } catch (const std::invalid_argument& refusal) {
    require(std::string_view(refusal.what()).starts_with("input"));
  }
  return 0;
}
