#include "field/json_line.h"

#include <cerrno>
#include <cmath>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace rigwire::field {
namespace {

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) {
    return "null";
  }
  char buffer[64];
  (void)std::snprintf(buffer, sizeof(buffer), "%.*f", decimals, value);
  return buffer;
}

}  // namespace

void JsonLine::key(std::string_view key) {
  line_ += line_.back() == '{' ? "\"" : ",\"";
  line_ += key;
  line_ += "\":";
}

void JsonLine::number(std::string_view name, double value, int decimals) {
  key(name);
  line_ += fixed(value, decimals);
}

void JsonLine::number(std::string_view name, const std::optional<double>& value, int decimals) {
  key(name);
  line_ += value ? fixed(*value, decimals) : "null";
}

void JsonLine::whole(std::string_view name, std::int64_t value) {
  key(name);
  line_ += std::to_string(value);
}

void JsonLine::numbers(std::string_view name, std::span<const double> values, double scale,
                       int decimals) {
  key(name);
  line_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    line_ += i > 0 ? "," : "";
    line_ += fixed(values[i] * scale, decimals);
  }
  line_ += ']';
}

void JsonLine::text(std::string_view name, std::string_view value) {
  key(name);
  line_ += '"';
  line_ += value;
  line_ += '"';
}

void JsonLine::boolean(std::string_view name, bool value) {
  key(name);
  line_ += value ? "true" : "false";
}

void JsonLine::null(std::string_view name) {
  key(name);
  line_ += "null";
}

void JsonLine::open(std::string_view name) {
  key(name);
  line_ += '{';
}

std::string JsonLine::take() && {
  return std::move(line_) + "}";
}

LineFile::LineFile(const std::string& path) {
  if (path.empty()) {
    return;
  }
  file_.reset(std::fopen(path.c_str(), "w"));
  if (!file_) {
    throw std::runtime_error("log " + path +
                             ": cannot be written: " + std::generic_category().message(errno));
  }
}

void LineFile::write(std::string line) {
  if (!file_) {
    return;
  }
  line += '\n';
  (void)std::fwrite(line.data(), 1, line.size(), file_.get());
  (void)std::fflush(file_.get());
}

}  // namespace rigwire::field
