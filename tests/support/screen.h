// What a terminal shows of the bytes that a program wrote: as much of ECMA-48 as status tables use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace rigwire::test {

class Screen {
 public:
  Screen(std::size_t columns, std::size_t rows) : columns_(columns), lines_(rows) {}

  /// Bytes as they come, cut anywhere.
  void feed(std::string_view bytes) {
    for (const char byte : bytes) {
      take(byte);
    }
  }

  /// Without the empty ones at the end; each character one column.
  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> shown;
    for (const auto& line : lines_) {
      std::string text;
      for (const std::string& cell : line) {
        text += cell.empty() ? " " : cell;
      }
      shown.push_back(text.substr(0, text.find_last_not_of(' ') + 1));
    }
    while (!shown.empty() && shown.back().empty()) {
      shown.pop_back();
    }
    return shown;
  }
  /// Lines that ran over the right edge since the beginning.
  [[nodiscard]] std::size_t wraps() const { return wraps_; }
  /// Everything that is shown and what has scrolled off, as text.
  [[nodiscard]] bool shows(std::string_view text) const {
    for (const std::string& line : lines()) {
      if (line.find(text) != std::string::npos) {
        return true;
      }
    }
    return false;
  }

 private:
  using Line = std::vector<std::string>;

  void take(char byte) {
    const auto code = static_cast<unsigned char>(byte);
    if (!sequence_.empty()) {
      sequence_ += byte;
      if (sequence_.size() > 2 && code >= 0x40 && code <= 0x7E) {
        obey(sequence_);
        sequence_.clear();
      }
    } else if (byte == '\x1b') {
      sequence_ = byte;
    } else if (byte == '\r') {
      column_ = 0;
    } else if (byte == '\n') {
      down();
    } else if ((code & 0xC0U) == 0x80U) {
      if (column_ > 0) {
        lines_[row_][column_ - 1] += byte;
      }
    } else {
      if (column_ == columns_) {
        ++wraps_;
        column_ = 0;
        down();
      }
      Line& line = lines_[row_];
      line.resize(std::max(line.size(), column_ + 1));
      line[column_++] = std::string(1, byte);
    }
  }

  void down() {
    if (row_ + 1 < lines_.size()) {
      ++row_;
    } else {
      lines_.erase(lines_.begin());
      lines_.emplace_back();
    }
  }

  void obey(const std::string& sequence) {
    const std::string number = sequence.substr(2, sequence.size() - 3);
    const std::size_t count = number.empty() ? 0 : std::stoul(number);
    switch (sequence.back()) {
      case 'A':
        row_ -= std::min(row_, std::max<std::size_t>(count, 1));
        break;
      case 'H':
        row_ = column_ = 0;
        break;
      case 'K':
        lines_[row_].resize(std::min(lines_[row_].size(), column_));
        break;
      case 'J':
        for (std::size_t row = count == 2 ? 0 : row_ + 1; row < lines_.size(); ++row) {
          lines_[row].clear();
        }
        lines_[row_].resize(std::min(lines_[row_].size(), column_));
        break;
      default:
        break;
    }
  }

  std::size_t columns_;
  std::vector<Line> lines_;
  std::size_t row_ = 0;
  std::size_t column_ = 0;
  std::size_t wraps_ = 0;
  std::string sequence_;
};

}  // namespace rigwire::test
