// Where rigs, machines and scenes are found: by path, or by name in the folders of configurations.
#pragma once

#include <string>
#include <vector>

namespace rigwire::hil {

/// One file of a kind ("rigs", "machines", "scenes").
struct ConfigFile {
  std::string name;  ///< Without folder and ending: "excavator_pit".
  std::string path;
};

/// All files of the kind, sorted by name; a name that two folders have counts once.
[[nodiscard]] std::vector<ConfigFile> config_files(const std::string& kind);

/// Where a page of the documents lies, "docs/scenes.md" in the source tree: as a file of the
/// installation or of the source tree; the page's own name where neither has it.
[[nodiscard]] std::string page_file(const std::string& page);

/// Its `text` key, which is read now; empty when it has none.
[[nodiscard]] std::string text_of(const ConfigFile& file);

/// The file that `rig` means: a path relative to the working folder, else a name in the folders.
/// Throws ConfigurationError with what was tried and the nearest names.
[[nodiscard]] std::string find_rig(const std::string& rig);

}  // namespace rigwire::hil
