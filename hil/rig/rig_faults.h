// Every fault of a running rig, numbered: those of its file and those that were begun since.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hil/configuration/fault_port.h"
#include "hil/configuration/fault_window.h"

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

  /// One more port of `where`; what it was made with is numbered at once. The port must outlive
  /// this.
  void add(const std::string& where, FaultPort& port);
  void inform(Listener listener) { listener_ = std::move(listener); }

  /// Those that can have faults, in the order in which they were added.
  [[nodiscard]] std::vector<Target> targets() const;
  /// Also what is over, in the order of their numbers.
  [[nodiscard]] std::vector<Numbered> list() const;
  [[nodiscard]] std::vector<FaultWindow> windows() const;

  /// One more fault of kind `type` on `where`, filled by `fill`; nullopt where that says no. Throws
  /// NoSuchFault, and std::invalid_argument as the port.
  std::optional<Numbered> begin(SimTime now, const std::string& where, const std::string& type,
                                const FaultPort::Fill& fill);
  /// Ends it, begun or not; it is told with its new end. Throws NoSuchFault where there is none of
  /// that number, or it is over.
  Numbered end(SimTime now, Id id);

 private:
  struct Port {
    std::string where;
    FaultPort* port;
  };
  /// By number - 1.
  struct Entry {
    std::size_t port;
    FaultPort::Id id;  ///< The port's.
  };

  std::vector<Port> ports_;
  std::vector<Entry> entries_;
  Listener listener_ = [](const FaultWindow&) {};
};

}  // namespace rigwire::hil
