// What the reader says of a text.
#pragma once

#include <string>

#include "hil/configuration/problems.h"
#include "hil/configuration/reader.h"

namespace rigwire::hil {

/// One per line, sorted by place.
inline std::string lines_of(const Problems& problems) {
  std::string text;
  for (const Problem& problem : problems.sorted()) {
    text += problem.line() + "\n";
  }
  return text;
}

/// Reads YAML text as file "a.yaml" of the working directory into `value`; empty when all is well.
template <class Struct>
std::string findings_of(const std::string& yaml, Struct& value) {
  Problems problems;
  const Value document = parse_document(yaml, "a.yaml", ".", problems);
  Origins origins;
  read(document, value, problems, origins);
  return lines_of(problems);
}

}  // namespace rigwire::hil
