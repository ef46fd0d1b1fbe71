#include "hil/files/file_content.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/outside_file.h"
#include "hil/configuration/reader.h"
#include "hil/files/dbc_node_file.h"
#include "hil/files/geoid_file.h"
#include "hil/files/mesh_file.h"
#include "hil/files/valve_map_file.h"

namespace rigwire::hil {
namespace {

std::string bytes_of(const std::string& path, FileLimit limit) {
  try {
    OutsideFile file(path, limit);
    std::uint64_t hash = fnv1a("");
    std::vector<std::uint8_t> piece(256 * 1024);
    while (const std::size_t count = file.read(piece)) {
      hash = fnv1a({reinterpret_cast<const char*>(piece.data()), count}, hash);
    }
    return fmt::format("{:016x}", hash);
  } catch (const FileRefused&) {
    return std::filesystem::path(path).filename().string();
  }
}

std::string mesh_content(const std::string& path) {
  try {
    std::string all;
    for (const std::string& file : mesh_files(path)) {
      all += bytes_of(file, kMeshFile);
    }
    return fmt::format("{:016x}", fnv1a(all));
  } catch (const std::invalid_argument&) {
    return bytes_of(path, kMeshFile);
  }
}

std::string memory_content(const std::string& path) {
  try {
    const OutsideFile file(path, kSettingsFile);
  } catch (const FileRefused& refused) {
    if (refused.error() == ENOENT) {
      return "";
    }
  }
  return bytes_of(path, kSettingsFile);
}

template <class Struct>
std::string document_content(const std::string& path, FileLimit limit) {
  Problems problems;
  Origins origins;
  Struct content;
  const Value document = load_document(path, problems);
  read(document, content, problems, origins);
  return problems.empty() ? hash_text(outline(content), file_content) : bytes_of(path, limit);
}

}  // namespace

std::string file_content(const std::string& path, fields::FileKind kind) {
  using fields::FileKind;
  if (path.empty()) {
    return kind == FileKind::geoid ? bytes_of(kEgm96File, kGeoidFile) : "";
  }
  switch (kind) {
    case FileKind::mesh:
      return mesh_content(path);
    case FileKind::valve_map:
      return document_content<emulators::ValveMap>(path, limit_of(kind));
    case FileKind::dbc_node:
      return document_content<DbcNodeBinding>(path, limit_of(kind));
    case FileKind::memory:
      return memory_content(path);
    case FileKind::data:
    case FileKind::geoid:
    case FileKind::calibration:
    case FileKind::dbc:
    case FileKind::height_map:
    case FileKind::motion:
    case FileKind::replay:
    case FileKind::satellites:
    case FileKind::table:
      break;
  }
  return bytes_of(path, limit_of(kind));
}

}  // namespace rigwire::hil
