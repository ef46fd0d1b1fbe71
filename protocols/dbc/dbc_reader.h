// A bus as a DBC file describes it.
//
// Format: Vector DBC File Format Documentation 1.0.5. Read are nodes (BU_), messages and signals
// (BO_, SG_), multiplexing (SG_, SG_MUL_VAL_), further senders (BO_TX_BU_), floating-point
// signals (SIG_VALTYPE_), named values (VAL_), comments (CM_) and these attributes (BA_, with their
// defaults), as Vector's own database templates name them:
//
//   GenMsgCycleTime       ms from frame to frame
//   GenMsgSendType        name of how it is sent: "Cyclic", "OnChange", ...
//   GenMsgDelayTime       minimum ms between two frames
//   GenMsgStartDelayTime  ms from power-up to the first frame
//   GenSigStartValue      raw value before the first measurement
//   VFrameFormat          "J1939PG": the identifier is priority, parameter group and source
//   SPN, SystemSignalLongSymbol, SystemMessageLongSymbol
//
// Everything else of the format is passed over. Comments of programs ("//", "/* */") are taken as
// space, and a missing semicolon is forgiven where the next statement begins. Text that is not
// UTF-8 is taken as ISO 8859-1, which is what the common tools write.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocols/can/message.h"

namespace rigwire::protocols::dbc {

/// What a file says of a signal beside its row.
struct FileSignal {
  std::optional<double> start_value;  ///< Raw.
  int line = 0;                       ///< In the file, from 1.
};

struct FileMessage {
  /// Limits that say nothing (0 .. 0) are what the bits carry. In J1939 messages patterns are
  /// reserved, and bits of no signal are 1. The sender is the first of `senders`.
  can::OwnedMessage layout;
  std::vector<FileSignal> signals;   ///< In the order of layout.signals.
  std::vector<std::string> senders;  ///< Nodes; empty: any node.
  std::string send_type;             ///< Name in the file; empty: not given.
  double period_ms = 0.0;            ///< 0: not given.
  double least_distance_ms = 0.0;
  double start_delay_ms = 0.0;
  int line = 0;
};

struct FileContent {
  std::vector<std::string> nodes;
  std::vector<FileMessage> messages;

  [[nodiscard]] const FileMessage* find(std::string_view message) const;
};

/// Something that is no DBC, with its place.
struct Finding {
  int line = 0;
  int column = 0;
  std::string what;
  std::string found;
  std::string allowed;
};

struct Reading {
  FileContent content;
  std::vector<Finding> findings;  ///< Empty: all is well.
};

/// Never throws but for want of memory. After a finding it goes on with the next statement.
[[nodiscard]] Reading read(std::string_view text);

/// How a message is sent; nothing set: by its cycle time where it has one.
struct SendType {
  bool by_time = false;
  bool on_change = false;  ///< Or when its event occurs.
  bool on_request = false;
};
/// Returns the meaning of a name of GenMsgSendType, of any maker's, in any case of letters.
[[nodiscard]] SendType send_type(std::string_view word);

/// Returns what keeps a message from being sent and taken with these of its signals and its
/// multiplexor: more bytes than its kind of frame has, signals that are outside it, wider than a
/// number, of the same name, overlapping, or multiplexed by a signal that does not exist. Files in
/// use have all of these, in messages that are not used. Sorted by line.
[[nodiscard]] std::vector<Finding> faults_of(const FileMessage& message,
                                             std::span<const std::string_view> used);

}  // namespace rigwire::protocols::dbc
