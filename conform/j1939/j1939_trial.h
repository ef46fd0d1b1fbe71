// A case of the suite j1939 while it runs: requests to one node, transport sessions that the case
// builds itself, and what the node sends on its own. The frames are made here, from SAE J1939-21,
// 5.2, 5.4 and 5.10.
//
// The suite is a node, too: it has claimed address 249 (off-board diagnostic-service tool 1).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conform/bounds.h"
#include "conform/can_line.h"
#include "conform/trial.h"

namespace rigwire::conform {

/// A group that comes by itself.
struct PeriodicGroup {
  std::uint32_t pgn = 0;
  std::chrono::milliseconds period{0};

  friend bool operator==(const PeriodicGroup&, const PeriodicGroup&) = default;
};

/// What a node claims.
struct J1939Claims {
  std::uint8_t address = 0;
  std::vector<PeriodicGroup> periodic;
  std::vector<std::uint32_t> requested;  ///< Groups that a request is answered with.
  std::chrono::milliseconds patience{500};
};

/// The node under test, over several cases.
struct J1939Device {
  std::function<std::unique_ptr<CanLine>()> open;  ///< May throw Unreachable.
  J1939Claims claims;
  std::unique_ptr<CanLine> line;
  std::string lost;  ///< Why it is not at its address any more; empty: it is.
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();
};

/// Opens the bus, and claims the suite's own address there. Throws Unreachable.
void open_line(J1939Device& device);

/// A frame of 29 bits taken apart; destination 255 of groups that have none.
struct J1939Heard {
  std::uint8_t priority = 0;
  std::uint32_t pgn = 0;
  std::uint8_t destination = 255;
  std::uint8_t source = 0;
  std::vector<std::uint8_t> data;
  protocols::can::Frame frame;
  std::chrono::nanoseconds at{};  ///< From the begin of listening.
};

class J1939Trial : public Trial {
 public:
  static constexpr std::uint8_t kOwnAddress = 249;
  static constexpr std::uint8_t kEverybody = 255;
  static constexpr std::uint32_t kRequest = 0xEA00;
  static constexpr std::uint32_t kAcknowledgement = 0xE800;
  static constexpr std::uint32_t kClaim = 0xEE00;
  static constexpr std::uint32_t kTransport = 0xEC00;
  static constexpr std::uint32_t kPackets = 0xEB00;

  /// Precondition: the line is open.
  J1939Trial(CaseIdentity identity, J1939Device& device);

  [[nodiscard]] const J1939Claims& claims() const { return device_->claims; }
  [[nodiscard]] CanLine::Clock::time_point now() const { return device_->line->now(); }

  bool send(const protocols::can::Frame& frame, const std::string& words);
  /// Sends a frame with a 29-bit identifier, priority 6, from `source`.
  bool send(std::uint32_t pgn, std::uint8_t destination, const std::vector<std::uint8_t>& data,
            const std::string& words, std::uint8_t source = kOwnAddress);
  /// Sends a request of a group to `destination`.
  bool request(std::uint32_t pgn, std::uint8_t destination);
  bool request(std::uint32_t pgn) { return request(pgn, claims().address); }
  /// The first frame of the node of one of these groups, to us or to everybody, shown; with a
  /// destination to that alone.
  [[nodiscard]] std::optional<J1939Heard> hear(std::initializer_list<std::uint32_t> pgns,
                                               std::chrono::nanoseconds within,
                                               std::optional<std::uint8_t> destination = {});
  /// Returns the next frame of 29 bits from any sender; nullopt when none comes by the deadline.
  [[nodiscard]] std::optional<J1939Heard> hear_anybody(CanLine::Clock::time_point deadline);
  /// Returns all frames of the node in this time.
  [[nodiscard]] std::vector<J1939Heard> listen(std::chrono::nanoseconds span);
  /// Drops what has come so far, for at most kDrain.
  void drain();
  void show(const J1939Heard& heard);

  /// Returns a claim of the node; nullopt, and a failure, when none came.
  [[nodiscard]] std::optional<J1939Heard> claim();
  /// Requests the node's NAME; nullopt, and a failure, when it does not answer.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> name();
  /// Expects no frame of these groups within 300 ms.
  bool silent(std::initializer_list<std::uint32_t> pgns, const std::string& about);
  /// Sends a transport control message to the node.
  bool control(std::vector<std::uint8_t> bytes, std::uint32_t pgn, const std::string& words);
  /// Records that the node has lost its address, so that no later case can be tried.
  void lost(const std::string& reason);

 private:
  J1939Device* device_;
};

/// "61444 (F004)".
[[nodiscard]] std::string pgn_text(std::uint32_t pgn);

struct J1939Case {
  CaseIdentity identity;
  std::uint32_t periodic = 0;   ///< Group that has to come by itself; 0: none.
  std::uint32_t requested = 0;  ///< Group that has to be had; 0: none.
  bool long_group = false;      ///< One of more than eight bytes has to be had.
  std::function<void(J1939Trial&)> run;
};

// The chapters.
[[nodiscard]] std::vector<J1939Case> j1939_network_cases();
[[nodiscard]] std::vector<J1939Case> j1939_transport_cases();
[[nodiscard]] std::vector<J1939Case> j1939_group_cases();
[[nodiscard]] std::vector<J1939Case> j1939_loss_cases();

/// Returns a group of more than eight bytes that the suite knows and the node answers.
[[nodiscard]] std::optional<std::uint32_t> long_group_of(const J1939Claims& claims);
[[nodiscard]] std::vector<std::uint32_t> groups_to_ask_for();

}  // namespace rigwire::conform
