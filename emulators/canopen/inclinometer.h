// A two-axis MEMS inclinometer on CANopen: CiA 410 (device profile for inclinometers) on the node
// of canopen_node.h, as ifm's JN2101. Objects, constants and deviations:
// docs/devices/cia410-inclinometer.md.
//
// It measures the specific force f (x forward, y left, z up) and takes its direction for "up": a
// machine that accelerates is tilted, as it is for every such sensor. The slopes are perpendicular
// angles, each between an axis and the horizontal:
//   longitudinal = atan2(f_x, |(f_y, f_z)|), positive with x up
//   lateral      = atan2(f_y, |(f_x, f_z)|), positive with y up
// With quadrant correction (2040) the root takes the sign of f_z, so that a sensor on its back
// reads beyond 90 deg, up to 180 or, counted through, from 0 to 360.
//
// Before that each axis of f passes a first-order low-pass (2043), solved exactly for an input that
// is held between two samples: after dt the distance from it has shrunk by exp(-2 pi cut-off dt).
// It starts in the steady state of the first sample after power-on.
//
// A slope is rounded to the resolution (6000): error at most half a count. Then it is inverted and
// offset as its operating parameter says, and saturated at its object's type. Beyond `range_rad` it
// stays at the limit; where f has no direction (not a number, or shorter than kLeastForce_mps2) it
// stays where it was. Both are an error of that axis: error register 01, emergency 5010 or 5020.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/canopen/canopen_device.h"
#include "fields/rules.h"
#include "protocols/canopen/inclinometer.h"

namespace rigwire::emulators {

/// Defaults as delivered by ifm electronic: node 10, its first TPDO after each SYNC.
struct InclinometerSettings : CanopenDeviceSettings {
  InclinometerSettings()
      : CanopenDeviceSettings{
            .node = {.node_id = 10}, .transmission_type = 1, .vendor = 0x159, .supply = {}} {}

  std::uint16_t resolution_mdeg = 10;   ///< 6000 at delivery: 1, 10, 100 or 1000.
  std::uint8_t filter_step = 1;         ///< 2043 at delivery: 0 off, 1..4 are 10, 5, 1, 0.5 Hz.
  std::uint8_t quadrants = 0;           ///< 2040 at delivery: 0 +-90, 1 +-180, 2 0..360 deg.
  double range_rad = std::numbers::pi;  ///< Measured to both sides; more is an error.
  std::uint32_t product = 0;
};

void visit(fields::Visitor& v, InclinometerSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const InclinometerSettings& settings);

class Inclinometer final : public CanopenDevice, public ImuBackend {
 public:
  /// A hundredth of gravity: a shorter specific force has no direction.
  static constexpr double kLeastForce_mps2 = 0.0980665;

  /// `memory` and `output` must outlive the inclinometer.
  Inclinometer(const InclinometerSettings& settings, NonvolatileMemory& memory,
               FrameOutput& output);

  [[nodiscard]] std::span<const Quantity> quantities() const override { return quantities_; }
  [[nodiscard]] static std::span<const LiveSetting<Inclinometer, InclinometerSettings>>
  live_settings();
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view name) const override;
  /// The angular rate and the magnetic field are not used.
  void update(const ImuSample& sample) override;

 private:
  using Force = std::array<double, 3>;  ///< m/s2.
  static constexpr std::size_t kAxes = 2;

  [[nodiscard]] std::optional<std::int64_t> live(
      protocols::canopen::ObjectAddress address) const override;
  [[nodiscard]] std::string_view text(protocols::canopen::ObjectAddress address) const override;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> write(
      protocols::canopen::ObjectAddress address, std::int64_t value) override;

  void switched(SimTime now) override;
  void filter(SimTime now, const Force& force);
  [[nodiscard]] double angle_rad(std::size_t axis) const;
  /// Returns the inclination in counts of the present resolution, inverted if so configured,
  /// without offsets.
  [[nodiscard]] std::int64_t measured(const protocols::canopen::SlopeObjects& slope) const;
  [[nodiscard]] std::int64_t value(const protocols::canopen::SlopeObjects& slope) const;
  [[nodiscard]] std::optional<protocols::canopen::SdoAbort> preset(
      const protocols::canopen::SlopeObjects& slope, std::int64_t wanted);
  void report(SimTime now, const std::array<bool, kAxes>& errors);

  InclinometerSettings settings_;
  std::array<Quantity, kAxes> quantities_;
  bool settled_ = false;          ///< The filter has had a sample since power-on.
  SimTime filtered_at_ = kStart;  ///< Time of the sample before.
  Force input_{};                 ///< Filter input, held since the sample before.
  Force filtered_{};
  Force up_{0.0, 0.0, 1.0};  ///< The last filtered force that had a direction.
  std::array<bool, kAxes> errors_{};
};

}  // namespace rigwire::emulators
