// The table of a suite: each row is written once, as a line of columns for people and as an object
// for scripts. Figures of the object are in the unit that their key ends with; those of the line
// may be in a handier one.
#pragma once

#include <concepts>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::bench {

struct Column {
  std::string heading;
  std::string layout;  ///< Alignment and width as fmt writes them, "<24"; empty: as wide as it is.
};

/// One value of a row: in a column, in the object, or both.
struct Cell {
  std::string key;  ///< Key in the object; empty: in the line only.
  nlohmann::json value;
  bool shown = true;  ///< False: in the object only.
  std::string text;
};

[[nodiscard]] Cell word(std::string_view key, std::string_view text);
/// `format` is fmt's for one double, "{:.1f}%"; the line shows factor times the value. A non-finite
/// value is null in the object, as JSON has no such number.
[[nodiscard]] Cell number(std::string_view key, double value, std::string_view format,
                          double factor = 1.0);
template <std::integral Count>
[[nodiscard]] Cell count(std::string_view key, Count value) {
  return {std::string(key), value, true, std::to_string(value)};
}
/// With a text of its own.
[[nodiscard]] Cell cell(std::string_view key, nlohmann::json value, std::string_view text);
/// In the line only.
[[nodiscard]] Cell shown(std::string_view text);
/// In the object only.
[[nodiscard]] Cell stored(std::string_view key, nlohmann::json value);

/// Null when it is not finite.
[[nodiscard]] nlohmann::json number_or_null(double value);

class Table {
 public:
  /// Lines go to `text`, which must outlive the table.
  Table(std::ostream& text, std::vector<Column> columns);

  /// A line of the headings.
  void head() const;
  /// Writes the line, gives back the object. There are as many cells with a text as columns, in
  /// their order.
  nlohmann::json row(const std::vector<Cell>& cells) const;

 private:
  void line(const std::vector<std::string_view>& texts) const;

  std::ostream& text_;
  std::vector<Column> columns_;
};

}  // namespace rigwire::bench
