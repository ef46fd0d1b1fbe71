// The sessions of the transport protocol that one node takes part in, over simulated time.
//
// Source: SAE J1939-21, 5.10. At once: one broadcast and kAddressedSending addressed messages of
// its own (one to each destination), kReceiving of others (from each source one broadcast and one
// addressed). All memory is here; nothing is allocated.
//
// What happens                                     what this side does
// own message to everybody                         announcement, packets broadcast_gap apart
// own message to one node                          request to send, packets packet_gap apart as
//                                                  granted; done at the end-of-message
// no grant 1250 ms (T3) after asking or after      abort, timeout
// a portion; 1050 ms (T4) after a hold
// clear to send while a portion is being sent      abort, clear while sending
// a packet asked for the third time again          abort, too many repetitions
// request to send, source has none open            grants min(packets_per_portion, its limit)
// request to send, same group and source again     begins anew, no abort
// request to send, other group, same source        abort of the new one, busy
// request to send, all sessions taken              abort, no resources
// request to send over 1785 bytes                  abort, too long
// announcement, source has one open                begins anew
// a packet that was there already                  left out
// a packet left out                                broadcast: session ends. Addressed: a portion
//                                                  is requested again from there, at most twice
// a number beyond the portion, or 0                broadcast: session ends. Addressed: abort, bad
//                                                  sequence
// no packet for 750 ms (T1; first one of a         broadcast: session ends. Addressed: abort,
// portion 1250 ms, T2)                             timeout
// abort from the other side                        sessions with it about that group end, silently
// anything else about no session                   nothing
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "emulators/device.h"
#include "protocols/j1939/identifier.h"
#include "protocols/j1939/transport.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// A message, whether it came in one frame or by transport.
struct J1939Message {
  protocols::j1939::Identifier identifier;  ///< Transported: priority of its packets.
  std::span<const std::uint8_t> payload;    ///< Valid during the call that hands it over.
};

/// What became of a frame or message.
enum class J1939Reception : std::uint8_t { accepted, ignored, malformed };

struct J1939TransportSettings {
  Duration answer_delay{0};                                ///< From an event to the frame.
  Duration broadcast_gap = std::chrono::milliseconds{50};  ///< 50 .. 200 ms.
  Duration packet_gap = std::chrono::milliseconds{10};     ///< 0 .. 200 ms (Tr).
  std::uint8_t packets_per_portion = 16;                   ///< Granted at once; 1 .. 255.
};

/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const J1939TransportSettings& settings);

/// Receiver of the messages of other nodes.
class J1939TransportSink {
 public:
  virtual ~J1939TransportSink() = default;
  virtual void transported(SimTime now, const J1939Message& message) = 0;
};

class J1939Transport {
 public:
  static constexpr std::size_t kAddressedSending = 4;
  static constexpr std::size_t kReceiving = 8;
  static constexpr unsigned kGreatestRepetitions = 2;
  static constexpr Duration kT1 = std::chrono::milliseconds{750};
  static constexpr Duration kT2 = std::chrono::milliseconds{1250};
  static constexpr Duration kT3 = std::chrono::milliseconds{1250};
  static constexpr Duration kT4 = std::chrono::milliseconds{1050};

  struct Counters {
    std::uint64_t sent = 0;       ///< Messages; addressed ones when they were acknowledged.
    std::uint64_t received = 0;   ///< Messages.
    std::uint64_t abandoned = 0;  ///< Sessions of either direction that ended early.
  };

  /// `sink` and `output` must outlive it. Throws like validate(settings).
  J1939Transport(const J1939TransportSettings& settings, J1939TransportSink& sink,
                 FrameOutput& output);

  /// Begins to send 9 .. 1785 bytes from identifier.source to identifier.destination. False when
  /// one to that destination is on its way, no session is free, or the length is another.
  bool send(SimTime now, const protocols::j1939::Identifier& identifier,
            std::span<const std::uint8_t> payload);
  /// Whether a message to `destination` is on its way.
  [[nodiscard]] bool is_sending(std::uint8_t destination) const;

  /// A frame of one of the two transport groups, to everybody or to this node, which has
  /// `own_address`.
  J1939Reception receive(SimTime now, const protocols::j1939::Identifier& identifier,
                         std::span<const std::uint8_t> payload, std::uint8_t own_address);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const { return next_; }
  /// Forgets every session, silently: the node has no longer the address they are about.
  void reset();

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  using Bytes = std::array<std::uint8_t, protocols::j1939::kGreatestTransported>;

  enum class Phase : std::uint8_t { free, waiting, held, sending };
  struct Sending {
    Phase phase = Phase::free;
    protocols::j1939::Identifier identifier;
    std::uint16_t size = 0;
    std::uint16_t next = 1;  ///< Number of the packet to send.
    std::uint16_t last = 0;  ///< Last packet of the portion.
    std::uint16_t sent = 0;  ///< Highest packet number sent so far.
    unsigned repetitions = 0;
    SimTime due = kNever;  ///< When the next packet is due, or the timeout.
    Bytes bytes{};

    [[nodiscard]] bool broadcast() const {
      return identifier.destination == protocols::j1939::kGlobalAddress;
    }
    [[nodiscard]] std::uint8_t packets() const { return protocols::j1939::packets_of(size); }
  };
  struct Receiving {
    bool open = false;
    protocols::j1939::Identifier identifier;  ///< Its source is the other node.
    std::uint16_t size = 0;
    std::uint16_t next = 1;    ///< Number of the next expected packet.
    std::uint16_t last = 0;    ///< Last packet granted; broadcast: last packet of the message.
    std::uint8_t portion = 1;  ///< Max packets per portion.
    unsigned repetitions = 0;
    SimTime due = kNever;  ///< When the timeout ends.
    Bytes bytes{};

    [[nodiscard]] bool broadcast() const {
      return identifier.destination == protocols::j1939::kGlobalAddress;
    }
    [[nodiscard]] std::uint8_t packets() const { return protocols::j1939::packets_of(size); }
  };

  void send_frame(SimTime now, const protocols::can::Frame& frame);
  void send_abort(SimTime now, std::uint8_t source, std::uint8_t destination,
                  protocols::j1939::AbortReason reason, std::uint32_t pgn);
  void send_packet(SimTime now, Sending& session);
  void close(Sending& session, bool done);
  void close(Receiving& session, bool done);
  void abort(SimTime now, Sending& session, protocols::j1939::AbortReason reason);
  /// Broadcasts end without a word.
  void abort(SimTime now, Receiving& session, protocols::j1939::AbortReason reason);
  void expire(SimTime now, Sending& session);
  void grant(SimTime now, Receiving& session);

  [[nodiscard]] Sending* sending_to(std::uint8_t destination);
  [[nodiscard]] Receiving* receiving_from(std::uint8_t source, std::uint8_t destination);

  J1939Reception on_announcement(SimTime now, const protocols::j1939::Identifier& identifier,
                                 const protocols::j1939::TransportManagement& management);
  J1939Reception on_clear(SimTime now, std::uint8_t source,
                          const protocols::j1939::TransportManagement& management);
  J1939Reception on_end(std::uint8_t source,
                        const protocols::j1939::TransportManagement& management);
  J1939Reception on_abort(std::uint8_t source, std::uint32_t pgn);
  J1939Reception on_data(SimTime now, const protocols::j1939::Identifier& identifier,
                         const protocols::j1939::TransportData& data);
  void refresh();

  J1939TransportSettings settings_;
  J1939TransportSink& sink_;
  FrameOutput& output_;
  std::array<Sending, 1 + kAddressedSending> sending_;  ///< First the broadcast.
  std::array<Receiving, kReceiving> receiving_;
  SimTime next_ = kNever;
  Counters counters_;
};

}  // namespace rigwire::emulators
