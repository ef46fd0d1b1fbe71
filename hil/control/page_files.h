// The files of a run's page, as they are served: those of hil/dashboard/, and of the libraries that
// it draws with (Debian's libjs-three and libjs-chart.js). Read once, at the start of the run; no
// path that a client sends is ever looked for in a file system.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>

namespace rigwire::hil {

struct PageFile {
  std::string type;  ///< Content-Type.
  std::string content;
};

class PageFiles {
 public:
  /// Throws drivers::EndpointError naming the file that is not there, and its package.
  PageFiles();

  /// By path without query; null where there is none.
  [[nodiscard]] const PageFile* find(std::string_view path) const;
  /// For messages.
  [[nodiscard]] const std::map<std::string, PageFile, std::less<>>& all() const { return files_; }

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

}  // namespace rigwire::hil
