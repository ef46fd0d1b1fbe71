#include "drivers/temporary_folder.h"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "drivers/endpoints.h"

namespace rigwire::drivers {

std::filesystem::path make_temporary_folder(const std::string& what, const std::string& name) {
  constexpr const char* kRemedy = "set TMPDIR to a folder that can be written";
  std::error_code error;
  const std::filesystem::path below = std::filesystem::temp_directory_path(error);
  if (error) {
    const char* const variable = std::getenv("TMPDIR");
    throw EndpointError(what + ": no temporary folder, found TMPDIR \"" +
                        (variable == nullptr ? "" : variable) + "\": " + error.message() + "; " +
                        kRemedy);
  }
  std::string pattern = (below / ("rigwire-" + name + "-XXXXXX")).string();
  if (::mkdtemp(pattern.data()) == nullptr) {
    const int failed = errno;
    throw EndpointError(what + ": " + pattern + ": " + std::strerror(failed) + "; " + kRemedy);
  }
  return pattern;
}

}  // namespace rigwire::drivers
