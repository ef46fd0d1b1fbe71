// A CANopen slave: boot-up, network management, SDO server, heartbeat, emergency, transmit PDOs and
// parameters that can be saved. What the device is comes from its profile.
//
// Source: CiA 301 V4.2.0, 7.2 and 7.3. Life: `boot` after power-on the node sends its boot-up
// message and is pre-operational (operational at once when it starts by itself). SDOs are served in
// both states, PDOs sent when operational only, heartbeats always. A node without a node-ID
// receives only the layer setting services (lss_slave.h) until they give it one; it receives those
// in every state. A PDO of type
//   0         is sent after a SYNC when what it carries has changed
//   1..240    after each so many SYNCs
//   254       when what it carries has changed, and when its event timer elapses
//   255       when its event timer elapses
// and in the last two cases also when the node becomes operational; what a write to the dictionary
// makes due follows its answer. Inhibit times hold. Node guarding, remote requests, receive PDOs
// and block transfer are not supported.
//
// A node that is slow sends a share of its PDOs; what it leaves out of those sent on a change goes
// with the next look at it. A node that refuses aborts whatever an SDO would write with 0x08000022,
// "cannot be transferred or stored because of the present device state" (7.2.4.3.17), and answers
// LSS with the implementation specific error 255 (CiA 305); it can be read, and managed.
//
// What outlives the supply is one block: the node-ID that LSS stored (0: none, it is that of the
// settings), then the dictionary's.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/canopen/lss_slave.h"
#include "emulators/canopen/object_dictionary.h"
#include "emulators/canopen/sdo_server.h"
#include "emulators/device.h"
#include "emulators/firmware_fault.h"
#include "protocols/canopen/communication_objects.h"
#include "protocols/canopen/eds.h"
#include "protocols/canopen/identifiers.h"

namespace rigwire::emulators {

/// What a device profile adds to a node.
class CanopenProfile {
 public:
  virtual ~CanopenProfile() = default;
  /// Returns the present value of a read-only entry that is not in the dictionary; else nullopt.
  [[nodiscard]] virtual std::optional<std::int64_t> live(
      protocols::canopen::ObjectAddress address) const = 0;
  /// The text of a string entry.
  [[nodiscard]] virtual std::string_view text(protocols::canopen::ObjectAddress address) const = 0;
  /// Handles a client's write of a value within the entry's limits. Returns nullopt if it is
  /// accepted; then the dictionary holds the value.
  [[nodiscard]] virtual std::optional<protocols::canopen::SdoAbort> write(
      protocols::canopen::ObjectAddress address, std::int64_t value) = 0;
};

struct CanopenNodeSettings {
  std::uint8_t node_id = 1;        ///< At delivery: 1..127; kNoNodeId: LSS gives it one.
  std::uint32_t bit_rate_bps = 0;  ///< Bit rate of its bus, for LSS; 0: confirms none.
  Duration boot = std::chrono::milliseconds{200};  ///< From power-on to the boot-up message.
  Duration processing_delay = std::chrono::microseconds{200};  ///< From an event to the frame.
  bool starts_itself = false;  ///< Operational without a master's command.
};

class CanopenNode final : private SdoObjects, private LssNode {
 public:
  /// All must outlive the node.
  CanopenNode(const CanopenNodeSettings& settings, ObjectDictionary& dictionary,
              CanopenProfile& profile, NonvolatileMemory& memory, FrameOutput& output);

  /// Sets what object 1021 returns. To be called once, when the dictionary holds the values at
  /// delivery. Identity, texts and values are the dictionary's and the profile's.
  void describe(const std::string& file, const std::string& description,
                const std::string& vendor_name);
  [[nodiscard]] const std::string& electronic_data_sheet() const { return eds_; }

  /// Switches the supply on or off. The node is off when constructed.
  void power(SimTime now, bool on);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;
  void receive(SimTime now, const protocols::can::Frame& frame);
  /// A mappable object may have another value now.
  void changed(SimTime now);
  /// Writes an object as an SDO download does. Returns why it is refused; empty if it is accepted.
  [[nodiscard]] std::string_view configure(SimTime now, protocols::canopen::ObjectAddress address,
                                           std::int64_t value);
  /// A new error (code other than 0) or none any more.
  void report_error(SimTime now, std::uint16_t code, std::uint8_t error_register);

  [[nodiscard]] Pace& pace() { return pace_; }
  [[nodiscard]] Refusal& refusal() { return refusal_; }

  [[nodiscard]] protocols::canopen::NodeState state() const { return state_; }
  [[nodiscard]] bool powered() const { return powered_; }
  /// In force; protocols::canopen::kNoNodeId: none.
  [[nodiscard]] std::uint8_t node_id() const override { return node_id_; }
  [[nodiscard]] const ReceiveCounters& received() const { return received_; }
  /// Returns the number of received frames whose identifier only this node may send: another node
  /// has the same node-ID.
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  /// PDOs on timers and heartbeats per second, as set and operational.
  [[nodiscard]] double nominal_rate_hz() const;

 private:
  struct Pdo {
    SimTime timer = kNever;    ///< When the event timer elapses.
    SimTime allowed = kStart;  ///< When the inhibit time ends.
    bool pending = false;      ///< Waits for `allowed`.
    unsigned syncs = 0;        ///< SYNCs since it was sent.
    std::uint8_t length = 0;   ///< Length of the PDO sent last, bytes.
    std::array<std::uint8_t, 8> sent{};
  };

  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> read(
      protocols::canopen::ObjectAddress address, SdoValue& value) const override;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> write(
      SimTime now, protocols::canopen::ObjectAddress address, std::span<const std::uint8_t> data,
      bool sized) override;

  [[nodiscard]] protocols::canopen::LssIdentity identity() const override;
  [[nodiscard]] bool store_node_id(std::uint8_t node_id) override;
  [[nodiscard]] bool takes_bit_rate(std::uint32_t bit_rate_bps) const override {
    return bit_rate_bps == settings_.bit_rate_bps;
  }
  [[nodiscard]] bool refuses(SimTime now) const override { return refusal_.holds(now); }
  void keep_silent(SimTime now, Duration span) override { silent_until_ = now + span; }
  void reset_communication(SimTime now) override;

  /// What outlives the supply.
  struct Remembered {
    std::uint8_t node_id = 0;  ///< 0: that of the settings.
    std::span<const std::uint8_t> parameters;
  };
  [[nodiscard]] Remembered remembered() const;
  [[nodiscard]] bool remember(std::uint8_t node_id, std::span<const std::uint8_t> parameters);

  [[nodiscard]] std::int64_t number(protocols::canopen::ObjectAddress address) const;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> check(
      protocols::canopen::ObjectAddress address, std::int64_t value) const;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> check_pdo(
      protocols::canopen::ObjectAddress address, std::int64_t value) const;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> check_mapping(
      protocols::canopen::ObjectAddress address, std::int64_t value) const;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> command(
      protocols::canopen::ObjectAddress address, std::int64_t value);
  void reset(SimTime now, std::uint16_t last_index);
  void enter(SimTime now, protocols::canopen::NodeState state);
  void obey(SimTime now, protocols::canopen::NetworkCommand command);
  void synchronise(SimTime now);
  void start_timer(SimTime now, std::size_t pdo);
  [[nodiscard]] std::int64_t pdo_parameter(std::size_t pdo, std::uint8_t sub) const;
  std::uint8_t fill(std::size_t pdo, std::array<std::uint8_t, 8>& payload) const;
  void send_pdo(SimTime now, std::size_t pdo);
  void send(SimTime now, const protocols::can::Frame& frame);

  CanopenNodeSettings settings_;
  ObjectDictionary& dictionary_;
  CanopenProfile& profile_;
  NonvolatileMemory& memory_;
  FrameOutput& output_;
  Pace pace_;
  Refusal refusal_;
  SdoServer server_;
  LssSlave lss_;
  std::string eds_;
  std::uint8_t node_id_;
  SimTime silent_until_ = kStart;
  bool powered_ = false;
  bool restore_ = false;  ///< The next reset forgets what was saved.
  protocols::canopen::NodeState state_ = protocols::canopen::NodeState::initialising;
  SimTime boot_ = kNever;
  SimTime heartbeat_ = kNever;
  std::array<Pdo, protocols::canopen::kTransmitPdos> pdos_;
  ReceiveCounters received_;
  std::uint64_t duplicates_ = 0;
};

}  // namespace rigwire::emulators
