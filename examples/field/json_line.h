// The log of a field program: one JSON object per line, figures in fixed decimals.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rigwire::field {

/// Builds one object. Numbers that are not finite become null; names and texts are written as they
/// are and must need no escaping.
class JsonLine {
 public:
  void number(std::string_view key, double value, int decimals);
  void number(std::string_view key, const std::optional<double>& value, int decimals);
  void whole(std::string_view key, std::int64_t value);
  void numbers(std::string_view key, std::span<const double> values, double scale, int decimals);
  void text(std::string_view key, std::string_view value);
  void boolean(std::string_view key, bool value);
  void null(std::string_view key);
  void open(std::string_view key);  ///< A nested object, until close().
  void close() { line_ += '}'; }
  /// The object without a line end.
  [[nodiscard]] std::string take() &&;

 private:
  void key(std::string_view key);

  std::string line_ = "{";
};

class LineFile {
 public:
  /// Throws std::runtime_error when the file cannot be written. An empty path logs nothing.
  explicit LineFile(const std::string& path);
  /// Adds the line's end and flushes.
  void write(std::string line);
  [[nodiscard]] bool open() const { return file_ != nullptr; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace rigwire::field
