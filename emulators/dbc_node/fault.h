// What goes wrong with a node that is described by a DBC file.
//
//   faults:
//     - {type: silent, at: 10 s, for: 2 s}
//     - {type: frozen_signal, at: 15 s, for: 5 s, message: Slope, signal: Pitch}
#pragma once

#include <string>
#include <variant>

#include "fields/visitor.h"
#include "sim/samples/fault_book.h"

namespace rigwire::emulators {

struct SilentNodeFault {
  static constexpr fields::Named kNamed{"silent", "It sends nothing, or not this message."};

  std::string message;  ///< Empty: all.
};
struct FrozenSignalFault {
  static constexpr fields::Named kNamed{"frozen_signal", "A signal shows what it showed before."};

  std::string message;
  std::string signal;
};
struct FalseSignalFault {
  static constexpr fields::Named kNamed{"false_signal", "A signal shows this value."};

  std::string message;
  std::string signal;
  double value = 0.0;  ///< In the signal's unit; beyond its limits only as far as its bits carry.
};
struct RawSignalFault {
  static constexpr fields::Named kNamed{"raw_signal",
                                        "The bits of a signal are these: an error pattern."};

  std::string message;
  std::string signal;
  std::uint64_t raw = 0;
};
struct StoppedCounterFault {
  static constexpr fields::Named kNamed{"stopped_counter",
                                        "Counters of the message stay as they are."};

  std::string message;
};
struct WrongChecksumFault {
  static constexpr fields::Named kNamed{"wrong_checksum", "Checksums of the message are wrong."};

  std::string message;
};
struct ShortFrameFault {
  static constexpr fields::Named kNamed{"short_frame", "The message lacks its last byte."};

  std::string message;
};

void visit(fields::Visitor& v, SilentNodeFault& p);
void visit(fields::Visitor& v, FrozenSignalFault& p);
void visit(fields::Visitor& v, FalseSignalFault& p);
void visit(fields::Visitor& v, RawSignalFault& p);
void visit(fields::Visitor& v, StoppedCounterFault& p);
void visit(fields::Visitor& v, WrongChecksumFault& p);
void visit(fields::Visitor& v, ShortFrameFault& p);

struct DbcNodeFault {
  FaultPeriod when;
  std::variant<SilentNodeFault, FrozenSignalFault, FalseSignalFault, RawSignalFault,
               StoppedCounterFault, WrongChecksumFault, ShortFrameFault>
      what;
};
void visit(fields::Visitor& v, DbcNodeFault& p);

using DbcNodeFaults = FaultBook<DbcNodeFault>;

/// The message that it is of, empty: all; and its signal, empty: the message itself.
struct DbcFaultPlace {
  std::string_view message;
  std::string_view signal;
};
[[nodiscard]] DbcFaultPlace place_of(const DbcNodeFault& fault);

}  // namespace rigwire::emulators
