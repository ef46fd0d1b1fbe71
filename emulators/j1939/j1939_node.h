// What every node on a J1939 bus does, whatever it is: it claims and defends its address, answers
// requests, takes part in transport, and moves where a commanded address sends it.
//
// Sources: SAE J1939-21, 5.4 (requests, acknowledgement), 5.10 (transport); J1939-81, 4.2 (address
// claim), 4.6 (commanded address). docs/j1939.md describes the behaviour in full.
//
// A device owns a node, hands it every frame and its time, and is its application: it says which
// groups it can send and takes the messages that are for it.
//
// Requests                                   answered by
// claim, to everybody or to this node        its claim, or "cannot claim"
// a group the application knows              the application; to the requester alone when the
//                                            request was, and the answer is longer than a frame
// another group, to this node                negative acknowledgement
// another group, to everybody                nothing
// a group that cannot be sent now            acknowledgement "busy", if it was to this node
//
// Without an address it receives only claims, requests for claims and commanded addresses.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "emulators/device.h"
#include "emulators/j1939/j1939_address.h"
#include "emulators/j1939/j1939_transport.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

struct J1939NodeSettings {
  J1939AddressPolicy address;        ///< Its answer_delay holds for everything the node sends.
  J1939TransportSettings transport;  ///< Its answer_delay is ignored.
  bool takes_commanded_address = true;
};

/// What became of a request.
enum class J1939Answer : std::uint8_t {
  sent,
  unknown,  ///< The device has no such group.
  busy,     ///< It has, but cannot send it now.
};

/// The device that a node belongs to.
class J1939Application {
 public:
  virtual ~J1939Application() = default;
  /// Send group `pgn`, to `destination` if it does not fit into a frame: kGlobalAddress when the
  /// request was to everybody.
  virtual J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) = 0;
  /// A message to this node or to everybody, other than those the node itself understands. Called
  /// only while the address is held. The result is counted for messages of one frame.
  virtual J1939Reception take(SimTime now, const J1939Message& message) = 0;
  /// Whether it moves where a commanded address sends it.
  [[nodiscard]] virtual bool takes_commanded_address(SimTime /*now*/) const { return true; }
};

class J1939Node final : J1939TransportSink {
 public:
  /// `application` and `output` must outlive the node.
  J1939Node(const J1939NodeSettings& settings, J1939Application& application, FrameOutput& output);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;

  /// The supply comes, and the node claims its preferred address, or goes, and it has none.
  void power(SimTime now, bool on);

  /// Any frame of the bus, complete at `now`; counted once in received(). The caller has advanced
  /// itself and the node to `now`.
  void receive(SimTime now, const protocols::can::Frame& frame);

  /// Handles a report of the node's controller (CanDevice::controller()).
  void controller(SimTime now, const protocols::can::ControllerReport& report) {
    if (report.restarted) {
      address_.on_restart(now);
    }
  }

  /// Executes a commanded address (J1939-81). Returns why it is refused; empty if it is accepted.
  [[nodiscard]] std::string_view command_address(SimTime now, std::uint8_t address);

  /// Sends a frame unchanged, due the answer delay after `now`. Precondition: held().
  void send(SimTime now, const protocols::can::Frame& frame);
  /// Sends a message of 0 .. 1785 bytes from this node: one frame up to eight bytes, else by
  /// transport to identifier.destination. Returns false and sends nothing without an address or
  /// while another long message to that destination is on its way. Ignores identifier.source.
  bool send(SimTime now, protocols::j1939::Identifier identifier,
            std::span<const std::uint8_t> payload);
  /// Sends a payload of group `pgn` as answer to `destination`, the requester or kGlobalAddress.
  /// Returns `busy` where send() returns false.
  [[nodiscard]] J1939Answer send_answer(SimTime now, std::uint32_t pgn, std::uint8_t destination,
                                        std::span<const std::uint8_t> payload);
  /// Sends an acknowledgement to all nodes, naming `requester` as the one who is answered.
  void acknowledge(SimTime now, protocols::j1939::Acknowledge control, std::uint8_t requester,
                   std::uint32_t pgn);

  [[nodiscard]] bool held() const { return address_.held(); }
  [[nodiscard]] std::uint8_t address() const { return address_.address(); }
  [[nodiscard]] std::uint64_t name() const { return address_.name(); }
  [[nodiscard]] std::uint64_t address_conflicts() const { return address_.conflicts(); }
  [[nodiscard]] const ReceiveCounters& received() const { return received_; }
  [[nodiscard]] const J1939Transport::Counters& transport_counters() const {
    return transport_.counters();
  }
  /// Whether a long message to everybody is on its way.
  [[nodiscard]] bool is_broadcasting() const {
    return transport_.is_sending(protocols::j1939::kGlobalAddress);
  }

 private:
  void transported(SimTime now, const J1939Message& message) override;
  [[nodiscard]] J1939Reception dispatch(SimTime now, const protocols::j1939::Identifier& identifier,
                                        const protocols::can::Frame& frame);
  [[nodiscard]] J1939Reception receive_request(SimTime now,
                                               const protocols::j1939::Identifier& identifier,
                                               const protocols::can::Frame& frame);
  void receive_commanded_address(SimTime now, std::span<const std::uint8_t> payload);
  /// Sessions do not outlive the address they were opened with.
  void follow_address();
  /// Held, and `destination` is this node or everybody.
  [[nodiscard]] bool is_for_us(std::uint8_t destination) const;

  J1939NodeSettings settings_;
  J1939Application& application_;
  FrameOutput& output_;
  J1939Address address_;
  J1939Transport transport_;
  std::uint8_t transport_address_ = protocols::j1939::kNullAddress;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
