#include "hil/files/new_folder.h"

#include <fmt/format.h>

#include <string>
#include <system_error>

#include "drivers/endpoints.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

void make_new_folder(std::string_view what, const fs::path& folder) {
  std::error_code error;
  const auto refuse = [&](const std::string& why) {
    throw drivers::EndpointError(fmt::format("{} {}: {}", what, folder.string(), why));
  };
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    refuse("a file is there; allowed a folder that is new or empty");
  }
  fs::create_directories(folder, error);
  if (error) {
    refuse("cannot be made: " + error.message());
  }
  const bool empty = fs::is_empty(folder, error);
  if (error) {
    refuse("cannot be read: " + error.message());
  }
  if (!empty) {
    refuse(
        fmt::format("the folder is not empty, found {}; allowed a folder that is new or "
                    "empty",
                    fs::directory_iterator(folder)->path().filename().string()));
  }
}

}  // namespace rigwire::hil
