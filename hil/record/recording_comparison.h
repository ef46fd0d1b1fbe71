// Two recordings of one run against each other: every byte, every due time.
//
// Compared is by wire and direction: at one instant the two directions of a wire have no order. Of
// UDP and TCP the contents are compared, not the addresses and ports. Where the first recording
// says that units passed and are not in it, or that the wire had no room for them, as many of the
// second are passed over.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/record/recording.h"
#include "protocols/can/message.h"

namespace rigwire::hil {

/// The first one of a wire's direction, or of the truth.
struct RecordingDifference {
  SimTime at{};
  std::string what;  ///< Where it is in the unit, what it belongs to, found and recorded.
};

struct ComparedStream {
  std::string wire;  ///< Or topic of the truth: "/truth".
  bool of_clients = false;
  std::uint64_t units = 0;        ///< Equal units before the first difference.
  std::uint64_t passed_over = 0;  ///< Units of the second that the first reports as lost.
  std::optional<RecordingDifference> difference;
};

/// How the frames of a bus are laid out, by its name.
using MessagesOfBus =
    std::function<std::vector<protocols::can::OwnedMessage>(const std::string& bus)>;

/// `recorded` is what should be, `found` what is; up to and including `end`. Wires that only
/// `found` has are left out. Times count from each one's own start. Throws as read_recording().
[[nodiscard]] std::vector<ComparedStream> compare_recordings(const std::filesystem::path& recorded,
                                                             const std::filesystem::path& found,
                                                             SimTime end,
                                                             const MessagesOfBus& messages);

}  // namespace rigwire::hil
