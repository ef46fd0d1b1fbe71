// Whether every member of a structure keeps its rule: the same rules that reading a file applies,
// for structures that a program fills.
#pragma once

#include <stdexcept>
#include <string>

#include "fields/visitor.h"

namespace rigwire::fields {

/// A structure that breaks a rule. what(): "drives.cushion: found 0.5, allowed 0 .. 0.25".
class Refused : public std::invalid_argument {
 public:
  /// `path`: of the key within the structure, may be empty.
  Refused(std::string path, const std::string& rest);
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& rest() const { return rest_; }

 private:
  std::string path_;
  std::string rest_;
};

/// Throws Refused for the first rule that does not hold, of this structure or of a part of it; a
/// part that has a validate() of its own is asked by it. Found and allowed values are in the unit
/// that a file would write. Allocates: not for steady state.
void check_part(const Part& part);

/// For the first lines of a validate(). The structure is not changed.
template <class Struct>
void check(const Struct& value) {
  Struct copy = value;
  check_part(Part::of(copy));
}

/// For the rest of a validate(), what joins several members: throws Refused unless it `holds`.
/// `found` and `allowed` as a reader of the file would write them: in(..).print(value).
void require(bool holds, std::string path, const std::string& found, const std::string& allowed);

}  // namespace rigwire::fields
