// Xsens MTi-600 series on CAN: here the MTi-620, a vertical reference unit. Messages, scales and
// deviations: docs/devices/xsens-mti-600.md.
//
// The unit samples 400 times a second. Each message has a rate of its own, 400 Hz over a whole
// number; those that are due with one sample leave in this order: sample time, group counter, UTC,
// then by identifier. Axes are x forward, y left, z up; angles follow the right-hand rule in a
// local frame of x east, y north, z up: roll right side down, pitch nose down, yaw
// counter-clockwise positive. Attitude comes from the unit's own filter (inertial/orientation.h),
// never from truth.
//
// A sample outside the elements' range is clamped and marked in the status word. A sample that is
// not finite is a failed self-test: the status word says so, and no measured values are sent. The
// unit is configured over its serial line, which is not there; it receives nothing on the bus, and
// so cannot refuse anything. One that is slow sends a share of each message; increments are then
// over the longer time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/device.h"
#include "emulators/firmware_fault.h"
#include "emulators/inertial/orientation.h"
#include "emulators/supply.h"
#include "fields/rules.h"
#include "protocols/xsens/messages.h"
#include "sim/samples/calendar.h"

namespace rigwire::emulators {

inline constexpr unsigned kMtiSamplesPerSecond = 400;

/// One message that the unit can send, and how often: each so many samples; 0 never.
struct MtiOutput {
  protocols::xsens::MessageId id;
  std::uint16_t divider = 0;
};
/// What an MTi-620 can send, in the order of sending; 100 Hz for those that it sends at delivery.
inline constexpr std::array<MtiOutput, 16> kMtiOutputs{
    {{protocols::xsens::MessageId::sample_time, 4},
     {protocols::xsens::MessageId::group_counter, 4},
     {protocols::xsens::MessageId::utc, 0},
     {protocols::xsens::MessageId::status_word, 4},
     {protocols::xsens::MessageId::quaternion, 4},
     {protocols::xsens::MessageId::euler_angles, 0},
     {protocols::xsens::MessageId::velocity_increment, 0},
     {protocols::xsens::MessageId::rate_of_turn, 4},
     {protocols::xsens::MessageId::orientation_increment, 0},
     {protocols::xsens::MessageId::acceleration, 4},
     {protocols::xsens::MessageId::free_acceleration, 0},
     {protocols::xsens::MessageId::magnetic_field, 0},
     {protocols::xsens::MessageId::temperature, 0},
     {protocols::xsens::MessageId::pressure, 0},
     {protocols::xsens::MessageId::rate_of_turn_fast, 0},
     {protocols::xsens::MessageId::acceleration_fast, 0}}};

/// What the sample time counts (protocols/xsens/messages.h).
enum class MtiSampleTime : std::uint8_t { ticks_100us, microseconds };
[[nodiscard]] constexpr unsigned ticks_per_second(MtiSampleTime unit) {
  return unit == MtiSampleTime::ticks_100us ? 10'000 : 1'000'000;
}

struct MtiSettings {
  std::array<MtiOutput, kMtiOutputs.size()> outputs = kMtiOutputs;
  MtiSampleTime sample_time = MtiSampleTime::ticks_100us;
  bool extended = false;     ///< 29-bit identifiers.
  double heading_rad = 0.0;  ///< Heading of the filter at power-on; counter-clockwise from east.
  double rate_range_radps = 2000.0 * 3.14159265358979323846 / 180.0;  ///< Range of the gyros.
  double acceleration_range_mps2 = 10.0 * 9.80665;
  double magnetic_reference_t = 48.7e-6;  ///< Field strength that is shown as 1.
  double magnetic_range_t = 800e-6;
  double pressure_pa = 101325.0;  ///< Constant: no weather reaches the barometer.
  SupplySettings supply;
  Duration start_up = std::chrono::milliseconds{0};          ///< From power-on to the first sample.
  Duration processing_delay = std::chrono::milliseconds{2};  ///< From a sample to its frames.
};

/// Without what is constant in every unit: magnetic reference and range, pressure.
void visit(fields::Visitor& v, MtiSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const MtiSettings& settings);

class Mti600 final : public CanDevice, public ImuBackend {
 public:
  static constexpr Duration kTick = std::chrono::microseconds{2500};
  static_assert(kTick * kMtiSamplesPerSecond == std::chrono::seconds{1});

  /// `calendar` and `output` must outlive the unit.
  Mti600(const MtiSettings& settings, const Calendar& calendar, FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] SimTime next_event() const override { return supply_.next_change(); }
  [[nodiscard]] SamplePlan sample_plan() const override;
  [[nodiscard]] ReceiveCounters received() const override { return received_; }
  [[nodiscard]] double nominal_rate_hz() const override;
  [[nodiscard]] std::span<const Quantity> quantities() const override;
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  /// Counted as ignored.
  void receive(SimTime now, const protocols::can::Frame& frame) override;
  void update(const ImuSample& sample) override;

  /// A message that did not fit into the controller's queue: error 1 follows with the next sample.
  void controller(SimTime /*now*/, const protocols::can::ControllerReport& report) override {
    overflowed_ = overflowed_ || report.transmit_overflow;
  }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] Pace& pace() { return pace_; }
  [[nodiscard]] const Quaternion& attitude() const { return filter_.attitude(); }

 private:
  void send(const ImuSample& sample, const MtiOutput& output);
  void restart(SimTime now);

  MtiSettings settings_;
  const Calendar& calendar_;
  FrameOutput& output_;
  Supply supply_;
  Pace pace_;
  OrientationFilter filter_;
  SimTime ready_at_ = kNever;
  std::uint64_t ticks_ = 0;
  std::uint16_t group_ = 0;
  std::uint32_t status_ = 0;
  bool failed_ = false;
  bool overflowed_ = false;
  Triad rate_radps_{};
  Triad force_mps2_{};
  Triad velocity_increment_mps_{};
  Quaternion orientation_increment_{1.0, 0.0, 0.0, 0.0};
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
