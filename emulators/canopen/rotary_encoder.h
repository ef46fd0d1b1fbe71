// An absolute rotary encoder on CANopen: CiA 406 (device profile for encoders), class 2, on the
// node of canopen_node.h. Objects, scales and deviations: docs/devices/cia406-encoder.md.
//
// The disc has 2^resolution_bits steps per revolution, over `revolutions` revolutions. Step 0 is
// the shaft's position at offset_rad; the step is the one whose middle is nearest (error at most
// half a step, no noise). Without scaling the position is the step; with scaling it is the step
// times units per revolution (6001) over steps, cut, within the total range (6002). A preset (6003)
// makes the present position that value, by the offset 6509. The code rises clockwise, seen on the
// shaft, unless bit 0 of 6000 is set. Speed (6030) is in measuring units per second, saturated at
// 16 bits: CiA 406 leaves its unit to the maker.
//
// A sample that is not finite is a position error: alarm bit, error register, emergency 5000; the
// position stays where it was.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/canopen/canopen_device.h"
#include "fields/rules.h"
#include "protocols/canopen/rotary_encoder.h"

namespace rigwire::emulators {

struct RotaryEncoderSettings : CanopenDeviceSettings {
  RotaryEncoderSettings()
      : CanopenDeviceSettings{.node = {},
                              .event_timer_ms = 20,
                              .supply = {},
                              .sampling = std::chrono::milliseconds{2}} {}

  std::uint8_t resolution_bits = 13;  ///< 13..16.
  /// Number of revolutions it distinguishes; 1: single-turn encoder.
  std::uint16_t revolutions = 1;
  bool counter_clockwise = false;  ///< Bit 0 of 6000 at delivery.
  double offset_rad = 0.0;         ///< Angle of step 0, on the sample's scale.
};

void visit(fields::Visitor& v, RotaryEncoderSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const RotaryEncoderSettings& settings);

class RotaryEncoder final : public CanopenDevice, public EncoderBackend {
 public:
  /// `memory` and `output` must outlive the encoder.
  RotaryEncoder(const RotaryEncoderSettings& settings, NonvolatileMemory& memory,
                FrameOutput& output);

  void advance(SimTime now) override;
  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  void update(const EncoderSample& sample) override;

  [[nodiscard]] static std::span<const LiveSetting<RotaryEncoder, RotaryEncoderSettings>>
  live_settings();

  /// Returns the present value of object 6004.
  [[nodiscard]] std::uint32_t position() const { return position_; }

 private:
  [[nodiscard]] std::optional<std::int64_t> live(
      protocols::canopen::ObjectAddress address) const override;
  [[nodiscard]] std::string_view text(protocols::canopen::ObjectAddress address) const override;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> write(
      protocols::canopen::ObjectAddress address, std::int64_t value) override;

  void written(SimTime now) override;
  void switched(SimTime now) override;
  [[nodiscard]] std::int64_t steps() const { return std::int64_t{1} << settings_.resolution_bits; }
  /// Measuring units before the offset, and of the whole range, with these operating parameters.
  struct Scale {
    std::int64_t operation;
    std::int64_t units_per_revolution;
    std::int64_t total_range;
  };
  [[nodiscard]] Scale scale() const;
  [[nodiscard]] std::int64_t units(const Scale& scale) const;
  void evaluate();

  RotaryEncoderSettings settings_;
  std::array<Quantity, 2> quantities_;
  SimTime now_ = kStart;
  SimTime powered_since_ = kStart;
  double angle_rad_ = 0.0;
  double rate_radps_ = 0.0;
  bool faulty_ = false;
  std::uint32_t position_ = 0;
};

}  // namespace rigwire::emulators
