// Any text as an OBJ file and as a material library is refused by line, or gives materials with
// names, colours within their range and maps with finite numbers.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "hil/files/wavefront_file.h"

namespace hil = rigwire::hil;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void require_place(const std::invalid_argument& refusal) {
  require(std::string_view(refusal.what()).starts_with("input:"));
}

static void scan(std::string_view text, std::size_t lines) {
  try {
    const hil::WavefrontMesh mesh = hil::scan_wavefront_mesh(text, "input");
    for (const hil::WavefrontName& library : mesh.libraries) {
      require(!library.name.empty() && library.line >= 1 && library.line <= lines);
    }
    for (const auto& [material, line] : mesh.bare_faces) {
      require(line >= 1 && line <= lines);
    }
  } catch (const std::invalid_argument& refusal) {
    require_place(refusal);
  }
}

static void read_materials(std::string_view text, std::size_t lines) {
  std::vector<std::string> notes;
  try {
    for (const hil::WavefrontMaterial& material :
         hil::read_wavefront_materials(text, "input", notes)) {
      require(material.line >= 1 && material.line <= lines);
      if (material.colour) {
        for (const double share : *material.colour) {
          require(share >= 0.0 && share <= 1.0);
        }
      }
      if (material.map) {
        require(!material.map->file.empty());
        for (std::size_t i = 0; i < 2; ++i) {
          require(std::isfinite(material.map->scale[i]) && std::isfinite(material.map->offset[i]));
        }
      }
    }
  } catch (const std::invalid_argument& refusal) {
    require_place(refusal);
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::size_t lines = 1;
  for (const char character : text) {
    lines += character == '\n' ? 1U : 0U;
  }
  scan(text, lines);
  read_materials(text, lines);
  return 0;
}
