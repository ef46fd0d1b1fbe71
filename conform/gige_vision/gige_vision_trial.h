// A case of the suite gige-vision while it runs: an application on GVCP, a second one beside it,
// and the port that a stream goes to. Packets are made here (protocols/gige_vision/gvcp.h and
// gvsp.h have their layout); names of registers and statuses are those of protocols/gige_vision.
//
// Whatever a case is about: an answer has its command's code plus one, its request, and the length
// that it says, and comes from where it was asked; else the case fails.
#pragma once

#include <array>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "conform/bounds.h"
#include "conform/bytes.h"
#include "conform/datagram_line.h"
#include "conform/trial.h"
#include "protocols/gige_vision/bootstrap.h"
#include "protocols/gige_vision/status.h"

namespace rigwire::conform {

using GigeBytes = std::vector<std::uint8_t>;
using GigeStatus = protocols::gige_vision::Status;

/// A register of the camera's own, and what to write there.
struct GigeRegister {
  std::uint32_t address = 0;
  std::uint32_t value = 1;

  friend bool operator==(const GigeRegister&, const GigeRegister&) = default;
};

/// Claims of a camera in addition to its bootstrap registers.
struct GigeVisionClaims {
  std::optional<GigeRegister> start;             ///< Begins the acquisition.
  std::optional<GigeRegister> stop;              ///< Ends it.
  std::optional<std::uint32_t> payload_size;     ///< Address of the bytes of the longest block.
  double rate_hz = 0.0;                          ///< Picture rate; 0: not claimed.
  std::chrono::milliseconds answer_within{100};  ///< 99 of 100 answers come within it.
  std::chrono::milliseconds patience{500};       ///< Timeout of an answer.
};

/// A packet of the stream.
struct GigeStreamPacket {
  DatagramLine::Datagram datagram;
  unsigned status = 0;
  std::uint64_t block = 0;
  unsigned format = 0;  ///< 1 leader, 2 trailer, 3 payload, 7 multi-part.
  std::uint32_t packet = 0;
  bool extended_ids = false;
  GigeBytes payload;
};
/// A block's packets by their numbers, of each the first that came.
struct GigeBlock {
  std::uint64_t number = 0;
  std::map<std::uint32_t, GigeStreamPacket> packets;
  std::size_t repeated = 0;
  bool in_order = true;
};

/// Packets received while the camera acquired, and the destination it was set to.
struct GigeStream {
  std::vector<GigeBlock> blocks;  ///< Whole ones: neither the last nor one that began before.
  std::vector<GigeStreamPacket> strange;  ///< Packets that belong to no block.
  std::uint32_t packet_size = 0;          ///< With IP and UDP headers.
  std::uint32_t payload_size = 0;         ///< By the claimed register; 0: not claimed.
  std::uint64_t tick_frequency_hz = 0;
  std::uint16_t source_port = 0;  ///< Port in its register; 0: not given.
  std::uint64_t lost_here = 0;
  std::string failure;  ///< Why there are no blocks; empty if there are.
};

/// The camera under test, over several cases.
struct GigeVisionDevice {
  /// Opens three own ports: those of two applications and of a stream. May throw Unreachable.
  std::function<std::unique_ptr<DatagramLine>()> open;
  DatagramLine::Peer camera;
  std::string own_address;  ///< Address at which the camera can reach this host.
  GigeVisionClaims claims;
  std::unique_ptr<DatagramLine> line;
  std::array<std::deque<DatagramLine::Datagram>, 3> arrived;  ///< Datagrams waiting at each port.
  std::uint16_t request = 0;                                  ///< Number of the last command.
  /// Set after the stream was recorded.
  std::optional<GigeStream> stream;
  std::size_t waiting_bytes = 0;  ///< Size of `arrived`, with kItem_bytes for each datagram.
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();
};

/// Command codes.
struct Gvcp {
  static constexpr std::uint16_t kDiscovery = 0x0002;
  static constexpr std::uint16_t kPacketResend = 0x0040;
  static constexpr std::uint16_t kReadRegisters = 0x0080;
  static constexpr std::uint16_t kWriteRegisters = 0x0082;
  static constexpr std::uint16_t kReadMemory = 0x0084;
  static constexpr std::uint16_t kWriteMemory = 0x0086;
  static constexpr std::uint16_t kPending = 0x0089;
};

class GigeVisionTrial : public Trial {
 public:
  static constexpr std::size_t kOwn = 0;    ///< Port of the application that is in control.
  static constexpr std::size_t kOther = 1;  ///< Port of another application.
  static constexpr std::size_t kStream = 2;

  struct Answer {
    std::uint16_t status = 0;
    std::uint16_t code = 0;
    std::uint16_t request = 0;
    GigeBytes payload;

    [[nodiscard]] bool good() const { return (status & 0x8000U) == 0; }
    [[nodiscard]] std::uint32_t word(std::size_t index) const;
    [[nodiscard]] std::size_t words() const { return payload.size() / 4; }
  };

  /// Opens the ports where they are not open. Throws Unreachable.
  GigeVisionTrial(CaseIdentity identity, GigeVisionDevice& device);

  [[nodiscard]] const GigeVisionClaims& claims() const { return device_->claims; }
  [[nodiscard]] DatagramLine::Clock::time_point now() const { return device_->line->now(); }
  [[nodiscard]] GigeVisionDevice& device() { return *device_; }

  /// A command's bytes; `flags` 1: to be acknowledged.
  [[nodiscard]] static GigeBytes framed(std::uint16_t command, const GigeBytes& payload,
                                        std::uint16_t request, std::uint8_t flags = 1);
  /// The next request, never 0.
  [[nodiscard]] std::uint16_t next_request();
  bool send(const GigeBytes& bytes, const std::string& words, std::size_t port = kOwn);
  /// Returns the answer to that request at that port; a failure when none comes or it is not whole.
  [[nodiscard]] std::optional<Answer> answer(std::uint16_t command, std::uint16_t request,
                                             std::size_t port = kOwn);
  [[nodiscard]] std::optional<Answer> ask(std::uint16_t command, const GigeBytes& payload,
                                          std::size_t port = kOwn);
  /// Expects no answer at that port within the patience, at most 300 ms.
  bool silent(const std::string& about, std::size_t port = kOwn);
  /// Expects an error; its status should be `right`.
  void refused(std::uint16_t command, const GigeBytes& payload, GigeStatus right,
               std::size_t port = kOwn);

  /// Each of these records a failure when it does not succeed.
  [[nodiscard]] std::optional<std::uint32_t> read(std::uint32_t address, std::size_t port = kOwn);
  [[nodiscard]] std::optional<GigeBytes> read_memory(std::uint32_t address, unsigned count);
  bool write(std::uint32_t address, std::uint32_t value, std::size_t port = kOwn);
  /// Accesses a register that may be refused and returns the status; without an answer returns
  /// nullopt and records the failure.
  [[nodiscard]] std::optional<std::uint16_t> status_of_write(std::uint32_t address,
                                                             std::uint32_t value,
                                                             std::size_t port = kOwn);
  [[nodiscard]] std::optional<std::uint16_t> status_of_read(std::uint32_t address,
                                                            std::size_t port = kOwn);
  /// Takes control until leave(); false, and a failure, when it is refused.
  bool take_control();
  /// Gives up control at both applications' ports, whatever the case has done.
  void leave();
  /// Reads the text up to its first zero.
  [[nodiscard]] std::optional<std::string> read_text(std::uint32_t address, unsigned count);

  /// Returns what comes at our stream's port in this time.
  [[nodiscard]] std::vector<DatagramLine::Datagram> listen(std::chrono::nanoseconds span);
  void wait(std::chrono::nanoseconds span);
  /// Drops what has come so far, for at most kDrain.
  void drain();

 private:
  [[nodiscard]] std::optional<DatagramLine::Datagram> hear(
      std::size_t port, DatagramLine::Clock::time_point deadline);
  /// Puts it behind what waits at its port. Throws TooMuch when too much waits.
  void keep_waiting(DatagramLine::Datagram datagram);

  GigeVisionDevice* device_;
};

/// Big-endian words.
[[nodiscard]] GigeBytes gige_word(std::uint32_t value);
/// "0x8006 (access denied)"
[[nodiscard]] std::string gige_status_text(std::uint16_t status);
/// "0x0A00"
[[nodiscard]] std::string gige_address_text(std::uint32_t address);
/// A packet of the stream taken apart; nothing where it is none.
[[nodiscard]] std::optional<GigeStreamPacket> gige_stream_packet(
    const DatagramLine::Datagram& datagram);
/// What the camera sends of itself: listened to once, by the first case that asks. Takes control
/// and starts the acquisition; leaves neither.
[[nodiscard]] const GigeStream& gige_stream(GigeVisionTrial& trial);
/// The description's bytes, by the first URL; nothing where they cannot be read, which is found.
[[nodiscard]] std::optional<GigeBytes> gige_description(GigeVisionTrial& trial);

struct GigeVisionCase {
  CaseIdentity identity;
  /// Bits of the register GVCP capability without which the case does not apply.
  std::uint32_t capability = 0;
  bool acquires = false;  ///< Start and stop of the acquisition have to be claimed.
  std::function<void(GigeVisionTrial&)> run;
};

// The chapters.
[[nodiscard]] std::vector<GigeVisionCase> gige_control_cases();
[[nodiscard]] std::vector<GigeVisionCase> gige_privilege_cases();
[[nodiscard]] std::vector<GigeVisionCase> gige_stream_cases();
[[nodiscard]] std::vector<GigeVisionCase> gige_robustness_cases();

/// A row of a chapter's table.
struct GigeVisionRow {
  const char* chapter;
  const char* title;
  Strength strength;
  void (*run)(GigeVisionTrial&);
  Danger danger = Danger::none;
  std::uint32_t capability = 0;
  bool acquires = false;
};
[[nodiscard]] std::vector<GigeVisionCase> gige_cases_of(std::span<const GigeVisionRow> rows);
/// Those that take control: each leaves it, whatever came of it.
[[nodiscard]] std::vector<GigeVisionCase> gige_cases_in_control_of(
    std::span<const GigeVisionRow> rows);

}  // namespace rigwire::conform
