// Tables of text that fit their window: columns as wide as their contents, and never wider than the
// window.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::hil {

/// Returns the columns of a terminal that a printable text takes: none for combining marks, two for
/// wide characters (Unicode 15.1: general category Mn and Me, East Asian Width W and F, by blocks).
[[nodiscard]] std::size_t display_width(std::string_view text);

/// Returns the beginning of a printable text that takes at most so many columns; its last character
/// is an ellipsis where something is missing.
[[nodiscard]] std::string clipped(const std::string& text, std::size_t columns);

struct Cell {
  std::string text;              ///< Printable.
  const char* colour = nullptr;  ///< SGR parameters: "33"; null: as it is.
};

struct Column {
  std::string title;
  bool right = false;      ///< Aligns the column right, as for numbers.
  unsigned sacrifice = 0;  ///< A narrow window leaves out the highest first; 0: never.
  std::size_t least = 0;   ///< May be cut down to so many columns, and further when all else is
                           ///< gone; 0: not cut.
};

class TextTable {
 public:
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// One cell for each column.
  void add(std::vector<Cell> row) { rows_.push_back(std::move(row)); }
  /// Title and rows, without line ends. `width` 0: as wide as it gets.
  [[nodiscard]] std::vector<std::string> lines(std::size_t width, bool colour) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

[[nodiscard]] std::string painted(const std::string& text, const char* code, bool colour);

}  // namespace rigwire::hil
