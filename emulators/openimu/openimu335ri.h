// ACEINNA OpenIMU335RI and OpenIMU300RI: inertial measurement units on a J1939 bus.
//
// Follows the makers' open firmware (openIMU335RI-lib, openIMU300-lib); messages, settings and
// known deviations are in docs/devices/openimu335ri.md. The device ticks 200 times a second: it
// filters each sample, carries its tilt along, and every 2 * divider ticks sends the messages of
// its packet mask, slope, angular rate, acceleration, in this order. Its tilt comes from its own
// filter over the samples (openimu_filter.h), never from truth.
//
// Life: from power-on it waits (serial & 0x1F) * 5 ms, claims its address, and sends data from the
// next tick on. Requests (PGN 59904) and settings (FF50..FF59) are answered `processing_delay`
// after the frame that brought them. Foreign and malformed frames are counted and change nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/inertial/filter.h"
#include "emulators/openimu/address.h"
#include "protocols/openimu/axes.h"
#include "protocols/openimu/messages.h"
#include "protocols/openimu/settings.h"

namespace rigwire::emulators {

enum class OpenImuVariant : std::uint8_t {
  openimu300ri,  ///< Figures of merit always "not available", latency 0, claim repeated each
                 ///< second.
  openimu335ri,  ///< Figures of merit by state, latency sent, negative acknowledgements.
};

/// Behaviour bits that change something in this device; the others keep their default.
inline constexpr std::uint16_t kChangeableBehaviour =
    protocols::openimu::Behaviour::kSwapPitchRoll | protocols::openimu::Behaviour::kNorthWestUp |
    protocols::openimu::Behaviour::kSwapRequestPgn;

/// What a client can change over the bus.
struct OpenImuConfiguration {
  std::uint16_t packet_mask = protocols::openimu::PacketBit::kAll;
  std::uint8_t rate_divider = 1;      ///< One of kRateDividers: 0 off, 1 100 Hz, 2 50 Hz ...
  std::uint8_t rate_cut_off_hz = 25;  ///< One of kCutOffs_hz; 0 off.
  std::uint8_t acceleration_cut_off_hz = 25;
  std::uint16_t orientation = 0x0000;  ///< One of the 24 codes.
  std::uint16_t behaviour = protocols::openimu::Behaviour::kDefault;

  friend bool operator==(const OpenImuConfiguration&, const OpenImuConfiguration&) = default;
};

struct OpenImuSettings {
  OpenImuVariant variant = OpenImuVariant::openimu335ri;
  std::uint8_t source_address = 0x80;  ///< Preferred; 128 .. 247.
  std::uint32_t serial = 1;            ///< Low 21 bits go into the NAME; unique on a bus.
  OpenImuConfiguration configuration;
  double rate_range_radps = 400.0 * 3.14159265358979323846 / 180.0;  ///< Of the element; merit.
  double acceleration_range_mps2 = 8.0 * 9.80665;
  std::array<std::uint8_t, 5> software_version{1, 1, 0, 0,
                                               0};  ///< major, minor, patch, stage, build
  Duration power_on{0};  ///< From the start of the run to the first tick.
  Duration processing_delay =
      std::chrono::milliseconds{1};  ///< From a tick or request to the frame.
};

/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const OpenImuSettings& settings);

class OpenImu final : public CanDevice, public ImuBackend {
 public:
  static constexpr Duration kTick = std::chrono::milliseconds{5};
  static_assert(kTick * protocols::openimu::kTicksPerSecond == std::chrono::seconds{1});

  /// `output` must outlive the device.
  OpenImu(const OpenImuSettings& settings, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override { return address_.next_event(); }
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;

  void receive(SimTime now, const protocols::can::Frame& frame) override;
  /// One tick. Samples outside the element's range are clamped and marked; a sample that is not
  /// finite is sent as error (300RI: as not available).
  void update(const ImuSample& sample) override;

  [[nodiscard]] std::uint8_t address() const { return address_.address(); }
  [[nodiscard]] bool address_held() const { return address_.held(); }
  [[nodiscard]] std::uint64_t name() const { return address_.name(); }
  [[nodiscard]] std::uint64_t address_conflicts() const { return address_.conflicts(); }
  [[nodiscard]] const OpenImuConfiguration& configuration() const { return configuration_; }
  /// As of the last "save configuration"; the constructor's until then.
  [[nodiscard]] const OpenImuConfiguration& saved_configuration() const { return saved_; }

 private:
  /// The values and merits of the latest tick, device axes.
  struct Output {
    Triad rate_radps{};
    Triad specific_force_mps2{};
    std::array<bool, 3> rate_saturated{};
    std::array<bool, 3> force_saturated{};
    bool fault = false;
  };

  [[nodiscard]] protocols::openimu::FigureOfMerit merit(bool saturated) const;
  [[nodiscard]] double latency_ms() const;
  [[nodiscard]] std::uint16_t status_word() const;
  void rebuild_filters();
  void send(SimTime now, const protocols::can::Frame& frame);
  void send_packets(SimTime now, std::uint16_t mask);
  /// False when the group is not one that the device answers.
  [[nodiscard]] bool answer(SimTime now, std::uint32_t pgn);
  /// False when the setting is refused.
  [[nodiscard]] bool apply(SimTime now, const protocols::openimu::Setting& setting,
                           std::uint8_t requester);
  void receive_request(SimTime now, const protocols::can::Frame& frame);
  void receive_setting(SimTime now, const protocols::can::Frame& frame);

  OpenImuSettings settings_;
  FrameOutput& output_;
  OpenImuConfiguration configuration_;
  OpenImuConfiguration saved_;
  OpenImuAddress address_;
  LowPass rate_filter_;
  LowPass force_filter_;
  TiltFilter tilt_;
  Output latest_;
  std::uint64_t ticks_ = 0;
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
