// Numbers as parts of the names of parameterised tests, which are letters, digits and underscores.
#pragma once

#include <iomanip>
#include <sstream>
#include <string>

namespace rigwire::test {

/// 0.5 is "0_5", 1e6 "1000000", -2 "minus_2"; six digits after the point.
[[nodiscard]] inline std::string number_word(double value) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << value;
  std::string word = text.str();
  word.erase(word.find_last_not_of('0') + 1);
  if (word.back() == '.') {
    word.pop_back();
  }
  if (const auto point = word.find('.'); point != std::string::npos) {
    word[point] = '_';
  }
  return word.front() == '-' ? "minus_" + word.substr(1) : word;
}

}  // namespace rigwire::test
