// Settings of a CAN node whose messages a DBC file defines, as the emulator needs them: which
// frames it sends when, what its signals show, which frames it takes and what they move. Made from
// a DBC file and its binding by hil/files/dbc_node_file.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "emulators/dbc_node/fault.h"
#include "emulators/supply.h"
#include "fields/rules.h"
#include "protocols/can/message.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class DbcChecksum : std::uint8_t { none, sum8, xor8, crc8_j1850 };
inline constexpr std::array<fields::Choice<DbcChecksum>, 4> kDbcChecksums{
    {{DbcChecksum::none, "none", "It is none."},
     {DbcChecksum::sum8, "sum8", "Sum of the other bytes, modulo 256."},
     {DbcChecksum::xor8, "xor8", "Exclusive or of the other bytes."},
     {DbcChecksum::crc8_j1850, "crc8_j1850",
      "SAE J1850 over the other bytes: polynomial 0x1D, from 0xFF, inverted."}}};
/// Returns the checksum over `data` without the byte `at`; 0 for `none`.
[[nodiscard]] std::uint8_t checksum(DbcChecksum method, std::span<const std::uint8_t> data,
                                    std::size_t at);

// What a signal of a sent message shows.
struct DbcHeld {};  ///< Its start value.
struct DbcMeasured {
  std::size_t quantity = 0;  ///< Index in DbcNodeSettings::measured.
  double factor = 1.0;       ///< From the quantity's SI unit to the signal's.
  double offset = 0.0;       ///< In the signal's unit.
  Duration filter{0};        ///< Time constant of a first-order low-pass; 0: none.
};
struct DbcCounter {};  ///< One more with each frame.
struct DbcSum {
  DbcChecksum method = DbcChecksum::sum8;
};
/// Last value received in a taken message; before the first one like DbcHeld.
struct DbcEcho {
  std::size_t message = 0;  ///< Index in DbcNodeSettings::taken.
  std::size_t signal = 0;   ///< Index among that message's signals.
};
using DbcSource = std::variant<DbcHeld, DbcMeasured, DbcCounter, DbcSum, DbcEcho>;

/// Content of one signal of a sent message.
struct DbcShown {
  std::uint64_t start_raw = 0;
  DbcSource source;
};

struct DbcSentMessage {
  protocols::can::OwnedMessage layout;
  std::vector<DbcShown> shows;       ///< In the order of layout.signals.
  Duration period{0};                ///< 0: not by time.
  bool on_change = false;            ///< When a signal's raw value is another one.
  bool on_request = false;           ///< A remote frame, or a J1939 request for its group.
  std::optional<std::size_t> after;  ///< Also after each of this message that is taken.
  Duration start_delay{0};           ///< From power-up to the first one.
  Duration least_distance{0};        ///< From the last one to one that is not cyclic.
};

// What a signal of a message that is taken is for.
struct DbcIgnored {};
struct DbcMove {
  std::size_t quantity = 0;  ///< Index in DbcNodeSettings::moved.
  double factor = 1.0;       ///< From the signal's unit to the quantity's SI unit.
  double offset = 0.0;       ///< In SI, after the factor.
  double safe = 0.0;         ///< In SI: before the first message, and when they stay away.
  bool clip = true;          ///< To the signal's limits; else a value beyond them is not taken.
};
using DbcUse = std::variant<DbcIgnored, DbcMove, DbcCounter, DbcSum>;

struct DbcTakenMessage {
  protocols::can::OwnedMessage layout;
  std::vector<DbcUse> uses;  ///< In the order of layout.signals.
  Duration timeout{0};       ///< 0: what came last holds for ever.
};

/// It claims an address (J1939-81) and sends all its J1939 messages with that.
struct DbcClaim {
  std::uint8_t source_address = 0x80;
  std::uint64_t name = 0;  ///< Packed (protocols/j1939/name.h).
  bool arbitrary_address = true;
};

struct DbcNodeSettings {
  /// Rows of the attachment's table, in the order of their use.
  std::vector<std::size_t> measured;
  /// Rows of the table of what it moves; ascending, without repetition.
  std::vector<std::size_t> moved;
  std::vector<DbcSentMessage> sent;
  std::vector<DbcTakenMessage> taken;
  std::optional<DbcClaim> claim;
  Duration sample_period = std::chrono::milliseconds{10};      ///< 1 ms .. 10 s.
  Duration processing_delay = std::chrono::microseconds{200};  ///< From an event to its frame.
  SupplySettings supply;
  std::vector<DbcNodeFault> faults;
};

}  // namespace rigwire::emulators
