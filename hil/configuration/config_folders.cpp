#include "hil/configuration/config_folders.h"

#include <cstdlib>
#include <memory>
#include <system_error>

#include "hil/configuration/build_facts.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/problems.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

std::vector<fs::path> config_folders() {
  std::vector<fs::path> candidates;
  if (const char* folder = std::getenv("RIGWIRE_CONFIGS"); folder != nullptr && *folder != '\0') {
    if (const auto fault = find_fault(folder, TextShape::one_line)) {
      Problem problem;
      problem.where.source = std::make_shared<const std::string>("RIGWIRE_CONFIGS");
      problem.what = fault->what;
      problem.found = fault->found;
      problem.allowed = "UTF-8 without control characters";
      throw ConfigurationError({problem});
    }
    candidates.emplace_back(folder);
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    candidates.push_back(program.parent_path().parent_path() / "share/rigwire/configs");
  }
  candidates.emplace_back(source_configs());
  std::erase_if(candidates, [](const fs::path& path) {
    std::error_code ignored;
    return !fs::is_directory(path, ignored);
  });
  return candidates;
}

}  // namespace rigwire::hil
