#include "hil/command_line/config_files.h"

#include <algorithm>
#include <memory>
#include <set>
#include <system_error>

#include "hil/configuration/config_folders.h"
#include "hil/configuration/document.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/problems.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

std::vector<ConfigFile> config_files(const std::string& kind) {
  std::vector<ConfigFile> files;
  std::set<std::string> seen;
  for (const fs::path& folder : config_folders()) {
    std::error_code error;
    for (fs::directory_iterator it(folder / kind, error), end; !error && it != end;
         it.increment(error)) {
      const fs::path& path = it->path();
      // A name that cannot be shown cannot be given either.
      if (path.extension() != ".yaml" || find_fault(path.string(), TextShape::one_line) ||
          !seen.insert(path.stem().string()).second) {
        continue;
      }
      files.push_back({path.stem().string(), path.string()});
    }
  }
  std::sort(files.begin(), files.end(),
            [](const ConfigFile& a, const ConfigFile& b) { return a.name < b.name; });
  return files;
}

std::string page_file(const std::string& page) {
  for (const fs::path& folder : config_folders()) {
    // Documents lie beside the configurations, in both.
    const fs::path file = folder.parent_path() / page;
    std::error_code error;
    if (fs::is_regular_file(file, error) && !find_fault(file.string(), TextShape::one_line)) {
      return file.string();
    }
  }
  return page;
}

std::string text_of(const ConfigFile& file) {
  Problems problems;
  const Value document = load_document(file.path, problems);
  const Value* text = document.find("text");
  return text == nullptr ? "" : printable(text->scalar);
}

std::string find_rig(const std::string& rig) {
  std::error_code error;
  // A dangling link exists here; opening it reports the error.
  if (fs::exists(fs::symlink_status(rig, error))) {
    return rig;
  }
  std::vector<std::string> names;
  for (const ConfigFile& file : config_files("rigs")) {
    if (file.name == rig || file.name + ".yaml" == rig) {
      return file.path;
    }
    names.push_back(file.name);
  }
  Problem problem;
  problem.where.source = std::make_shared<const std::string>(rig);
  problem.what = "no such file";
  if (rig.find('/') == std::string::npos) {
    problem.what += ", and no rig of that name";
    problem.allowed = join_words(names);
  }
  problem.suggestion = nearest_file(rig);
  if (problem.suggestion.empty()) {
    problem.suggestion = nearest_word(fs::path(rig).stem().string(), names);
  }
  throw ConfigurationError({problem});
}

}  // namespace rigwire::hil
