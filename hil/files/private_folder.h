// A folder for what a run, a comparison or a benchmark needs for itself and leaves nothing of.
#pragma once

#include <filesystem>
#include <string_view>

namespace rigwire::hil {

/// New, in the system's folder for temporary files, of the user alone; removed with all that is in
/// it when the object goes.
class PrivateFolder {
 public:
  /// Its name is "rigwire-PURPOSE-" and what makes it unique. Throws drivers::EndpointError.
  explicit PrivateFolder(std::string_view purpose);
  ~PrivateFolder();
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace rigwire::hil
