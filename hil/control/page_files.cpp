#include "hil/control/page_files.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "drivers/endpoints.h"
#include "hil/configuration/build_facts.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;

struct Row {
  std::string_view path;     ///< Path in a client's request.
  std::string_view file;     ///< Name in its folder.
  std::string_view package;  ///< Debian package; empty: part of the page itself.
};

constexpr std::array<Row, 25> kRows{{
    {"/", "index.html", ""},
    {"/page/style.css", "style.css", ""},
    {"/page/main.js", "main.js", ""},
    {"/page/run.js", "run.js", ""},
    {"/page/view.js", "view.js", ""},
    {"/page/air.js", "air.js", ""},
    {"/page/buses.js", "buses.js", ""},
    {"/page/cdr.js", "cdr.js", ""},
    {"/page/glb.js", "glb.js", ""},
    {"/page/wires.js", "wires.js", ""},
    {"/page/plots.js", "plots.js", ""},
    {"/page/events.js", "events.js", ""},
    {"/page/hands.js", "hands.js", ""},
    {"/page/kept.js", "kept.js", ""},
    {"/page/lateness.js", "lateness.js", ""},
    {"/page/recent.js", "recent.js", ""},
    {"/page/recording.js", "recording.js", ""},
    {"/page/registers.js", "registers.js", ""},
    {"/page/sensors.js", "sensors.js", ""},
    {"/page/suggest.js", "suggest.js", ""},
    {"/page/timeline.js", "timeline.js", ""},
    {"/lib/three/build/three.module.js", "three/build/three.module.js", "libjs-three"},
    {"/lib/three/examples/jsm/controls/OrbitControls.js",
     "three/examples/jsm/controls/OrbitControls.js", "libjs-three"},
    {"/lib/chart.js/chart.mjs", "chart.js/chart.mjs", "libjs-chart.js"},
    {"/lib/chart.js/chunks/helpers.segment.mjs", "chart.js/chunks/helpers.segment.mjs",
     "libjs-chart.js"},  // which the former brings in
}};
constexpr std::string_view kLibraries = "/usr/share/javascript";

std::string_view type_of(std::string_view file) {
  return file.ends_with(".html")  ? "text/html; charset=utf-8"
         : file.ends_with(".css") ? "text/css; charset=utf-8"
                                  : "text/javascript; charset=utf-8";
}

/// Beside the program, as it is installed, else in the tree that it was built from.
fs::path page_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  fs::path installed = program.parent_path().parent_path() / "share/rigwire/dashboard";
  return fs::is_directory(installed, error) ? installed : fs::path(source_page());
}

}  // namespace

PageFiles::PageFiles() {
  const fs::path own = page_folder();
  for (const Row& row : kRows) {
    const fs::path path = (row.package.empty() ? own : fs::path(kLibraries)) / row.file;
    std::ifstream file(path, std::ios::binary);
    std::string content{std::istreambuf_iterator<char>(file), {}};
    if (!file || content.empty()) {
      throw drivers::EndpointError(fmt::format(
          "--dashboard: {} cannot be read{}", path.string(),
          row.package.empty() ? std::string() : fmt::format("; install {}", row.package)));
    }
    files_[std::string(row.path)] = {std::string(type_of(row.file)), std::move(content)};
  }
}

const PageFile* PageFiles::find(std::string_view path) const {
  const auto found = files_.find(path);
  return found == files_.end() ? nullptr : &found->second;
}

}  // namespace rigwire::hil
