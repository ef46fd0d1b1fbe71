#include "hil/files/private_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

#include "drivers/endpoints.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

PrivateFolder::PrivateFolder(std::string_view purpose) {
  std::string name =
      (fs::temp_directory_path() / fmt::format("rigwire-{}-XXXXXX", purpose)).string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw drivers::EndpointError(fmt::format("a folder of the run's own: {}: {}", name,
                                             std::generic_category().message(errno)));
  }
  path_ = name;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace rigwire::hil
