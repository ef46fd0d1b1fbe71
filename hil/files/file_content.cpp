#include "hil/files/file_content.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/configuration/outline.h"
#include "hil/configuration/reader.h"
#include "hil/files/dbc_node_file.h"
#include "hil/files/geoid_file.h"
#include "hil/files/mesh_file.h"
#include "hil/files/valve_map_file.h"

namespace rigwire::hil {
namespace {

std::string bytes_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) {
    return std::filesystem::path(path).filename().string();
  }
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  return fmt::format("{:016x}", fnv1a(bytes.str()));
}

std::string mesh_content(const std::string& path) {
  try {
    std::string all;
    for (const std::string& file : mesh_files(path)) {
      all += bytes_of(file);
    }
    return fmt::format("{:016x}", fnv1a(all));
  } catch (const std::invalid_argument&) {
    return bytes_of(path);
  }
}

template <class Struct>
std::string document_content(const std::string& path) {
  Problems problems;
  Origins origins;
  Struct content;
  const Value document = load_document(path, problems);
  read(document, content, problems, origins);
  return problems.empty() ? hash_text(outline(content), file_content) : bytes_of(path);
}

}  // namespace

std::string file_content(const std::string& path, fields::FileKind kind) {
  using fields::FileKind;
  if (path.empty()) {
    return kind == FileKind::geoid ? bytes_of(kEgm96File) : "";
  }
  switch (kind) {
    case FileKind::mesh:
      return mesh_content(path);
    case FileKind::valve_map:
      return document_content<emulators::ValveMap>(path);
    case FileKind::dbc_node:
      return document_content<DbcNodeBinding>(path);
    case FileKind::memory:
      return std::filesystem::exists(path) ? bytes_of(path) : "";
    case FileKind::data:
    case FileKind::geoid:
      break;
  }
  return bytes_of(path);
}

}  // namespace rigwire::hil
