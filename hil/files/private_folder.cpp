#include "hil/files/private_folder.h"

#include <string>
#include <system_error>

#include "drivers/temporary_folder.h"

namespace rigwire::hil {

namespace fs = std::filesystem;

PrivateFolder::PrivateFolder(std::string_view purpose) {
  path_ = drivers::make_temporary_folder("a folder of the run's own", std::string(purpose));
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace rigwire::hil
