// A client of one GigE Vision camera: finds it at its address, takes control, sets it up by the
// names of its features, has it stream, and keeps control with a heartbeat.
//
//   searching --answers DISCOVERY--> opening --set up--> streaming
//   opening --refused, held by another application--> waiting --1 s--> searching
//   any --no answer to four tries, control lost--> waiting
//
// Whatever ends a session, the client begins anew by itself: a camera that was switched off and on,
// or that another application has released, streams again without help.
//
// One command is on its way at a time. A command that is not answered is sent again with the same
// number, so that the camera does not do it twice.
//
// No sockets and no clock here (gige_wire.h has them): datagrams go in and out by functions, the
// time is an argument. Sources: protocols/gige_vision/gvcp.h and bootstrap.h.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "field/gige_description.h"
#include "field/gige_stream.h"
#include "protocols/gige_vision/gvcp.h"

namespace rigwire::field {

/// A feature that is set before the stream begins.
struct GigeSetting {
  std::string feature;
  std::string value;  ///< A number, 0 or 1, or the name of an entry.
  /// For a feature that there is once for each entry of another one.
  std::string selector = {};
  std::string selected = {};
  /// A camera without it, or that refuses it, will do.
  bool optional = false;
};

/// A feature that is read after the settings.
struct GigeReading {
  std::string feature;
  bool optional = false;
};

struct GigeClientSettings {
  std::vector<GigeSetting> settings;
  std::vector<GigeReading> readings;
  /// Tried first, bytes with IP and UDP headers; where a test packet of this size does not arrive,
  /// 1500 and 576 follow.
  std::uint32_t packet_size = 8192;
  bool multipart = true;  ///< Several components in one block, where the camera can.
  std::chrono::milliseconds heartbeat{3000};  ///< After so long without us the camera is free.
};

/// What the camera says it is.
struct GigeIdentity {
  std::string vendor;
  std::string model;
  std::string serial_number;
  std::string user_name;
};

struct GigeClientCounters {
  std::uint64_t sessions = 0;  ///< How often a stream was begun.
  std::uint64_t losses = 0;    ///< Sessions that ended by themselves.
  std::uint64_t repeated = 0;  ///< Commands that were sent again.
  std::uint64_t refused = 0;   ///< Datagrams on the control channel that answer no request.
};

class GigeClient {
 public:
  using Instant = GigeStream::Instant;
  enum class State : std::uint8_t { searching, opening, streaming, waiting };

  static constexpr std::chrono::milliseconds kAnswerTimeout{250};
  static constexpr int kTries = 4;
  static constexpr std::chrono::milliseconds kPause{1000};  ///< From failure to the next session.
  static constexpr std::chrono::milliseconds kTestPacketTimeout{100};
  /// A camera whose blocks are longer is refused.
  static constexpr std::uint32_t kLongestPayload = 256U << 20U;

  /// Where the client is on the network: the stream's destination.
  struct Local {
    std::uint32_t address = 0;  ///< IPv4 as a number.
    std::uint16_t stream_port = 0;
  };
  struct Handlers {
    /// To the camera's port 3956.
    std::function<void(std::span<const std::uint8_t>)> send;
    std::function<void(const GigeBlock&)> block;
    /// A session's stream begins: what was read is there.
    std::function<void()> streaming = {};
    /// A session has failed or ended by itself; trouble() says why.
    std::function<void()> ended = {};
  };

  GigeClient(GigeClientSettings settings, const Local& local, Handlers handlers);

  /// Sends requests and receives from now on.
  void start(Instant now);
  /// Ends acquisition and stream and releases the camera: three commands whose answers are not
  /// awaited.
  void stop();

  void receive_control(Instant now, std::span<const std::uint8_t> datagram);
  void receive_stream(Instant now, std::span<const std::uint8_t> datagram);
  void advance(Instant now);
  /// Returns the time at which advance() has something to do.
  [[nodiscard]] Instant next_event() const;

  [[nodiscard]] State state() const { return state_; }
  [[nodiscard]] const GigeIdentity& identity() const { return identity_; }
  /// Reason why the last session failed or ended; empty: none did, or the camera streams again.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  /// Value of a reading; empty when the camera does not have it.
  [[nodiscard]] std::optional<double> reading(std::string_view feature) const;
  /// Returns the number in a block's chunk that belongs to a feature; empty if it is not there.
  [[nodiscard]] std::optional<double> chunk(const GigeBlock& block, std::string_view feature) const;
  [[nodiscard]] std::uint32_t packet_size() const { return packet_size_; }
  /// Ticks of the camera's clock per second; 0: unknown.
  [[nodiscard]] double tick_frequency_hz() const { return tick_frequency_hz_; }
  [[nodiscard]] const GigeClientCounters& counters() const { return counters_; }
  /// Returns the counters of all sessions together.
  [[nodiscard]] GigeStreamCounters stream_counters() const;

 private:
  using Acknowledge = protocols::gige_vision::Acknowledge;
  using Then = std::function<void(const Acknowledge&)>;
  struct Request {
    std::function<protocols::gige_vision::GvcpPacket(std::uint16_t)> make;
    std::string what;  ///< For messages: "Width".
    Then then;
    /// A refusal is handed on as well.
    bool refusable = false;
  };

  void ask(Request request);
  /// `then` is given nothing when it was refused, which only a refusable one may be.
  void read_bytes(std::uint32_t address, std::uint32_t count, const std::string& what,
                  bool refusable,
                  std::function<void(std::optional<std::vector<std::uint8_t>>)> then);
  void read_word(std::uint32_t address, const std::string& what, bool refusable,
                 std::function<void(std::optional<std::uint32_t>)> then);
  void write_bytes(std::uint32_t address, std::vector<std::uint8_t> bytes, const std::string& what,
                   bool refusable, std::function<void(bool)> then);
  void write_word(std::uint32_t address, std::uint32_t value, const std::string& what,
                  bool refusable, std::function<void(bool)> then);
  /// Calls `then` with whether the camera accepted it.
  void write_feature(const GigeFeature& feature, double value, bool refusable,
                     std::function<void(bool)> then);
  void read_feature(const GigeFeature& feature, bool refusable,
                    std::function<void(std::optional<double>)> then);
  void next_request();
  void transmit();
  void answered(const Acknowledge& acknowledge);
  void search();
  void identify(const Acknowledge& acknowledge);
  void read_description(GigeUrl url);
  void take_control();
  void tell_who_controls();
  void ask_for_parts();
  void set(std::size_t index);
  void read(std::size_t index);
  void open_stream();
  void test_packets();
  void tested(std::uint32_t size);
  void measure_blocks();
  void begin_stream(std::uint32_t payload_bytes);
  /// The feature, or nothing and, unless it may be missing, the end of the session.
  [[nodiscard]] std::optional<GigeFeature> feature(std::string_view name, bool may_be_missing);
  void beat();
  void fail(const std::string& why);
  void leave_stream();

  GigeClientSettings settings_;
  Local local_;
  Handlers handlers_;
  State state_ = State::searching;
  Instant now_{0};

  std::deque<Request> requests_;  ///< The first is on its way when `pending_`.
  bool pending_ = false;
  std::uint16_t request_ = 0;
  int tries_ = 0;
  Instant answer_by_{0};
  Instant wake_{0};  ///< Next search, end of a pause, or next beat.

  std::vector<std::uint8_t> description_bytes_;
  std::optional<GigeDescription> description_;
  std::map<std::string, double, std::less<>> readings_;
  bool controls_ = false;
  bool can_resend_ = false;
  std::uint32_t packet_size_ = 0;
  std::vector<std::uint32_t> sizes_;        ///< Packet sizes still to be tried.
  std::uint32_t test_size_ = 0;             ///< Packet size being tested.
  std::optional<std::size_t> test_packet_;  ///< Bytes received last in a test.
  std::optional<Instant> test_until_;
  double tick_frequency_hz_ = 0.0;
  std::optional<GigeStream> stream_;
  GigeStreamCounters before_;  ///< Counters of earlier streams.

  GigeIdentity identity_;
  std::string trouble_;
  GigeClientCounters counters_;
};

}  // namespace rigwire::field
