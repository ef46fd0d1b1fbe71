// The configuration items of a receiver in four layers, and what CFG-VALSET, VALGET, VALDEL and
// CFG-CFG do to them.
//
//   RAM       in force; items that an older CFG message has live in UbloxConfigurationState
//   BBR       battery-backed memory: single items, in force after a reset, above flash
//   flash     the same, and kept without supply
//   default   of the firmware, with what UbloxSettings switches on
//
// A VALSET that names an unknown item, a value outside its limits or no layer is refused whole; so
// is one for RAM whose result could not be honoured. A transaction collects such messages and
// applies them at once; a wrong step, other layers, an empty "ongoing", a refused item or any other
// configuration message drops it. There is no time-out.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, sections 3.10.2,
// 3.10.23 to 3.10.25 and 6.3 to 6.7. Where 6.6 and 3.10.25 differ (pairs in the message that
// applies, "ongoing" without pairs), 6.6 is followed. Not documented, chosen: limits of single
// items hold for every layer; a VALGET of BBR or flash that finds nothing is refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/ublox/configuration_state.h"
#include "emulators/ublox/key_map.h"
#include "protocols/ubx/key_values.h"

namespace rigwire::emulators {

class UbloxKeyStore {
 public:
  /// The default layer is `defaults`, and what it does not hold the firmware's.
  UbloxKeyStore(const UbloxProfile& profile, const UbloxConfigurationState& defaults);

  [[nodiscard]] static bool handles(protocols::ubx::MessageId id);
  [[nodiscard]] static bool is_poll(const protocols::ubx::FrameView& frame);
  /// Payload size of the answer, written into `out`; 0 when the poll is refused.
  [[nodiscard]] std::size_t poll(const UbloxConfigurationState& present,
                                 const protocols::ubx::FrameView& frame,
                                 std::span<std::uint8_t> out);
  /// False when it is refused, and then nothing has changed.
  [[nodiscard]] bool set(UbloxConfigurationState& present, const protocols::ubx::FrameView& frame);
  /// Another configuration message came: what waits in a transaction is dropped.
  void interrupt() { open_.reset(); }
  /// After a reset: what the layers below say is in force again.
  void reload(UbloxConfigurationState& present);
  /// The battery-backed memory lost its supply.
  void forget() { clear(backup_); }

 private:
  using Layer = std::vector<std::optional<std::uint64_t>>;  ///< By index of the item.
  using Values = std::vector<std::uint64_t>;

  enum class Action : std::uint8_t { set, remove };
  struct Open {
    Action action = Action::set;
    std::uint8_t layers = 0;
  };

  static void clear(Layer& layer);
  /// The item's value in a layer; nothing where that layer does not hold it.
  [[nodiscard]] std::optional<std::uint64_t> value(const UbloxConfigurationState& present,
                                                   std::uint8_t layer, std::size_t index) const;
  [[nodiscard]] bool change(UbloxConfigurationState& present, Action action,
                            const protocols::ubx::KeyChange& change);
  /// Adds the message's items to what waits; false when one of them is refused.
  [[nodiscard]] bool stage(Action action, std::span<const std::uint8_t> list);
  [[nodiscard]] bool apply(UbloxConfigurationState& present, Action action, std::uint8_t layers);
  [[nodiscard]] bool apply_to_ram(UbloxConfigurationState& present);
  [[nodiscard]] bool set_store(UbloxConfigurationState& present,
                               std::span<const std::uint8_t> payload);
  [[nodiscard]] bool can_be_honoured(const UbloxConfigurationState& state,
                                     const Values& others) const;

  const UbloxProfile* profile_;
  UbloxConfigurationState defaults_;
  UbloxKeyMap map_;
  Values others_;     ///< RAM values of the items that are not part of the state.
  Values candidate_;  ///< Copy of `others_` while a transaction is checked.
  Layer backup_;
  Layer flash_;
  Layer staged_;
  std::optional<Open> open_;  ///< The transaction in work.
  std::size_t uart1_enabled_;
};

}  // namespace rigwire::emulators
