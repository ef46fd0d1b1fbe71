#include "hil/campaign/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "hil/configuration/outside_file.h"
#include "hil/configuration/plain_text.h"
#include "hil/configuration/suggest.h"

namespace rigwire::hil {

std::vector<std::string> CsvTable::column(const std::string& wanted) const {
  const auto found = std::ranges::find(columns, wanted);
  if (found == columns.end()) {
    throw std::invalid_argument(fmt::format("{}: no such column, found \"{}\", allowed {}", name,
                                            printable(wanted), join_words(columns)));
  }
  std::vector<std::string> values;
  for (const std::vector<std::string>& row : rows) {
    values.push_back(row[static_cast<std::size_t>(found - columns.begin())]);
  }
  return values;
}

CsvTable parse_csv(const std::string& text, const std::string& name) {
  if (const auto fault = find_fault(text, TextShape::lines)) {
    throw std::invalid_argument(
        fmt::format("{}: {}, found {}, allowed UTF-8 text", name, fault->what, fault->found));
  }
  CsvTable table;
  table.name = name;
  std::size_t line = 0;
  for (std::size_t at = 0; at < text.size();) {
    ++line;
    if (text[at] == '#') {
      at = std::min(text.size(), text.find('\n', at)) + 1;
      continue;
    }
    std::vector<std::string> row(1);
    bool quoted = false;
    for (; at < text.size() && (quoted || text[at] != '\n'); ++at) {
      const char c = text[at];
      if (c == '"' && quoted && at + 1 < text.size() && text[at + 1] == '"') {
        row.back() += '"';
        ++at;
      } else if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        row.emplace_back();
      } else if (c == '\r' && !quoted && at + 1 < text.size() && text[at + 1] == '\n') {
        continue;  // RFC 4180 ends its lines with both
      } else {
        row.back() += c;
      }
    }
    ++at;
    if (quoted) {
      throw std::invalid_argument(fmt::format("{}:{}: a quote that does not end", name, line));
    }
    if (row.size() == 1 && row.front().empty()) {
      continue;
    }
    if (table.columns.empty()) {
      table.columns = std::move(row);
    } else if (row.size() != table.columns.size()) {
      throw std::invalid_argument(fmt::format("{}:{}: found {} fields, allowed {}", name, line,
                                              row.size(), table.columns.size()));
    } else {
      table.rows.push_back(std::move(row));
    }
  }
  if (table.rows.empty()) {
    throw std::invalid_argument(name + ": no rows, allowed a line of names and one or more below");
  }
  return table;
}

CsvTable read_csv(const std::filesystem::path& file) {
  return parse_csv(read_outside_file(file, kTableFile), printable(file.string()));
}

std::string csv_line(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    line += &field == fields.data() ? "" : ",";
    if (field.find_first_of(",\"\n\r#") == std::string::npos) {
      line += field;
      continue;
    }
    line += '"';
    for (const char c : field) {
      line += c == '"' ? std::string("\"\"") : std::string(1, c);
    }
    line += '"';
  }
  return line + "\n";
}

}  // namespace rigwire::hil
