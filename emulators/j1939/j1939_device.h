// A device that is one node of a J1939 bus: what is the same for all of them. Its node and its
// supply: before that first comes the node only listens, when it is lost it does not even that. It
// says who it is when it is asked, by software, component, ECU and vehicle identification, on an
// ISO 11783 bus by its functionalities; its trouble codes are asked for and cleared
// (trouble_memory.h). Answers longer than a frame go by transport, to the one who asked.
//
// A device that refuses answers commands, and requests that clear trouble codes, with a negative
// acknowledgement where they were to itself alone (J1939-21, 5.4.4), and stays at its address
// whatever a commanded address says. One that is slow sends a share of its scheduled groups.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "emulators/device.h"
#include "emulators/firmware_fault.h"
#include "emulators/j1939/identity.h"
#include "emulators/j1939/j1939_node.h"
#include "emulators/j1939/trouble_memory.h"
#include "emulators/live_setting.h"
#include "emulators/supply.h"
#include "protocols/iso11783/functionalities.h"

namespace rigwire::emulators {

class J1939Device : public CanDevice, J1939Application {
 public:
  [[nodiscard]] ReceiveCounters received() const final { return node_.received(); }
  void receive(SimTime now, const protocols::can::Frame& frame) override;
  void controller(SimTime now, const protocols::can::ControllerReport& report) final {
    node_.controller(now, report);
  }

  /// Executes a commanded address (J1939-81). Returns why it is refused; empty if it is accepted.
  [[nodiscard]] std::string_view command_address(SimTime now, std::uint8_t address) {
    advance(now);
    return refusal_.holds(now) ? "it refuses whatever would change it"
                               : node_.command_address(now, address);
  }

  [[nodiscard]] std::uint8_t address() const { return node_.address(); }
  [[nodiscard]] bool address_held() const { return node_.held(); }
  [[nodiscard]] std::uint64_t name() const { return node_.name(); }
  [[nodiscard]] std::uint64_t address_conflicts() const { return node_.address_conflicts(); }
  [[nodiscard]] Supply& supply() { return supply_; }
  [[nodiscard]] Pace& pace() { return pace_; }
  [[nodiscard]] Refusal& refusal() { return refusal_; }

 protected:
  /// What a request for identification is answered with. Without functionalities that group is not
  /// answered, and without a number the vehicle identification is not.
  struct Identity {
    IdentificationSettings texts;
    std::uint32_t serial = 0;
    std::vector<protocols::iso11783::SupportedFunctionality> functionalities{};
  };

  /// Claims its preferred address whenever the supply comes; what it sends is due `delay` after its
  /// cause. `output` must outlive the device.
  J1939Device(const protocols::j1939::Name& name, std::uint8_t preferred,
              const SupplySettings& supply, Duration delay, FrameOutput& output);
  /// Returns the next event of node and supply; for the device's own next_event() and advance().
  [[nodiscard]] SimTime next_node_event() const {
    return std::min(node_.next_event(), supply_.next_change());
  }
  void advance_node(SimTime now);
  [[nodiscard]] bool supplied() const { return supply_.on(); }
  /// The supply came or went at `now`: what the device was in the middle of is gone.
  virtual void switched(SimTime /*now*/) {}
  void identify_as(const Identity& identity) { identity_ = identity; }

  /// A request for a group that is none of the above (J1939Application::answer).
  virtual J1939Answer answer_group(SimTime now, std::uint32_t pgn, std::uint8_t destination) = 0;
  /// A message to this node or to everybody (J1939Application::take).
  virtual J1939Reception obey(SimTime now, const J1939Message& message) = 0;
  /// Whether group `pgn` is a command that it understands.
  [[nodiscard]] virtual bool is_command(std::uint32_t pgn) const = 0;
  /// One of these was refused.
  virtual void refused(SimTime /*now*/, const J1939Message& /*message*/) {}
  /// Its trouble codes; nullptr if it reports none.
  virtual TroubleMemory* troubles() { return nullptr; }
  /// Whether they light the red lamp.
  [[nodiscard]] virtual bool is_stopped() const { return false; }

  J1939Node node_;

 private:
  J1939Answer answer(SimTime now, std::uint32_t pgn, std::uint8_t destination) final;
  J1939Reception take(SimTime now, const J1939Message& message) final;
  [[nodiscard]] bool takes_commanded_address(SimTime now) const final {
    return !refusal_.holds(now);
  }
  J1939Answer answer_identification(SimTime now, std::uint32_t pgn, std::uint8_t destination);

  Supply supply_;
  Pace pace_;
  Refusal refusal_;
  bool supply_lost_ = false;
  std::optional<Identity> identity_;
};

/// Settings that every such device accepts at run time.
template <class Device, class Settings>
inline constexpr std::array<LiveSetting<Device, Settings>, 1> kJ1939LiveSettings{
    {{"source_address", "commanded address (J1939-81)",
      [](Device& device, SimTime now, const Settings& wanted) {
        return device.command_address(now, wanted.source_address);
      }}}};

}  // namespace rigwire::emulators
