// Where each value that somebody wrote stands, by key path.
#pragma once

#include <map>
#include <string>

#include "hil/configuration/problems.h"

namespace rigwire::hil {

class Origins {
 public:
  void set(const std::string& path, const Location& where) { places_[path] = where; }
  /// The place of that very key; a default location when nobody wrote it.
  [[nodiscard]] Location of(const std::string& path) const;
  /// The place of the key, or of the nearest key above it that somebody wrote.
  [[nodiscard]] Location nearest(std::string path) const;

 private:
  std::map<std::string, Location> places_;
};

}  // namespace rigwire::hil
