// Command lines of field programs: "--name VALUE" or "--name=VALUE", and flags without a value.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "field/lidar_wire.h"

namespace rigwire::field {

/// An option that cannot be; what() says which, the value found, and what is allowed.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Exit statuses that all field programs share.
enum ExitStatus : int {
  exit_done = 0,
  exit_machine = 1,
  exit_usage = 2,
  exit_wire = 3,
  exit_silent_sensor = 4,
};

/// Throw UsageError naming option and text when the text is no such value. `allowed` is for the
/// message.
[[noreturn]] void refuse(std::string_view option, std::string_view value, std::string_view allowed);
[[nodiscard]] double number(std::string_view option, std::string_view text, double lower,
                            double upper, std::string_view allowed);
/// Decimal, or hexadecimal after 0x.
[[nodiscard]] std::uint64_t whole(std::string_view option, std::string_view text,
                                  std::uint64_t upper, std::string_view allowed);
[[nodiscard]] std::uint16_t port(std::string_view option, std::string_view text);
/// A speed in bit/s.
[[nodiscard]] std::uint32_t baud(std::string_view option, std::string_view text);
/// "20" or "20s".
[[nodiscard]] std::chrono::nanoseconds seconds(std::string_view option, std::string_view text);
/// "X,Y,Z" in m or "X,Y,Z,YAW,PITCH" with degrees; angles that are not given stay those of `mount`.
[[nodiscard]] LidarMount lidar_mount(std::string_view option, std::string_view text,
                                     LidarMount mount);
/// At commas.
[[nodiscard]] std::vector<std::string_view> split(std::string_view text);

/// What an option of a program does with its value: (options, name, value).
template <class Options>
using Setters =
    std::map<std::string_view, std::function<void(Options&, std::string_view, std::string_view)>>;
template <class Options>
using Flags = std::map<std::string_view, bool Options::*>;

/// Reads one argument: nothing more for a flag, else the value that belongs to it (from the next
/// argument when it is not joined). Throws UsageError.
struct ReadOption {
  std::string_view name;
  std::string_view value;
};
[[nodiscard]] ReadOption read_option(std::span<const std::string_view> arguments, std::size_t& at,
                                     bool known);
/// The part of an argument before "=".
[[nodiscard]] std::string_view option_name(std::string_view argument);

/// `arguments` without the program's name. Throws UsageError.
template <class Options>
[[nodiscard]] Options parse(std::span<const std::string_view> arguments,
                            const Setters<Options>& setters, const Flags<Options>& flags) {
  Options options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (const auto flag = flags.find(arguments[i]); flag != flags.end()) {
      options.*(flag->second) = true;
      continue;
    }
    const auto setter = setters.find(option_name(arguments[i]));
    const ReadOption read = read_option(arguments, i, setter != setters.end());
    setter->second(options, read.name, read.value);
  }
  return options;
}

/// What main() of a field program does: reads the options, helps, runs, and turns what is thrown
/// into a message and an exit status. `run` is given the options and returns the status.
template <class Parse, class Run>
[[nodiscard]] int run_program(const char* name, int count, char** values, Parse parse_options,
                              std::string_view usage, Run run) {
  const auto complain = [name](const std::exception& error, ExitStatus status) {
    (void)std::fprintf(stderr, "%s: %s\n", name, error.what());
    return status;
  };
  try {
    const std::vector<std::string_view> arguments(values + 1, values + count);
    const auto options = parse_options(arguments);
    if (options.help) {
      (void)std::fwrite(usage.data(), 1, usage.size(), stdout);
      return exit_done;
    }
    return run(options);
  } catch (const UsageError& error) {
    return complain(error, exit_usage);
  } catch (const std::invalid_argument& error) {
    return complain(error, exit_usage);
  } catch (const std::exception& error) {
    return complain(error, exit_wire);
  }
}

}  // namespace rigwire::field
