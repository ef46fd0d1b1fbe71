// The command line of find_rocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "field/option_parser.h"
#include "find_rocks/rock_finder.h"

namespace rigwire::find_rocks {

using field::UsageError;

struct Options {
  std::string camera = "127.0.0.2";
  std::uint32_t packet_size = 8192;
  std::uint8_t least_confidence = 128;
  RockSettings rocks;
  std::chrono::nanoseconds duration{0};                          ///< 0: for ever.
  std::chrono::nanoseconds patience = std::chrono::seconds{10};  ///< Allowed silence of the camera.
  std::chrono::nanoseconds period = std::chrono::seconds{1};     ///< Period of the table.
  std::string log;                                               ///< Empty: none.
  std::string csv;                                               ///< Empty: none.
  bool wait = false;
  bool quiet = false;
  bool help = false;
};

/// `arguments` without the program's name. Throws UsageError.
[[nodiscard]] Options parse_options(std::span<const std::string_view> arguments);
[[nodiscard]] std::string_view usage();

}  // namespace rigwire::find_rocks
