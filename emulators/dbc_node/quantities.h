// What a device that is described by a file can measure and move, by what it is attached to: the
// names that such a file uses, and what each is in a sample or command.
//
// A name is "joint.angle": what the device is attached to, and what of it. All of one device are of
// one attachment. Values are SI units; a temperature is degC.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "emulators/backends.h"
#include "fields/units.h"

namespace rigwire::emulators {

/// A device that is attached to nothing: no samples, no commands.
struct NothingSample {
  SimTime time{};
};
class NothingBackend {
 public:
  using Sample = NothingSample;

  virtual ~NothingBackend() = default;
  virtual void update(const Sample& sample) = 0;
};

/// A quantity of a sample: NaN where the machine does not have it.
template <class Sample>
struct SampleQuantity {
  std::string_view name;
  fields::Dimension dimension;
  std::string_view text;
  double (*of)(const Sample&);
};

/// A member of a command.
template <class Command>
struct CommandQuantity {
  std::string_view name;
  fields::Dimension dimension;
  std::string_view text;
  double neutral;  ///< Value without a message.
  void (*set)(Command&, double);
};

/// Command type of a backend that has no command.
struct NoCommand {};

/// By backend: `kName`, what it is called in names; `Command`; its tables.
template <class Backend>
struct Attachment;

template <>
struct Attachment<NothingBackend> {
  using Command = NoCommand;
  static constexpr std::string_view kName = "nothing";
  static std::span<const SampleQuantity<NothingSample>> measured() { return {}; }
  static std::span<const CommandQuantity<NoCommand>> commanded() { return {}; }
};
template <>
struct Attachment<EncoderBackend> {
  using Command = NoCommand;
  static constexpr std::string_view kName = "joint";
  static std::span<const SampleQuantity<EncoderSample>> measured();
  static std::span<const CommandQuantity<NoCommand>> commanded() { return {}; }
};
template <>
struct Attachment<ImuBackend> {
  using Command = NoCommand;
  static constexpr std::string_view kName = "inertial";
  static std::span<const SampleQuantity<ImuSample>> measured();
  static std::span<const CommandQuantity<NoCommand>> commanded() { return {}; }
};
template <>
struct Attachment<GnssBackend> {
  using Command = NoCommand;
  static constexpr std::string_view kName = "satellites";
  static std::span<const SampleQuantity<GnssSample>> measured();
  static std::span<const CommandQuantity<NoCommand>> commanded() { return {}; }
};
template <>
struct Attachment<ValveBackend> {
  using Command = ValveCommand;
  static constexpr std::string_view kName = "valves";
  static std::span<const SampleQuantity<ValveSample>> measured();
  static std::span<const CommandQuantity<ValveCommand>> commanded();
};
template <>
struct Attachment<PowerUnitBackend> {
  using Command = PowerUnitCommand;
  static constexpr std::string_view kName = "power_unit";
  static std::span<const SampleQuantity<PowerUnitSample>> measured();
  static std::span<const CommandQuantity<PowerUnitCommand>> commanded();
};
template <>
struct Attachment<VehicleBackend> {
  using Command = VehicleCommand;
  static constexpr std::string_view kName = "vehicle";
  static std::span<const SampleQuantity<VehicleSample>> measured();
  static std::span<const CommandQuantity<VehicleCommand>> commanded();
};

/// One row of those tables, whatever it is attached to.
struct NamedQuantity {
  std::string_view attachment;  ///< "joint"
  std::string_view name;        ///< "angle"
  fields::Dimension dimension;
  std::string_view text;
  std::size_t index;     ///< Row in the table of its attachment.
  double neutral = 0.0;  ///< Value without a message, for a quantity that is moved.

  [[nodiscard]] std::string full_name() const;  ///< "joint.angle"
};

/// All of them, by attachment.
[[nodiscard]] std::span<const NamedQuantity> measured_quantities();
[[nodiscard]] std::span<const NamedQuantity> moved_quantities();
/// "joint.angle" in one of those lists; nullptr.
[[nodiscard]] const NamedQuantity* find_quantity(std::span<const NamedQuantity> among,
                                                 std::string_view name);

}  // namespace rigwire::emulators
