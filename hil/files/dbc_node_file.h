// A user's own device on CAN: the messages from a DBC file, and a YAML file that binds their
// signals to what the device measures and moves, without C++.
//
// docs/your-own-can-device.md walks through one; configs/can/ has examples. Names of quantities:
// emulators/dbc_node/quantities.h (`rigwire describe dbc-node` lists them).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "emulators/dbc_node/settings.h"
#include "emulators/j1939/identity.h"
#include "fields/rules.h"

namespace rigwire::hil {

/// Values that a binding gives in place of those of the DBC file.
struct DbcLayoutBinding {
  /// Value of one count; 0: this and the next two as in the DBC file.
  double scale = 0.0;
  double offset = 0.0;  ///< Value of raw 0.
  std::string unit;     ///< Empty: as in the DBC file.
};
void visit(fields::Visitor& v, DbcLayoutBinding& p);

/// A signal of a message that is sent. At most one source; without any its start value.
struct DbcSentBinding {
  std::string signal;
  std::string quantity;  ///< "joint.angle"
  double factor = 1.0;   ///< Factor on the quantity.
  double offset = 0.0;   ///< Added after it, in the signal's unit.
  Duration filter{0};    ///< Time constant.
  std::string value;     ///< A number in the signal's unit, or one of its names.
  bool counter = false;
  emulators::DbcChecksum checksum = emulators::DbcChecksum::none;
  std::string echo;  ///< "Message.Signal" of one that is taken.
  DbcLayoutBinding layout;
};
void visit(fields::Visitor& v, DbcSentBinding& p);

enum class DbcSendingBinding : std::uint8_t {
  as_file,
  cyclic,
  on_change,
  cyclic_and_on_change,
  on_request,
  never
};

struct DbcSentMessageBinding {
  std::string message;
  DbcSendingBinding send = DbcSendingBinding::as_file;
  Duration period{0};  ///< 0: as the file says.
  std::string after;   ///< A message that is taken: this one follows it.
  int priority = -1;   ///< J1939 priority; -1: as in the DBC file.
  std::vector<DbcSentBinding> signals;
};
void visit(fields::Visitor& v, DbcSentMessageBinding& p);

/// A signal of a message that is taken.
struct DbcTakenBinding {
  std::string signal;
  std::string moves;    ///< "valves.opening_1"
  double factor = 1.0;  ///< Factor on the signal's value.
  double offset = 0.0;  ///< Added after it, in the quantity's SI unit.
  std::string safe;     ///< A quantity: "0 %"; empty: the neutral one.
  bool clip = true;     ///< A value beyond the signal's limits counts as the limit.
  bool counter = false;
  emulators::DbcChecksum checksum = emulators::DbcChecksum::none;
  DbcLayoutBinding layout;
};
void visit(fields::Visitor& v, DbcTakenBinding& p);

struct DbcTakenMessageBinding {
  std::string message;
  Duration timeout = std::chrono::milliseconds{500};  ///< 0: none.
  std::vector<DbcTakenBinding> signals;
};
void visit(fields::Visitor& v, DbcTakenMessageBinding& p);

/// The YAML file.
struct DbcNodeBinding {
  std::string text;
  std::string dbc;   ///< The file's path.
  std::string node;  ///< Node of the DBC file; empty: only what is listed here is sent.
  bool claims_address = false;
  std::uint8_t source_address = 0x80;
  bool arbitrary_address = true;
  std::uint32_t serial = 1;
  emulators::J1939NameSettings name;
  Duration sample_period = std::chrono::milliseconds{10};
  Duration processing_delay = std::chrono::microseconds{200};
  std::vector<DbcSentMessageBinding> sends;
  std::vector<DbcTakenMessageBinding> takes;
};
void visit(fields::Visitor& v, DbcNodeBinding& p);

/// What both files together say.
struct DbcNodeDescription {
  std::string text;
  std::string attachment = "nothing";  ///< What its quantities are of.
  std::uint32_t serial = 0;            ///< In its NAME, where it claims an address.
  emulators::DbcNodeSettings settings;
};

/// Throws ConfigurationError with every finding of both files, each with file, line and column:
/// what the reader finds, what is no DBC, messages, signals and quantities that are not there (with
/// the nearest one), units that do not belong to the quantity, quantities of several attachments,
/// messages of which neither file says when they are sent, a quantity that two signals move.
[[nodiscard]] DbcNodeDescription load_dbc_node(const std::string& file);

}  // namespace rigwire::hil
