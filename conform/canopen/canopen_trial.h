// A case of the suite canopen while it runs: a master's questions to one node by SDO, its commands,
// and what the node says by itself. The frames are made here, from CiA 301 V4.2.0, 7.2.4.3.
//
// Whatever a case is about: an answer of SDO has eight bytes and repeats index and sub-index.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "conform/bounds.h"
#include "conform/can_line.h"
#include "conform/trial.h"

namespace rigwire::conform {

using protocols::can::Frame;
using CanBytes = std::vector<std::uint8_t>;

struct ObjectName {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;

  friend bool operator==(const ObjectName&, const ObjectName&) = default;
};
/// "1018:1".
[[nodiscard]] std::string text_of(ObjectName object);

/// Claims of a node.
struct CanopenClaims {
  std::uint8_t node = 1;
  std::vector<ObjectName> objects;  ///< Objects that can be read.
  std::chrono::milliseconds patience{500};

  [[nodiscard]] bool has(ObjectName object) const;
};

/// The node under test, over several cases.
struct CanopenDevice {
  std::function<std::unique_ptr<CanLine>()> open;  ///< May throw Unreachable.
  CanopenClaims claims;
  std::unique_ptr<CanLine> line;
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();
};

/// Result of an SDO: data, or the abort code.
struct SdoResult {
  CanBytes data;
  std::optional<std::uint32_t> abort;

  /// Value of up to four bytes, least significant first.
  [[nodiscard]] std::uint32_t number() const;
  [[nodiscard]] std::string text() const;
};
/// "06020000 (no such object)".
[[nodiscard]] std::string abort_text(std::uint32_t code);

class CanopenTrial : public Trial {
 public:
  /// Precondition: the line is open.
  CanopenTrial(CaseIdentity identity, CanopenDevice& device);

  [[nodiscard]] const CanopenClaims& claims() const { return device_->claims; }
  [[nodiscard]] CanLine::Clock::time_point now() const { return device_->line->now(); }

  bool send(const Frame& frame, std::string words);
  /// Sends a frame with an 11-bit identifier.
  bool send(std::uint32_t id, CanBytes bytes, std::string words);
  /// Sends a request to the node's SDO server, filled up to eight bytes with zeros.
  bool request(CanBytes bytes, std::string words);
  /// Returns the next frame with that identifier, and shows it; drops others.
  [[nodiscard]] std::optional<Frame> hear(std::uint32_t id, std::chrono::nanoseconds within);
  struct Heard {
    Frame frame;
    std::chrono::nanoseconds at{};
  };
  /// Returns all frames with that identifier in this time; shows the first ones.
  [[nodiscard]] std::vector<Heard> listen(std::uint32_t id, std::chrono::nanoseconds span);
  /// Drops what has come so far, for at most kDrain.
  void drain();

  /// Returns the eight bytes of the SDO server; nullopt, and a failure, when none came.
  [[nodiscard]] std::optional<CanBytes> answer();
  /// Expects no answer of the SDO server for 200 ms.
  bool unanswered(const std::string& about);

  /// Reads an object, in segments where the node wants them. Returns nullopt, and records a
  /// failure, when the node broke the protocol or did not answer.
  [[nodiscard]] std::optional<SdoResult> upload(ObjectName object);
  /// Writes up to four bytes at once.
  [[nodiscard]] std::optional<SdoResult> download(ObjectName object, const CanBytes& data);
  /// Reads a number; an abort is a failure.
  [[nodiscard]] std::optional<std::uint32_t> number(ObjectName object);
  bool write(ObjectName object, const CanBytes& data);
  /// Expects an abort with one of these codes.
  bool aborts(const std::optional<SdoResult>& result, std::initializer_list<std::uint32_t> codes);

  [[nodiscard]] std::uint32_t with_node(std::uint32_t base) const { return base + claims().node; }
  /// Sends a command of network management to the node.
  bool command(std::uint8_t code, const std::string& words);
  /// Runs with a heartbeat of 100 ms, and puts back what was set.
  void with_heartbeat(const std::function<void()>& run);
  /// Expects `state` in the heartbeat after the next one, which may have been on its way.
  bool expect_state(std::uint8_t state, const std::string& name);

 private:
  [[nodiscard]] bool segments(ObjectName object, std::optional<std::uint32_t> announced,
                              CanBytes& data);

  CanopenDevice* device_;
};

[[nodiscard]] CanBytes little(std::uint32_t value, std::size_t bytes);

struct CanopenCase {
  CaseIdentity identity;
  std::vector<ObjectName> needs;
  std::function<void(CanopenTrial&)> run;
};

// The chapters.
[[nodiscard]] std::vector<CanopenCase> canopen_sdo_cases(Citations& cia301);
[[nodiscard]] std::vector<CanopenCase> canopen_object_cases(Citations& cia301);
[[nodiscard]] std::vector<CanopenCase> canopen_network_cases(Citations& cia301);
[[nodiscard]] std::vector<CanopenCase> canopen_pdo_cases(Citations& cia301);
[[nodiscard]] std::vector<CanopenCase> canopen_encoder_cases();

}  // namespace rigwire::conform
