// Checks how the parts of a rig go together: unknown names, wires and addresses taken twice,
// addresses beyond this machine. Checks CAN buses and Modbus lines like devices; repeats no check
// of a single field's range.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hil/configuration/problems.h"
#include "hil/devices/site.h"

namespace rigwire::hil {

/// In every function `path` is the key to report if something is wrong.
class RigCheck {
 public:
  /// All must outlive it.
  RigCheck(const RigView& rig, const Origins& origins, Problems& problems)
      : rig_(rig), origins_(origins), problems_(problems) {}

  [[nodiscard]] const RigView& rig() const { return rig_; }

  void report(const std::string& path, std::string what, std::string found = {},
              std::string allowed = {}, std::string suggestion = {});
  /// Claims `resource`, which can belong to one part of the rig only.
  void claim(const std::string& path, const std::string& resource, const std::string& shown);
  /// `found` must be one of `names`; `what` names what is missing ("no such bus").
  void one_of(const std::string& path, const std::string& what, const std::string& found,
              const std::vector<std::string>& names);

  /// Reports the key `path`, where it was written and not overruled by the later choice of `cause`,
  /// another key that leaves it without effect.
  void without_effect(const std::string& path, const std::string& cause, const std::string& why,
                      const std::string& found, const std::string& allowed);

  void link(const std::string& path, const std::string& link);
  /// Checks an absolute path that must be free.
  void file_path(const std::string& path, const std::string& file);
  /// Checks keys `path` and `ports` below `path`: absolute paths that must be free.
  void port_paths(const std::string& path, const std::string& file, unsigned ports);
  /// Checks an IPv4 address, of this machine unless `allow_remote`.
  void address(const std::string& path, const std::string& address, bool allow_remote);
  /// Checks keys `address` and `port` below `path`: a TCP server.
  void listener(const std::string& path, const std::string& address, std::uint16_t port,
                bool allow_remote);
  /// Checks key `line` below `path`. False when there is no such Modbus line.
  bool modbus_line(const std::string& path, const std::string& line);
  /// Checks key `bus` below `path`. False when there is no such bus.
  bool bus(const std::string& path, const std::string& bus);
  /// Checks keys `bus`, `source_address` and `serial` below `path`: a J1939 node.
  void j1939_node(const std::string& path, const std::string& bus, unsigned address,
                  std::uint32_t serial);
  /// Checks keys `bus` and `node_id` below `path`: a CANopen node, which may have none yet.
  void canopen_node(const std::string& path, const std::string& bus, unsigned node_id);
  /// Returns whether two devices of the bus may be given one address.
  [[nodiscard]] bool duplicates(const std::string& bus) const;
  /// To be called for everything on USB: they share one server.
  void usb();
  /// Checks a receiver of the rig, or one of `words`.
  void receiver(const std::string& path, const std::string& source,
                const std::vector<std::string>& words);
  /// Checks a base station of the rig other than `self`.
  void base_station(const std::string& path, const std::string& source, const std::string& self);
  /// The machine must have a valve block with these actuators; `path` is the device's, its key
  /// `sections`.
  void valve_block(const std::string& path, const std::vector<std::string>& sections);

 private:
  const RigView& rig_;
  const Origins& origins_;
  Problems& problems_;
  std::map<std::string, std::string> owners_;
  bool usb_claimed_ = false;
};

}  // namespace rigwire::hil
