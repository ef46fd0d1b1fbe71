#include "hil/configuration/origins.h"

namespace rigwire::hil {

Location Origins::of(const std::string& path) const {
  const auto it = places_.find(path);
  return it == places_.end() ? Location{} : it->second;
}

Location Origins::nearest(std::string path) const {
  while (true) {
    const auto it = places_.find(path);
    if (it != places_.end()) {
      return it->second;
    }
    if (path.empty()) {
      return {};
    }
    const std::size_t dot = path.rfind('.');
    path = dot == std::string::npos ? std::string() : path.substr(0, dot);
  }
}

}  // namespace rigwire::hil
