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

/// What nothing of the rig can do: which part, which kind.
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
  /// Up to this many that are over are told.
  static constexpr std::size_t kKept = 1000;
  struct Numbered {
    Id id;
    FaultWindow window;
  };
  /// Hears of every fault that is begun, and of every end that is made.
  using Listener = std::function<void(const FaultWindow&)>;
  /// Something that faults can be of, and their kinds.
  struct Target {
    std::string name;  ///< Name of the device; "bus can", "modbus cab".
    std::vector<fields::Named> kinds;
  };

  /// `seed` of the run, `quantities` those of the machine, by which faults may wait.
  explicit RigFaults(std::uint64_t seed = 0, std::vector<StateQuantity> quantities = {})
      : seed_(seed), quantities_(std::move(quantities)) {}

  /// One more port of `where`; what it was made with is numbered at once. The port must outlive
  /// this.
  void add(const std::string& where, FaultPort& port);
  void inform(Listener listener) { listener_ = std::move(listener); }

  /// Those that can have faults, in the order in which they were added.
  [[nodiscard]] std::vector<Target> targets() const;
  /// Also what is over, in the order of their numbers; of very many the oldest that are over are
  /// forgotten.
  [[nodiscard]] std::vector<Numbered> list() const;
  [[nodiscard]] std::vector<FaultWindow> windows() const;

  /// One more fault of kind `type` on `where`, filled by `fill`; nullopt where that says no. Throws
  /// NoSuchFault, and std::invalid_argument as the port.
  std::optional<Numbered> begin(SimTime now, const std::string& where, const std::string& type,
                                const FaultPort::Fill& fill);
  /// How many are over and not told any more.
  [[nodiscard]] std::uint64_t forgotten() const { return last_id_ - entries_.size(); }
  /// The machine's state at an instant that the devices have not reached: what waits for it begins.
  void look(SimTime now, SimTime instant, std::span<const double> state);
  /// Ends it, begun or not; it is told with its new end. Throws NoSuchFault where there is none of
  /// that number, or it is over.
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
