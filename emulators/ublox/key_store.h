// The configuration items of a receiver in four layers, and what CFG-VALSET, VALGET, VALDEL and
// CFG-CFG do to them.
//
//   RAM       in force; items that an older CFG message has live in UbloxConfiguration's state
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

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/key_map.h"
#include "protocols/ubx/key_values.h"

namespace rigwire::emulators {

class UbloxKeyStore final : public UbloxKeyMessages {
 public:
  explicit UbloxKeyStore(const UbloxProfile& profile);

  [[nodiscard]] bool handles(protocols::ubx::MessageId id) const override;
  [[nodiscard]] bool is_poll(const protocols::ubx::FrameView& frame) const override;
  [[nodiscard]] std::size_t poll(const UbloxConfiguration& configuration,
                                 const protocols::ubx::FrameView& frame,
                                 std::span<std::uint8_t> out) override;
  [[nodiscard]] bool set(UbloxConfiguration& configuration,
                         const protocols::ubx::FrameView& frame) override;
  void interrupt() override { open_.reset(); }
  void reload(UbloxConfiguration& configuration) override;
  void forget() override { clear(backup_); }

  /// The item's value in a layer; nothing where that layer does not hold it. Precondition: index <
  /// configuration_keys().size().
  [[nodiscard]] std::optional<std::uint64_t> value(const UbloxConfiguration& configuration,
                                                   std::uint8_t layer, std::size_t index) const;

 private:
  using Layer = std::vector<std::optional<std::uint64_t>>;  ///< By index of the item.
  using Values = std::vector<std::uint64_t>;

  enum class Action : std::uint8_t { set, remove };
  struct Open {
    Action action = Action::set;
    std::uint8_t layers = 0;
  };

  static void clear(Layer& layer);
  [[nodiscard]] bool change(UbloxConfiguration& configuration, Action action,
                            const protocols::ubx::KeyChange& change);
  /// Adds the message's items to what waits; false when one of them is refused.
  [[nodiscard]] bool stage(Action action, std::span<const std::uint8_t> list);
  [[nodiscard]] bool apply(UbloxConfiguration& configuration, Action action, std::uint8_t layers);
  [[nodiscard]] bool apply_to_ram(UbloxConfiguration& configuration);
  [[nodiscard]] bool set_store(UbloxConfiguration& configuration,
                               std::span<const std::uint8_t> payload);
  [[nodiscard]] bool can_be_honoured(const UbloxProfile& profile,
                                     const UbloxConfigurationState& state,
                                     const Values& others) const;

  UbloxKeyMap map_;
  Values others_;     ///< RAM values of the items that are not part of the state.
  Values candidate_;  ///< The same, being changed.
  Layer backup_;
  Layer flash_;
  Layer staged_;
  std::optional<Open> open_;  ///< The transaction in work.
  std::size_t uart1_enabled_;
};

}  // namespace rigwire::emulators
