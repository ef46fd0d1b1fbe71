// A YAML file that is one structure: how profiles and lists of known deviations are read.
#pragma once

#include <string>

#include "hil/configuration/document.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

/// Throws ConfigurationError with every problem of the file.
template <class Structure>
[[nodiscard]] Structure read_structure(const std::string& file) {
  Problems problems;
  Origins origins;
  Structure structure;
  const Value document = load_document(file, problems);
  if (problems.empty()) {
    read(document, structure, problems, origins);
  }
  problems.throw_if_any();
  return structure;
}

}  // namespace rigwire::hil
