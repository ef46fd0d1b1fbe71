// A device that is a node of a CAN bus, whatever it measures: joins the emulator with its bus and
// its station, its own clock, and the memory that outlives its supply.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "emulators/device.h"
#include "emulators/nonvolatile_memory.h"
#include "emulators/own_clock.h"
#include "emulators/supply.h"
#include "emulators/valve_amplifier/fault.h"
#include "fields/visitor.h"
#include "hil/devices/device.h"
#include "hil/devices/node_faults.h"
#include "hil/devices/site.h"
#include "hil/devices/valve_source.h"
#include "hil/executive/station.h"

namespace rigwire::hil {

using NodeMemory = std::unique_ptr<emulators::NonvolatileMemory>;

/// Builds an emulator of `arguments` and an output without a receiver, and returns what `ask`
/// returns for it.
template <class Emulator, class Ask, class... Arguments>
[[nodiscard]] auto asked(const Ask& ask, const Arguments&... arguments) {
  emulators::NullFrameOutput nowhere;
  return ask(Emulator(arguments..., nowhere));
}
/// Does the same as asked() for an emulator with a nonvolatile memory.
template <class Emulator, class Ask, class Settings>
[[nodiscard]] auto asked_with_memory(const Ask& ask, const Settings& settings) {
  emulators::VolatileMemory memory;
  emulators::NullFrameOutput nowhere;
  return ask(Emulator(settings, memory, nowhere));
}

/// Returns when the supply of an emulator with these settings first comes.
template <class Settings>
[[nodiscard]] SimTime supplied_from(const Settings& settings) {
  if constexpr (requires { settings.supply; }) {
    return kStart + settings.supply.power_on;
  } else {
    return kStart + settings.power_on;
  }
}

/// Returns the period of a fault by that clock.
[[nodiscard]] inline FaultPeriod in_own_time(const emulators::OwnClock& clock, FaultPeriod when) {
  when.at = clock.own_time(when.at);
  when.until = when.until ? std::optional(clock.own_time(*when.until)) : std::nullopt;
  return when;
}
/// Returns the settings with all external events at instants of the run converted to its own clock.
template <class Settings>
[[nodiscard]] Settings in_own_time(const emulators::OwnClock& clock, Settings settings) {
  if constexpr (requires { settings.supply; }) {
    for (emulators::SupplyFault& fault : settings.supply.faults) {
      fault.when = in_own_time(clock, fault.when);
    }
  }
  if constexpr (requires { settings.amplifier; }) {
    for (emulators::ValveDefect& defect : settings.amplifier.defects) {
      defect.when = in_own_time(clock, defect.when);
    }
  }
  if constexpr (requires { settings.faults; }) {
    for (auto& fault : settings.faults) {
      fault.when = in_own_time(clock, fault.when);
    }
  }
  return settings;
}

/// Backend between a station and an emulator that applies faults to the samples.
template <class Backend>
class FaultyUpdate : public Backend {
 public:
  using Sample = typename Backend::Sample;

  /// `backend` must outlive it.
  FaultyUpdate(Backend& backend, const NodeFaults<Sample>& faults, std::uint64_t seed)
      : backend_(backend), faults_(faults, seed) {}

  void update(const Sample& sample) override {
    Sample seen = sample;
    faults_.lay_over(seen);
    backend_.update(seen);
  }
  [[nodiscard]] NodeSamples<Sample>& faults() { return faults_; }

 protected:
  [[nodiscard]] const Backend& backend() const { return backend_; }

 private:
  Backend& backend_;
  NodeSamples<Sample> faults_;
};
template <class Backend>
class FaultyBackend final : public FaultyUpdate<Backend> {
 public:
  using FaultyUpdate<Backend>::FaultyUpdate;
};
/// Backend of a device that also sends commands.
template <Commands Backend>
class FaultyBackend<Backend> final : public FaultyUpdate<Backend> {
 public:
  using FaultyUpdate<Backend>::FaultyUpdate;
  [[nodiscard]] const typename Backend::Command& command() const override {
    return this->backend().command();
  }
};

/// `Backend` is the interface of the emulator that takes its samples (emulators/backends.h). It has
/// a clock of its own (emulators/own_clock.h), drawn from the streams "<name>/clock" and, for the
/// jitter, "<name>/clock/jitter".
template <class Emulator, class Backend>
class CanDeviceOf : public Device {
 public:
  using Faults = NodeFaults<typename Backend::Sample>;

  /// Makes the emulator from `settings`, `arguments` and the node's output.
  template <class Settings, class... Arguments>
  CanDeviceOf(Site& site, const std::string& bus, const emulators::OwnClockSettings& clock,
              const Faults& faults, const Settings& settings, const Arguments&... arguments)
      : CanDeviceOf(Clocked{site, bus, clock, faults,
                            asked<Emulator>(kSamplePeriod, settings, arguments...)},
                    nullptr, settings, arguments...) {}
  /// Makes an emulator with memory from settings, memory and output.
  template <class Settings>
  CanDeviceOf(Site& site, const std::string& bus, const emulators::OwnClockSettings& clock,
              const Faults& faults, const Settings& settings, NodeMemory memory)
      : CanDeviceOf(
            Clocked{site, bus, clock, faults, asked_with_memory<Emulator>(kSamplePeriod, settings)},
            std::move(memory), settings) {}

  /// Once, after construction.
  [[nodiscard]] StationIndex enlist(Executive& executive) { return executive.add(station_); }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return bus_.endpoint(); }
  [[nodiscard]] std::uint64_t dropped() const override {
    const emulators::CanNodeCounters counters = bus_.bus().counters(node_);
    return statistics().dropped + counters.overflowed + counters.abandoned;
  }
  [[nodiscard]] const Emulator& emulator() const override { return emulator_; }
  [[nodiscard]] std::optional<ClientRequest> last_request() const override {
    return client_request(bus_.bus().last_request(node_));
  }

  /// Sets what can be changed while the emulator runs; `settings` is the member of the
  /// configuration that it is made with. To be called once, after construction.
  template <class Configuration, class Settings>
  void hear(std::span<const emulators::LiveSetting<Emulator, Settings>> rows,
            Settings Configuration::*settings) {
    tell_ = [this, rows, settings](SimTime now, const DeviceConfiguration& wanted,
                                   std::string_view key) {
      return hil::tell(rows, key, emulator_, clock_.own_time(now),
                       static_cast<const Configuration&>(wanted).*settings);
    };
  }
  [[nodiscard]] std::string tell(SimTime now, const DeviceConfiguration& wanted,
                                 std::string_view key) override {
    return tell_(now, wanted, key);
  }

 protected:
  [[nodiscard]] Emulator& emulated() { return emulator_; }
  [[nodiscard]] const emulators::OwnClock& clock() const { return clock_; }

 private:
  static constexpr auto kSamplePeriod = [](const Emulator& emulator) {
    return emulator.sample_plan().period;
  };

  /// Where it is, and what its clock is made of.
  struct Clocked {
    Site& site;
    const std::string& bus;
    const emulators::OwnClockSettings& clock;
    const Faults& faults;
    Duration sample_period;
  };

  template <class Settings, class... Arguments>
  CanDeviceOf(const Clocked& at, NodeMemory memory, const Settings& settings,
              const Arguments&... arguments)
      : bus_(at.site.bus(at.bus)),
        clock_(drawn_clock_error(at.clock, at.site.stream_seed("clock")), supplied_from(settings),
               at.sample_period),
        node_(bus_.add_node(own_statistics())),
        frames_(at.faults.frames, at.site.stream_seed("faults/frames"), node_),
        output_(clock_, at.clock.jitter, at.site.stream_seed("clock/jitter"), frames_),
        memory_(std::move(memory)),
        emulator_(made(settings, arguments...)),
        on_own_clock_(clock_, emulator_),
        samples_(on_own_clock_, at.faults, at.site.stream_seed("faults/samples")),
        station_(on_own_clock_, samples_) {
    bus_.attach(node_, on_own_clock_);
    offer_faults(settings);
    offer_program_faults(at.faults);
    offer(make_fault_port(at.faults.frames, acted_by<emulators::FrameFault>(frames_)));
    if constexpr (requires { at.faults.samples; }) {
      if (at.faults.of_samples) {
        offer(make_fault_port(
            at.faults.samples,
            acted_by<emulators::SampleFault<typename Backend::Sample>>(samples_.faults())));
      }
    }
  }

  template <class Settings>
  void offer_faults(const Settings& settings) {
    if constexpr (requires { settings.amplifier.defects; }) {
      auto acts = acted_on_own_clock<emulators::ValveDefect>(emulator_.defects());
      acts.name = valve_fault_names(settings.amplifier);
      offer(make_fault_port(settings.amplifier.defects, std::move(acts)));
    }
    if constexpr (requires { settings.faults; }) {
      using Fault = typename decltype(settings.faults)::value_type;
      offer(make_fault_port(settings.faults, acted_on_own_clock<Fault>(emulator_.faults())));
    }
    if constexpr (requires { settings.supply; }) {
      offer(make_fault_port(settings.supply.faults,
                            acted_on_own_clock<emulators::SupplyFault>(emulator_.supply())));
    }
  }

  /// The emulator has none of these when it is made; here it is given them.
  void offer_program_faults(const AnyNodeFaults& faults) {
    if constexpr (requires { emulator_.pace(); }) {
      offer_begun(faults.pace, emulator_.pace());
    }
    if constexpr (requires { emulator_.refusal(); }) {
      offer_begun(faults.refusal, emulator_.refusal());
    }
  }
  template <class Fault, class Actor>
  void offer_begun(const std::vector<Fault>& faults, Actor& actor) {
    auto acts = acted_on_own_clock<Fault>(actor);
    for (const Fault& fault : faults) {
      acts.begin(fault);
    }
    offer(make_fault_port(faults, std::move(acts)));
  }

  template <class Fault, class Actor>
  [[nodiscard]] FaultActs<Fault> acted_on_own_clock(Actor& actor) const {
    return {[this, &actor](Fault fault) {
              fault.when = in_own_time(clock_, fault.when);
              actor.begin(fault);
            },
            [this, &actor](std::uint32_t id, SimTime now) {
              return actor.end(id, clock_.own_time(now));
            }};
  }

  template <class Settings, class... Arguments>
  [[nodiscard]] Emulator made(const Settings& settings, const Arguments&... arguments) {
    const Settings own = in_own_time(clock_, settings);
    if constexpr (std::is_constructible_v<Emulator, const Settings&, emulators::NonvolatileMemory&,
                                          emulators::FrameOutput&>) {
      return Emulator(own, *memory_, output_);
    } else {
      return Emulator(own, arguments..., output_);
    }
  }

  RigCan& bus_;
  emulators::OwnClock clock_;
  emulators::FrameOutput& node_;
  emulators::FaultyFrames frames_;
  emulators::OwnClockOutput output_;
  NodeMemory memory_;  ///< Null when the emulator has none.
  Emulator emulator_;
  emulators::OnOwnClock<Emulator, Backend> on_own_clock_;
  FaultyBackend<Backend> samples_;
  StationOf<Backend> station_;
  std::function<std::string(SimTime, const DeviceConfiguration&, std::string_view)> tell_ =
      [](SimTime, const DeviceConfiguration&, std::string_view) {
        return "this device has no settings that can be changed at run time";
      };
};

/// Returns what a device does on a CAN bus, from its emulator.
[[nodiscard]] inline auto bus_share_of(const std::string& bus, std::string_view name) {
  return [bus, name](const emulators::CanDevice& emulator) {
    return BusShare{bus, emulator.nominal_rate_hz(), emulator.messages(name)};
  };
}

/// Returns the settings with those faults of the list that the emulator itself simulates.
template <class Settings, class Mixed>
[[nodiscard]] Settings with_supply_faults(Settings settings, const std::vector<Mixed>& faults) {
  settings.supply.faults = those_of<emulators::SupplyFault>(faults);
  return settings;
}

/// The keys of every device on a CAN bus.
template <class Fault>
void visit_node(fields::Visitor& v, std::string& bus, emulators::OwnClockSettings& clock,
                std::vector<Fault>& faults) {
  v.text("bus", bus, "Name of the rig's bus that the device is on.");
  v.section("clock", clock, "The device's own clock: how far it runs from the true one.");
  v.list("faults", faults, "What goes wrong with the device, and when.");
}

/// "can NAME at 250000 bit/s, WHO".
[[nodiscard]] inline std::string can_wire(const RigView& rig, const std::string& bus,
                                          const std::string& who) {
  const auto found = rig.buses.find(bus);
  return found == rig.buses.end()
             ? bus
             : fmt::format("CAN bus {} at {} bit/s, {}", bus, found->second.bus.bit_rate_bps, who);
}

/// A J1939 node that sends frames of 8 bytes.
[[nodiscard]] inline DevicePlan j1939_plan(const RigView& rig, const std::string& bus,
                                           unsigned address, double frames_hz,
                                           const std::string& with) {
  return {can_wire(rig, bus, fmt::format("address 0x{:02X}", address)),
          fmt::format("{:.0f} frames/s", frames_hz), fmt::format("{:.0f} B/s", frames_hz * 8),
          with};
}

/// A J1939 message as describe() lists it.
inline void add_message(DeviceDescription& description, std::uint32_t pgn, std::string_view name,
                        std::string rate, std::string content) {
  description.messages.push_back(
      {fmt::format("{} {:04X} {}", pgn, pgn, name), std::move(rate), std::move(content)});
}
/// Those that a J1939 device sends by a schedule; a group without a period is asked for.
template <class Schedule>
void add_schedule(DeviceDescription& description, const Schedule& schedule) {
  for (const auto& entry : schedule) {
    const auto period = entry.group.period.count();
    add_message(
        description, entry.group.pgn, entry.group.name,
        period == 0 ? "on request" : fmt::format("{:g} Hz", 1e3 / static_cast<double>(period)),
        "sent");
  }
}

}  // namespace rigwire::hil
