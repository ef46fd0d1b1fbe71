// ACEINNA OpenIMU335RI and OpenIMU300RI: inertial measurement units on a J1939 bus.
//
// Follows the makers' open firmware (openIMU335RI-lib, openIMU300-lib); messages, settings and
// known deviations are in docs/devices/openimu335ri.md. The device ticks 200 times a second: it
// filters each sample, carries its tilt along, and every 2 * divider ticks sends the messages of
// its packet mask. Its tilt comes from its own filter over the samples (inertial/filter.h), never
// from truth.
//
// Life: the 335RI waits (serial & 0x1F) * 5 ms, 31 for 0, before it claims its address, and claims
// again when it is back from bus-off; the 300RI claims at once and then every second. Data follow
// from the next tick on. Requests (PGN 59904) and settings (FF50..FF5E, FFF0..) are answered
// `processing_delay` after the frame that brought them. What "save" has written, and an address won
// in contention, outlives the supply and a restart. Foreign and malformed frames are counted and
// change nothing. A unit that refuses does with every setting what the firmware does with one that
// it does not take: it says that "save" and "reset" have failed, and nothing of the others. One
// that is slow sends a share of each packet.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/firmware_fault.h"
#include "emulators/inertial/filter.h"
#include "emulators/j1939/j1939_address.h"
#include "emulators/live_setting.h"
#include "emulators/nonvolatile_memory.h"
#include "emulators/openimu/settings.h"
#include "emulators/supply.h"

namespace rigwire::emulators {

class OpenImu final : public CanDevice, public ImuBackend {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{5};
  static_assert(kTick * protocols::openimu::kTicksPerSecond == std::chrono::seconds{1});

  /// `memory` and `output` must outlive the device.
  OpenImu(const OpenImuSettings& settings, NonvolatileMemory& memory, FrameOutput& output);
  /// With a memory of its own that lasts as long as the device.
  OpenImu(const OpenImuSettings& settings, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override;
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;
  void controller(SimTime now, const protocols::can::ControllerReport& report) override;
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  /// One tick. Samples outside the element's range are clamped and marked; a sample that is not
  /// finite is sent as error (300RI: as not available).
  void update(const ImuSample& sample) override;

  [[nodiscard]] std::uint8_t address() const { return address_.address(); }
  [[nodiscard]] bool address_held() const { return address_.held(); }
  [[nodiscard]] std::uint64_t name() const { return address_.name(); }
  [[nodiscard]] std::uint64_t address_conflicts() const { return address_.conflicts(); }
  [[nodiscard]] const OpenImuConfiguration& configuration() const { return configuration_; }
  /// Returns the configuration of the last "save configuration"; the constructor's until then.
  [[nodiscard]] const OpenImuConfiguration& saved_configuration() const {
    return saved_.configuration;
  }
  /// Returns the number of vehicle messages that would aid the 335RI's algorithm; they are accepted
  /// and change nothing.
  [[nodiscard]] std::uint64_t aiding_messages() const { return aiding_messages_; }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] Pace& pace() { return pace_; }
  [[nodiscard]] Refusal& refusal() { return refusal_; }
  /// Its parameter groups.
  [[nodiscard]] static std::span<const LiveSetting<OpenImu, OpenImuSettings>> live_settings();

 private:
  /// The values and merits of the latest tick, device axes.
  struct Output {
    Triad rate_radps{};
    Triad specific_force_mps2{};
    Triad magnetic_field_gauss{};
    std::array<bool, 3> rate_saturated{};
    std::array<bool, 3> force_saturated{};
    bool fault = false;
  };

  [[nodiscard]] bool is_300() const { return settings_.variant == OpenImuVariant::openimu300ri; }
  [[nodiscard]] std::uint8_t merit(bool saturated) const;
  /// Returns what replaces the values of failed elements.
  [[nodiscard]] double no_number() const;
  /// A value and its figure of merit.
  void put(double value, bool saturated, double limit, double& number, std::uint8_t& figure) const;
  template <class Message>
  void put_rates(Message& message) const;
  [[nodiscard]] double latency_ms() const;
  [[nodiscard]] std::uint16_t status_word() const;
  void start(SimTime now);
  void switch_supply(SimTime now);
  void rebuild_filters();
  void sense(const ImuSample& sample);
  void send(SimTime now, const protocols::can::Frame& frame);
  /// Those of the configured packets that it has time for.
  [[nodiscard]] std::uint16_t packets_due(SimTime now);
  void send_packets(SimTime now, std::uint16_t mask);
  void send_slopes(SimTime now, std::uint16_t mask);
  void send_acceleration(SimTime now);
  void send_trouble(SimTime now);
  /// False when it could not be written.
  bool remember();
  /// Returns false if the device does not answer the group.
  [[nodiscard]] bool answer(SimTime now, std::uint32_t pgn, std::uint8_t requester);
  [[nodiscard]] bool answer_data(SimTime now, std::uint32_t pgn);
  [[nodiscard]] bool answer_status(SimTime now, std::uint32_t pgn);
  [[nodiscard]] bool answer_setting(SimTime now, std::uint32_t pgn, std::uint8_t requester);
  /// Returns false if the setting is refused.
  [[nodiscard]] bool apply(SimTime now, const protocols::openimu::Setting& setting,
                           std::uint8_t requester);
  /// Applies a setting as if it were addressed to this node. Returns why it is refused; empty if it
  /// is accepted.
  [[nodiscard]] std::string_view tell(SimTime now, const protocols::openimu::Setting& setting);
  [[nodiscard]] bool apply_command(SimTime now, const protocols::openimu::Setting& setting,
                                   std::uint8_t requester);
  void apply_priorities(const protocols::openimu::Setting& setting);
  void apply_behaviour(const protocols::openimu::Setting& setting);
  void receive_request(SimTime now, const protocols::can::Frame& frame);
  void receive_setting(SimTime now, const protocols::can::Frame& frame);
  void receive_bank(SimTime now, std::uint32_t pgn, std::span<const std::uint8_t> payload);
  void clear_trouble(SimTime now, std::uint8_t requester);

  OpenImuSettings settings_;
  VolatileMemory own_memory_;
  NonvolatileMemory& memory_;
  FrameOutput& output_;
  OpenImuConfiguration configuration_;
  OpenImuMemory saved_;
  std::uint8_t held_address_ = 0;            ///< The last one that was written down.
  std::optional<std::uint8_t> new_address_;  ///< Asked for by a client; "save" writes it down.
  bool memory_damaged_ = false;
  Supply supply_;
  Pace pace_;
  Refusal refusal_;
  SimTime restart_ = kNever;  ///< Asked for by a client.
  J1939Address address_;
  LowPass rate_filter_;
  LowPass force_filter_;
  TiltFilter tilt_;
  Output latest_;
  std::uint64_t ticks_ = 0;
  SimTime next_trouble_ = kNever;
  std::uint8_t troubles_ = 0;  ///< Occurrences, up to 126.
  std::uint64_t aiding_messages_ = 0;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
