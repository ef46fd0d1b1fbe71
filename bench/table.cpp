#include "bench/table.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

namespace rigwire::bench {

Cell word(std::string_view key, std::string_view text) {
  return {std::string(key), text, true, std::string(text)};
}

Cell number(std::string_view key, double value, std::string_view format, double factor) {
  return {std::string(key), number_or_null(value), true,
          fmt::format(fmt::runtime(format), factor * value)};
}

Cell cell(std::string_view key, nlohmann::json value, std::string_view text) {
  return {std::string(key), std::move(value), true, std::string(text)};
}

Cell shown(std::string_view text) {
  return {"", {}, true, std::string(text)};
}

Cell stored(std::string_view key, nlohmann::json value) {
  return {std::string(key), std::move(value), false, ""};
}

nlohmann::json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

Table::Table(std::ostream& text, std::vector<Column> columns)
    : text_(text), columns_(std::move(columns)) {}

void Table::head() const {
  std::vector<std::string_view> headings;
  for (const Column& column : columns_) {
    headings.push_back(column.heading);
  }
  line(headings);
}

nlohmann::json Table::row(const std::vector<Cell>& cells) const {
  nlohmann::json object = nlohmann::json::object();
  std::vector<std::string_view> texts;
  for (const Cell& cell : cells) {
    if (!cell.key.empty()) {
      object[cell.key] = cell.value;
    }
    if (cell.shown) {
      texts.push_back(cell.text);
    }
  }
  line(texts);
  return object;
}

void Table::line(const std::vector<std::string_view>& texts) const {
  assert(texts.size() == columns_.size());
  std::string line;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    line += i == 0 ? "" : " ";
    line += fmt::format(fmt::runtime("{:" + columns_[i].layout + "}"), texts[i]);
  }
  text_ << line << "\n";
}

}  // namespace rigwire::bench
