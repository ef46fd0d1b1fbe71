#include "hil/command_line/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "hil/configuration/plain_text.h"

namespace rigwire::hil {
namespace {

constexpr std::size_t kGap = 2;
constexpr std::size_t kNarrowest = 4;  // of a column that is cut: a few letters and the ellipsis
constexpr std::string_view kEllipsis = "…";
constexpr const char* kBold = "1";  // SGR parameter (ECMA-48, 8.3.117)

struct Block {
  char32_t first;
  char32_t last;
};
constexpr std::array<Block, 8> kCombining{{{0x0300, 0x036F},
                                           {0x0483, 0x0489},
                                           {0x0591, 0x05BD},
                                           {0x064B, 0x065F},
                                           {0x1AB0, 0x1AFF},
                                           {0x200B, 0x200D},
                                           {0x20D0, 0x20F0},
                                           {0xFE00, 0xFE0F}}};
constexpr std::array<Block, 9> kWide{{{0x1100, 0x115F},
                                      {0x2E80, 0x303E},
                                      {0x3041, 0xA4CF},
                                      {0xAC00, 0xD7A3},
                                      {0xF900, 0xFAFF},
                                      {0xFE30, 0xFE6F},
                                      {0xFF00, 0xFF60},
                                      {0x1F300, 0x1FAFF},
                                      {0x20000, 0x3FFFD}}};

template <std::size_t kCount>
bool within(const std::array<Block, kCount>& blocks, char32_t code) {
  return std::any_of(blocks.begin(), blocks.end(), [code](const Block& block) {
    return block.first <= code && code <= block.last;
  });
}

std::size_t width_of(const Character& character) {
  return within(kCombining, character.code) ? 0 : within(kWide, character.code) ? 2 : 1;
}

}  // namespace

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const Character next = first_character(text);
    width += width_of(next);
    text.remove_prefix(next.bytes);
  }
  return width;
}

std::string clipped(const std::string& text, std::size_t columns) {
  if (display_width(text) <= columns) {
    return text;
  }
  std::string_view rest = text;
  std::size_t width = 0;
  std::size_t bytes = 0;
  while (!rest.empty()) {
    const Character next = first_character(rest);
    if (width + width_of(next) + 1 > columns) {
      break;
    }
    width += width_of(next);
    bytes += next.bytes;
    rest.remove_prefix(next.bytes);
  }
  return columns == 0 ? std::string() : text.substr(0, bytes) + std::string(kEllipsis);
}

std::string painted(const std::string& text, const char* code, bool colour) {
  return colour && code != nullptr ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : text;
}

std::vector<std::string> TextTable::lines(std::size_t width, bool colour) const {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    wanted.push_back(display_width(columns_[i].title));
    for (const auto& row : rows_) {
      wanted[i] = std::max(wanted[i], display_width(row[i].text));
    }
  }
  // Chooses the columns: shrinks those that can be cut to their minimum width, then drops columns.
  std::vector<std::size_t> widths = wanted;
  std::vector<std::size_t> shown(columns_.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  const auto total = [&] {
    std::size_t sum = shown.empty() ? 0 : kGap * (shown.size() - 1);
    for (const std::size_t i : shown) {
      sum += widths[i];
    }
    return sum;
  };
  if (width != 0 && total() > width) {
    const auto narrow = [&](std::size_t i, std::size_t least) {
      if (columns_[i].least != 0) {
        widths[i] = std::min(wanted[i], least);
      }
    };
    for (const std::size_t i : shown) {
      narrow(i, columns_[i].least);
    }
    while (total() > width) {
      const auto worst =
          std::max_element(shown.begin(), shown.end(), [&](std::size_t a, std::size_t b) {
            return columns_[a].sacrifice < columns_[b].sacrifice;
          });
      if (columns_[*worst].sacrifice == 0) {
        break;
      }
      shown.erase(worst);
    }
    if (total() > width) {
      for (const std::size_t i : shown) {
        narrow(i, kNarrowest);
      }
    }
    // What is left over goes to the columns that were cut, from the left.
    for (const std::size_t i : shown) {
      const std::size_t taken = total();
      if (taken < width) {
        widths[i] = std::min(wanted[i], widths[i] + width - taken);
      }
    }
  }

  const auto line = [&](const std::vector<Cell>& row) {
    std::string text;
    std::size_t at = 0;     // columns taken
    std::size_t blank = 0;  // columns to skip before the next text
    for (const std::size_t i : shown) {
      const Cell& cell = row[i];
      const std::string words = clipped(cell.text, widths[i]);
      const std::size_t spare = widths[i] - display_width(words);
      blank += columns_[i].right ? spare : 0;
      if (!words.empty() && (width == 0 || at + blank < width)) {
        const std::string fitting = width == 0 ? words : clipped(words, width - at - blank);
        text += std::string(blank, ' ') + painted(fitting, cell.colour, colour);
        at += blank + display_width(fitting);
        blank = 0;
      }
      blank += (columns_[i].right ? 0 : spare) + kGap;
    }
    return text;
  };
  std::vector<Cell> titles;
  for (const Column& column : columns_) {
    titles.push_back({column.title, kBold});
  }
  std::vector<std::string> all{line(titles)};
  for (const auto& row : rows_) {
    all.push_back(line(row));
  }
  return all;
}

}  // namespace rigwire::hil
