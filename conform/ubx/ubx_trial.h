// A case of the suite ubx while it runs: frames and sentences on one line, polls and their answers,
// settings and their acknowledgements.
//
// Whatever a case is about: all that comes is UBX frames, NMEA sentences or RTCM 3 messages, whole
// and with right checks; anything between them fails the case (UBX-13003221 R28, 32.2 and 32.4).
// The first one after opening may have begun before.
//
// What is to be ignored has no time to wait for: a poll of MON-VER, which every receiver answers,
// is sent behind it, and nothing may come before that answer (UbxTrial::ignores).
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "conform/bounds.h"
#include "conform/byte_line.h"
#include "conform/bytes.h"
#include "conform/trial.h"
#include "conform/ubx/ubx_messages.h"
#include "protocols/ubx/frame.h"

namespace rigwire::conform {

using UbxId = protocols::ubx::MessageId;
using UbxBytes = std::vector<std::uint8_t>;

/// Claims of a receiver.
struct UbxClaims {
  std::vector<std::string> messages;  ///< Messages that a poll returns: "NAV-PVT", "CFG-RATE".
  double rate_hz = 0.0;               ///< Rate of navigation epochs as set; 0: not claimed.
  std::chrono::milliseconds answer_within{500};  ///< 99 of 100 answers come within it.
  std::chrono::milliseconds patience{1500};      ///< Timeout of an answer.

  [[nodiscard]] bool has(std::string_view message) const;
};

/// The receiver under test, over several cases.
struct UbxDevice {
  std::function<std::unique_ptr<ByteLine>()> open;  ///< May throw Unreachable.
  UbxClaims claims;
  std::unique_ptr<ByteLine> line;
  UbxBytes arrived;           ///< And not yet taken apart.
  bool synchronized = false;  ///< Something whole has come since the line was opened.
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();
};

/// One received message.
struct UbxHeard {
  enum class Kind : std::uint8_t { frame, sentence, rtcm };
  Kind kind = Kind::frame;
  UbxId id;  ///< Identifier of a frame.
  UbxBytes bytes;
  ByteLine::Clock::time_point at;

  [[nodiscard]] UbxBytes payload() const;  ///< Payload of a frame.
  [[nodiscard]] std::string text() const;  ///< Text of a sentence, without its end.
};

class UbxTrial : public Trial {
 public:
  using Payloads = std::map<std::string_view, UbxPayload>;

  /// Opens the line where it is not open. Throws Unreachable.
  UbxTrial(CaseIdentity identity, UbxDevice& device);

  [[nodiscard]] const UbxClaims& claims() const { return device_->claims; }
  [[nodiscard]] ByteLine::Clock::time_point now() const { return device_->line->now(); }

  /// The next thing; nothing by the deadline, or with the line closed.
  [[nodiscard]] std::optional<UbxHeard> hear(ByteLine::Clock::time_point deadline);
  /// All that comes in this time.
  [[nodiscard]] std::vector<UbxHeard> listen(std::chrono::nanoseconds span);
  /// What has come so far is forgotten, for at most kDrain.
  void drain();

  bool send(const UbxBytes& bytes, std::string words);
  bool send(UbxId id, const UbxBytes& payload);
  [[nodiscard]] static UbxBytes framed(UbxId id, const UbxBytes& payload);
  void show(const UbxHeard& heard);

  /// Polls a message of the tables and checks that it comes complete, and in class CFG with an
  /// acknowledgement after it. Returns nullopt if it did not, which is recorded by the strength of
  /// the case.
  [[nodiscard]] std::optional<UbxPayload> poll(std::string_view name);
  [[nodiscard]] std::optional<UbxPayload> poll(std::string_view name, const UbxBytes& selector);
  /// Returns the time from the last poll or setting to its first answer.
  [[nodiscard]] std::chrono::nanoseconds took() const { return took_; }
  /// Polls all messages together, of one epoch if they contain it (iTOW); repeats if an epoch began
  /// in between. Not applicable if the line is too slow for that.
  [[nodiscard]] std::optional<Payloads> together(const std::vector<std::string_view>& names);

  /// Returns true for ACK-ACK, false for ACK-NAK; nullopt if neither came, which is recorded.
  [[nodiscard]] std::optional<bool> acknowledged(UbxId id, const UbxBytes& payload);
  bool accepts(std::string_view name, const UbxBytes& payload);
  bool refuses(UbxId id, const UbxBytes& payload);
  /// Neither `bytes` nor what they look like is answered.
  bool ignores(const UbxBytes& bytes, const std::string& words);
  /// MON-VER is answered: the receiver goes on. What came before it, without sentences.
  [[nodiscard]] std::optional<std::vector<UbxHeard>> until_version();

 private:
  [[nodiscard]] std::optional<UbxHeard> take(bool& more);

  UbxDevice* device_;
  ByteLine::Clock::time_point asked_;
  std::chrono::nanoseconds took_{};
};

/// What a case needs of the claims.
struct UbxCase {
  CaseIdentity identity;
  std::vector<std::string_view> needs;  ///< Messages.
  std::function<void(UbxTrial&)> run;
};

/// Sections are numbered through over the chapters.
struct UbxCitations {
  Citations m8{"ubx", "UBX-13003221 R28"};
  Citations f9{"ubx", "UBXDOC-963802114-12815"};
};

// The chapters.
[[nodiscard]] std::vector<UbxCase> ubx_framing_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_poll_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_setting_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_item_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_field_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_epoch_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_rate_cases(UbxCitations& citations);
[[nodiscard]] std::vector<UbxCase> ubx_robustness_cases(UbxCitations& citations);

// Little-endian bytes of a payload.
[[nodiscard]] UbxBytes u2(unsigned value);
[[nodiscard]] UbxBytes u4(std::uint32_t value);

}  // namespace rigwire::conform
