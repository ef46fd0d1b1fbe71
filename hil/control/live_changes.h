// Changes a run while it runs: begins and ends faults, overrides set points of the machine, brings
// rain, snow or fog into the air, and changes settings of devices. Each change is reported as an
// event and noted for a recording with what is needed to repeat it at the same instant.
//
// No text of a client is parsed here: a request from outside brings its keys as a tree
// (commands.h). What is left is to check them and to apply them, which is bounded by the number of
// keys and the length of words of a request.
//
// A manual override of the air is a fault of the air that lasts until it is released, or until that
// fault is ended.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/configuration/document.h"
#include "hil/control/commands.h"
#include "hil/control/ruling.h"
#include "hil/executive/executive.h"
#include "hil/record/recorder.h"
#include "hil/record/run_events.h"
#include "hil/rig/rig_faults.h"
#include "hil/rig/rig_settings.h"
#include "hil/world/hand.h"

namespace rigwire::hil {

class LiveChanges {
 public:
  /// What it changes, and what it reports to. All must outlive it.
  struct Parts {
    Executive& executive;
    RigFaults& faults;
    Hand* hand = nullptr;             ///< Null: no manual override.
    RigSettings* settings = nullptr;  ///< Null: no device can be configured.
    Recorder* recorder = nullptr;     ///< Null: nothing is noted.
    RunEvents* events = nullptr;      ///< Null: no events.
  };
  explicit LiveChanges(Parts parts) : parts_(parts) {}

  [[nodiscard]] Ruling begin(const FaultAddCommand& command);
  [[nodiscard]] Ruling end(const FaultClearCommand& command);
  /// Applies all keys or none; for a device, those before the one that it refuses.
  [[nodiscard]] Ruling set(const SetCommand& command);

  /// A key that `set` can set, and its value as in a rig's file; empty: it is not overridden.
  struct Setting {
    std::string on;
    std::string key;
    std::string value;
  };
  [[nodiscard]] std::vector<Setting> settings() const;
  /// Returns the keys of `on` that can be set; empty: none.
  [[nodiscard]] std::vector<std::string> keys(const std::string& on) const;
  /// Returns the machine's set points, with their ranges where they are known.
  [[nodiscard]] nlohmann::ordered_json set_points() const;
  /// Returns the manual overrides of the air by their kind; null: this rig has no air.
  [[nodiscard]] nlohmann::ordered_json air() const;

 private:
  struct Brought {
    RigFaults::Id id = 0;
    std::string value;  ///< Value as it was written.
  };

  [[nodiscard]] Ruling set_machine(const SetCommand& command, const Value& keys);
  [[nodiscard]] Ruling set_air(const Value& keys);
  [[nodiscard]] Ruling set_device(const SetCommand& command, const Value& keys);
  /// Returns the names for which keys() is not empty.
  [[nodiscard]] std::vector<std::string> things() const;
  [[nodiscard]] std::string value(const std::string& on, const std::string& key) const;
  [[nodiscard]] bool has_air() const;
  /// Begins a fault now; nullopt: `problems` says why not. Throws NoSuchFault and
  /// std::invalid_argument as RigFaults.
  [[nodiscard]] std::optional<RigFaults::Numbered> begin_fault(const std::string& on, Value keys,
                                                               Problems& problems);
  /// Throws NoSuchFault.
  RigFaults::Numbered end_fault(RigFaults::Id id);
  void tell(EventKind kind, const std::string& where, const std::string& text);
  void note(const nlohmann::ordered_json& request);

  Parts parts_;
  /// Overridden set points, with the value as it was written.
  std::map<std::string, std::string> held_;
  std::map<std::string, Brought> air_;  ///< By kind of fault.
};

}  // namespace rigwire::hil
