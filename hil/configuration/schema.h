// The visitor that says a structure's rules as a JSON Schema (draft 2020-12), for editors that
// complete and check YAML while it is written, and for validators of others.
//
// Numbers are allowed bare, within their range, or as text with one of their units; a range in
// another unit than the bare one, files that must exist and what joins several keys only the
// program itself checks. Where one key decides which others there are, each of its values has them
// under a condition. Every map may have `include`, whose file can bring what is required.
#pragma once

#include <string>
#include <string_view>

#include "fields/visitor.h"

namespace rigwire::hil {

/// JSON text. The structure is used up: lists get an element, choices are tried.
[[nodiscard]] std::string schema_of_part(const fields::Part& part, std::string_view title);

template <class Struct>
[[nodiscard]] std::string schema_of(const Struct& value, std::string_view title) {
  Struct copy = value;
  return schema_of_part(fields::Part::of(copy), title);
}

}  // namespace rigwire::hil
