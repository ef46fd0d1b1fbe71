#include "field/option_parser.h"

#include <charconv>
#include <cmath>
#include <numbers>

namespace rigwire::field {

void refuse(std::string_view option, std::string_view value, std::string_view allowed) {
  throw UsageError(std::string(option) + ": found '" + std::string(value) + "', allowed " +
                   std::string(allowed));
}

double number(std::string_view option, std::string_view text, double lower, double upper,
              std::string_view allowed) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= lower) ||
      !(value <= upper)) {
    refuse(option, text, allowed);
  }
  return value;
}

std::uint64_t whole(std::string_view option, std::string_view text, std::uint64_t upper,
                    std::string_view allowed) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const std::string_view digits = hexadecimal ? text.substr(2) : text;
  std::uint64_t value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size() || value > upper) {
    refuse(option, text, allowed);
  }
  return value;
}

std::uint16_t port(std::string_view option, std::string_view text) {
  const auto value = whole(option, text, 65535, "a port, 1..65535");
  if (value == 0) {
    refuse(option, text, "a port, 1..65535");
  }
  return static_cast<std::uint16_t>(value);
}

std::uint32_t baud(std::string_view option, std::string_view text) {
  return static_cast<std::uint32_t>(
      number(option, text, 1200, 4'000'000, "a speed in bit/s, 1200..4000000"));
}

std::chrono::nanoseconds seconds(std::string_view option, std::string_view text) {
  std::string_view digits = text;
  if (digits.ends_with("s")) {
    digits.remove_suffix(1);
  }
  const double value = number(option, digits, 0.0, 1e8, "seconds, 0 or more, such as 20 or 20s");
  return std::chrono::nanoseconds(std::llround(value * 1e9));
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t at = 0;;) {
    const std::size_t comma = text.find(',', at);
    parts.push_back(text.substr(at, comma - at));
    if (comma == std::string_view::npos) {
      return parts;
    }
    at = comma + 1;
  }
}

LidarMount lidar_mount(std::string_view option, std::string_view text, LidarMount mount) {
  constexpr std::string_view kAllowed = "X,Y,Z in m and optionally YAW,PITCH in degrees";
  constexpr double kRadPerDegree = std::numbers::pi / 180.0;
  const auto parts = split(text);
  if (parts.size() != 3 && parts.size() != 5) {
    refuse(option, text, kAllowed);
  }
  mount.x_m = number(option, parts[0], -20.0, 20.0, kAllowed);
  mount.y_m = number(option, parts[1], -20.0, 20.0, kAllowed);
  mount.z_m = number(option, parts[2], -20.0, 20.0, kAllowed);
  if (parts.size() == 5) {
    mount.yaw_rad = number(option, parts[3], -360.0, 360.0, kAllowed) * kRadPerDegree;
    mount.pitch_rad = number(option, parts[4], -90.0, 90.0, kAllowed) * kRadPerDegree;
  }
  return mount;
}

std::string_view option_name(std::string_view argument) {
  return argument.starts_with("--") ? argument.substr(0, argument.find('=')) : argument;
}

ReadOption read_option(std::span<const std::string_view> arguments, std::size_t& at, bool known) {
  const std::string_view argument = arguments[at];
  ReadOption read{option_name(argument), {}};
  if (!known) {
    throw UsageError("unknown option '" + std::string(read.name) + "'; --help lists them");
  }
  if (read.name.size() < argument.size()) {
    read.value = argument.substr(read.name.size() + 1);
  } else if (at + 1 == arguments.size()) {
    throw UsageError(std::string(read.name) + ": a value is missing");
  } else {
    read.value = arguments[++at];
  }
  if (read.value.empty()) {
    throw UsageError(std::string(read.name) + ": the value is empty");
  }
  return read;
}

}  // namespace rigwire::field
