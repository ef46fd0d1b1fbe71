// What `rigwire conform` does: opens the way to a device, holds it to its profile by a suite of
// conform/, and tells what came of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

namespace rigwire::hil {

/// The suites that there are.
[[nodiscard]] std::vector<std::string> conformance_suites();

struct ConformRequest {
  std::string suite;
  /// "tcp:ADDRESS[:PORT]", "serial:PATH[@BAUD]", "rig:RIG#DEVICE[@BAUD]": a run of ours, started
  /// for it.
  std::string endpoint;
  std::string profile;  ///< File; of nmea may be empty.
  std::vector<std::string> wanted;
  bool writes = false;
  bool robustness = false;
  /// The endpoint once more, as it stands there: leave to move the machine behind it,
  /// or to lose the device.
  std::optional<std::string> moves;
  bool allow_remote = false;
  bool list = false;                    ///< Print the cases that are wanted; ask nobody.
  bool make_profile = false;            ///< Print what the device answers to as a profile.
  unsigned addresses = 1000;            ///< With make_profile: those below are looked for.
  std::optional<std::uint8_t> address;  ///< With make_profile of j1939: the node that is meant.
  std::chrono::nanoseconds listen = std::chrono::seconds{10};  ///< To who speaks by itself.
  std::string expectations;                                    ///< File of known deviations.
  std::string json;  ///< Files; empty: not written, "-": standard output.
  std::string junit;
  std::string html;
  std::vector<std::string> beside;  ///< JSON files that the HTML page shows too.
  std::string captures;             ///< Folder of a pcapng file for each case.
};

/// The exit code (docs/command-line.md): different where a case fails or is otherwise than
/// expected, environment where the device cannot be reached. Throws ConfigurationError, and
/// std::invalid_argument for words that are none.
[[nodiscard]] int conform(const ConformRequest& request, std::ostream& out, std::ostream& err);

}  // namespace rigwire::hil
