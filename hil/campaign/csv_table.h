// Tables as CSV (RFC 4180): fields with commas, quotes or line ends are quoted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rigwire::hil {

struct CsvTable {
  std::string name;  ///< For messages.
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< Each as long as there are columns.

  /// Throws std::invalid_argument when there is no such column, or nothing in it.
  [[nodiscard]] std::vector<std::string> column(const std::string& wanted) const;
};

/// Lines that begin with # are left out. Throws std::invalid_argument with file and line: no UTF-8,
/// a row of another length, a quote that does not end, no row at all, more than 64 MiB.
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& file);
[[nodiscard]] CsvTable parse_csv(const std::string& text, const std::string& name);

/// One line, with its end.
[[nodiscard]] std::string csv_line(const std::vector<std::string>& fields);

}  // namespace rigwire::hil
