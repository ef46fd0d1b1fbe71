// `rigwire conform` run as users run it, and what it found.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "modbus_programs.h"

namespace rigwire::conformance {

struct Conformed {
  int exit_code = 0;
  std::string text;
  nlohmann::json result;  ///< Null when there is none.

  [[nodiscard]] std::size_t count(const std::string& verdict) const {
    return result.is_null() ? 0 : result.at("counts").at(verdict).get<std::size_t>();
  }
  [[nodiscard]] std::vector<std::string> with(const std::string& verdict) const {
    std::vector<std::string> ids;
    for (const auto& each : result.is_null() ? nlohmann::json::array() : result.at("cases")) {
      if (each.at("verdict") == verdict) {
        ids.push_back(each.at("id").get<std::string>());
      }
    }
    return ids;
  }
};

/// `arguments` behind the word conform; files go to `folder`.
inline Conformed conformed(const std::filesystem::path& folder, const std::string& arguments) {
  const std::string file = (folder / "result.json").string();
  const ProgramResult ran =
      run_program(RIGWIRE_BINARY_DIR "/rigwire conform " + arguments + " --json " + file);
  Conformed found{ran.exit_code, ran.text, {}};
  if (std::ifstream stream(file); stream) {
    found.result = nlohmann::json::parse(stream);
  }
  return found;
}

}  // namespace rigwire::conformance
