// Every fault of a running rig, numbered: those of its file and those that were begun since.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hil/configuration/fault_port.h"
#include "hil/configuration/fault_window.h"
#include "hil/executive/truth_source.h"

namespace rigwire::hil {

/// Thrown when no part of the rig, or not this one, can have the fault.
class NoSuchFault : public std::invalid_argument {
 public:
  NoSuchFault(const std::string& what, std::string key, std::string asked, std::string possible)
      : std::invalid_argument(what),
        path(std::move(key)),
        found(std::move(asked)),
        allowed(std::move(possible)) {}

  std::string path;  ///< "on", "fault.type", "id".
  std::string found;
  std::string allowed;
};

class RigFaults {
 public:
  /// Number of a fault, from 1, never given twice.
  using Id = std::uint32_t;
  /// Number of ended faults that are kept.
  static constexpr std::size_t kKept = 1000;
  struct Numbered {
    Id id;
    FaultWindow window;
  };
  /// Called for every fault that is begun, and every end that is set.
  using Listener = std::function<void(const FaultWindow&)>;
  /// A part of the rig that can have faults, and their kinds.
  struct Target {
    std::string name;  ///< Name of the device; "bus can", "modbus cab".
    std::vector<fields::Named> kinds;
  };

  /// `seed` is the run's; faults may wait for the machine's `quantities`.
  explicit RigFaults(std::uint64_t seed = 0, std::vector<StateQuantity> quantities = {})
      : seed_(seed), quantities_(std::move(quantities)) {}

  /// Adds a port of `where`; the faults that it was made with are numbered at once. The port must
  /// outlive this.
  void add(const std::string& where, FaultPort& port);
  void inform(Listener listener) { listener_ = std::move(listener); }

  /// Returns the parts that can have faults, in the order in which they were added.
  [[nodiscard]] std::vector<Target> targets() const;
  /// Returns the faults, ended ones included, in the order of their numbers; of the ended ones only
  /// the newest kKept.
  [[nodiscard]] std::vector<Numbered> list() const;
  [[nodiscard]] std::vector<FaultWindow> windows() const;

  /// Begins a fault of kind `type` on `where`, filled by `fill`; nullopt when `fill` refuses.
  /// Throws NoSuchFault, and std::invalid_argument as the port.
  std::optional<Numbered> begin(SimTime now, const std::string& where, const std::string& type,
                                const FaultPort::Fill& fill);
  /// Returns how many ended faults are not kept any more.
  [[nodiscard]] std::uint64_t forgotten() const { return last_id_ - entries_.size(); }
  /// Takes the machine's state at an `instant` that the devices have not reached, and begins the
  /// faults that waited for it.
  void look(SimTime now, SimTime instant, std::span<const double> state);
  /// Ends a fault, begun or not, and reports it with its new end. Throws NoSuchFault when there is
  /// none of that number, or it is over.
  Numbered end(SimTime now, Id id);

 private:
  struct Port {
    std::string where;
    FaultPort* port;
  };
  /// By number.
  struct Entry {
    Id number;
    std::size_t port;
    FaultPort::Id id;  ///< The port's.
  };
  struct Wait {
    Id number;
    std::size_t quantity;  ///< Index in the machine's state.
    bool above;
    double value;
    SimTime from;
  };

  [[nodiscard]] std::size_t quantity(const std::string& name) const;
  void enter(std::size_t port, FaultPort::Id id);
  void wait_for(std::size_t port, FaultPort::Id id, Id number);
  void forget();

  std::uint64_t seed_;
  std::vector<StateQuantity> quantities_;
  std::vector<Port> ports_;
  std::vector<Entry> entries_;
  Id last_id_ = 0;
  std::vector<Wait> waits_;
  Listener listener_ = [](const FaultWindow&) {};
};

}  // namespace rigwire::hil
