// The problems of a configuration: every finding of one pass, each with its place.
//
// Line of a finding, stable and greppable:
//
//   rigs/pit.yaml:12:7: devices.gnss.rate: wrong unit, found 5 MPa, allowed Hz, kHz, MHz
//   --set devices.gnss.ratte=5: devices.gnss.ratte: unknown key, did you mean rate?
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {

/// Where a value was written. Line and column count from 1; 0 means "the file as a whole", or a
/// source without lines (a --set argument). Without a source the value is a default.
struct Location {
  std::shared_ptr<const std::string> source;  ///< File as the user named it, or "--set KEY=VALUE".
  int line = 0;
  int column = 0;
  int layer = 0;  ///< Precedence: the source with the higher layer overrides the other.

  [[nodiscard]] bool is_default() const { return source == nullptr; }
  /// Written by a --set, not in a file.
  [[nodiscard]] bool is_argument() const {
    return source != nullptr && line == 0 && source->starts_with("--set ");
  }
  /// "file.yaml:12:7", "file.yaml", "--set a.b=1" or "default"; of a request as a whole its name,
  /// "the request". Printable.
  [[nodiscard]] std::string text() const;
  /// Returns text() without the column, for the origin comments of `rigwire check --print`.
  [[nodiscard]] std::string line_text() const;
};

/// Returns the begin of a long text with its size, so that a message stays short; a text of at most
/// 1000 bytes whole.
[[nodiscard]] std::string shortened(const std::string& text);

/// One finding. Empty parts are left out of the line.
struct Problem {
  Location where;
  std::string path;        ///< Key path from the top of the document: "devices.gnss.rate".
  std::string what;        ///< What is wrong: "wrong unit".
  std::string found;       ///< The value as it was written.
  std::string allowed;     ///< What would be right.
  std::string suggestion;  ///< The nearest thing the user may have meant.

  /// Whatever the file held, the line is one, and can be shown (plain_text.h).
  [[nodiscard]] std::string line() const;
};

class Origins;

/// The findings of one pass, in the order of the places they point to.
class Problems {
 public:
  /// Maximum number of findings that are kept; further ones are counted. Users read no more, and
  /// each costs further work.
  static constexpr std::size_t kMostTold = 100;

  void add(Problem problem);
  /// Gives each finding the path that was written; removes findings that are then equal.
  void name_as_written(const Origins& origins);
  [[nodiscard]] bool empty() const { return list_.empty(); }
  /// Returns whether a further finding would only be counted.
  [[nodiscard]] bool full() const { return list_.size() >= kMostTold; }
  [[nodiscard]] std::size_t size() const { return list_.size() + untold_; }
  /// Returns the findings sorted by source (files in the order of their first finding), line and
  /// column; last, if there are more, their number.
  [[nodiscard]] std::vector<Problem> sorted() const;
  /// Throws ConfigurationError when there are any.
  void throw_if_any() const;

 private:
  std::vector<Problem> list_;
  std::size_t untold_ = 0;
};

/// Set-up refused: what() holds every problem, one per line.
class ConfigurationError : public std::runtime_error {
 public:
  explicit ConfigurationError(std::vector<Problem> problems);
  [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

/// Where each value that is no default was written, by key path.
class Origins {
 public:
  void set(const std::string& path, const Location& where) { places_[path] = where; }
  /// Records that the value at `path` was written at the path `written`.
  void moved(const std::string& path, const std::string& written) { written_[path] = written; }
  /// Returns the path under which the value at `path` was written: `path`, unless it or something
  /// above it was moved.
  [[nodiscard]] std::string written(const std::string& path) const;
  /// Returns where exactly that key was written; a default location if it was not.
  [[nodiscard]] Location of(const std::string& path) const;
  /// Returns where the key, or the nearest written key above it, was written.
  [[nodiscard]] Location nearest(std::string path) const;

 private:
  std::map<std::string, Location> places_;
  std::map<std::string, std::string> written_;
};

}  // namespace rigwire::hil
