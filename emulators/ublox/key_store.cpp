#include "emulators/ublox/key_store.h"

#include <algorithm>

namespace rigwire::emulators {
namespace {

using namespace protocols::ubx;
using Payload = std::span<const std::uint8_t>;

constexpr std::uint8_t kSavedLayers = kLayerMaskBattery | kLayerMaskFlash;
constexpr std::uint8_t kAllLayers = kLayerMaskRam | kSavedLayers;
/// Every enabled system has a signal, and one of them gives a position by itself.
bool systems_are_sound(std::span<const CfgGnssBlock> systems) {
  constexpr std::uint32_t kSignals = 0x00FF0000;
  return has_major_system(systems) && std::ranges::all_of(systems, [](const CfgGnssBlock& block) {
           return (block.flags & 1U) == 0 || (block.flags & kSignals) != 0;
         });
}

bool sentences_are_sound(const CfgNmea& nmea) {
  constexpr std::uint8_t kExcludesIt = kNmeaCompatible | kNmeaLimit82;
  return (nmea.flags & kNmeaHighPrecision) == 0 || (nmea.flags & kExcludesIt) == 0;
}

}  // namespace

UbloxKeyStore::UbloxKeyStore(const UbloxProfile& profile, const UbloxConfigurationState& defaults)
    : profile_(&profile),
      defaults_(defaults),
      map_(profile),
      backup_(configuration_keys().size()),
      flash_(configuration_keys().size()),
      staged_(configuration_keys().size()),
      uart1_enabled_(key_index("CFG-UART1-ENABLED")) {
  for (const ConfigurationKey& key : configuration_keys()) {
    others_.push_back(key.initial);
  }
  candidate_ = others_;
}

void UbloxKeyStore::clear(Layer& layer) {
  std::ranges::fill(layer, std::nullopt);
}

bool UbloxKeyStore::handles(MessageId id) {
  return id == kCfgValset || id == kCfgValget || id == kCfgValdel || id == CfgCfg::kId;
}

bool UbloxKeyStore::is_poll(const FrameView& frame) {
  return frame.id == kCfgValget;
}

std::optional<std::uint64_t> UbloxKeyStore::value(const UbloxConfigurationState& present,
                                                  std::uint8_t layer, std::size_t index) const {
  switch (layer) {
    case kLayerRam:
      return map_.bound(index) ? map_.read(present, index) : others_[index];
    case kLayerBattery:
      return backup_[index];
    case kLayerFlash:
      return flash_[index];
    case kLayerDefault:
      return map_.bound(index) ? map_.read(defaults_, index) : configuration_keys()[index].initial;
    default:
      return std::nullopt;
  }
}

std::size_t UbloxKeyStore::poll(const UbloxConfigurationState& present, const FrameView& frame,
                                std::span<std::uint8_t> out) {
  interrupt();
  const auto query = decode_valget(frame);
  if (!query.ok() || (query->layer > kLayerFlash && query->layer != kLayerDefault)) {
    return 0;
  }
  KeyListWriter writer(out);
  writer.head(1, query->layer, query->position);
  std::size_t found = 0;
  KeyReader reader(query->list);
  const auto keys = configuration_keys();
  while (const auto key = reader.next()) {
    bool known = false;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (!names(*key, keys[i].id)) {
        continue;
      }
      known = true;
      const auto found_value = value(present, query->layer, i);
      if (found_value && found++ >= query->position &&
          found <= query->position + kMaximumConfigurationItems) {
        writer.value({keys[i].id, *found_value});
      }
    }
    if (!known) {
      return 0;
    }
  }
  return query->count > 0 && found == 0 ? 0 : writer.payload().size();
}

bool UbloxKeyStore::set(UbloxConfigurationState& present, const FrameView& frame) {
  if (frame.id == CfgCfg::kId) {
    interrupt();
    return set_store(present, frame.payload);
  }
  const Action action = frame.id == kCfgValset ? Action::set : Action::remove;
  const auto wanted = action == Action::set ? decode_valset(frame) : decode_valdel(frame);
  if (!wanted.ok() || !change(present, action, *wanted)) {
    interrupt();
    return false;
  }
  return true;
}

bool UbloxKeyStore::change(UbloxConfigurationState& present, Action action,
                           const KeyChange& change) {
  const std::uint8_t layers = change.layers & (action == Action::set ? kAllLayers : kSavedLayers);
  if (layers == 0) {
    return false;
  }
  const bool continues = open_ && open_->action == action && open_->layers == layers;
  switch (change.transaction) {
    case Transaction::none:
      interrupt();
      clear(staged_);
      return stage(action, change.list) && apply(present, action, layers);
    case Transaction::start:
      clear(staged_);
      open_ = Open{action, layers};
      return stage(action, change.list);
    case Transaction::ongoing:
      return continues && change.count > 0 && stage(action, change.list);
    case Transaction::apply:
      interrupt();
      return continues && apply(present, action, layers);
  }
  return false;
}

bool UbloxKeyStore::stage(Action action, Payload list) {
  if (action == Action::set) {
    KeyValueReader reader(list);
    while (const auto pair = reader.next()) {
      const std::size_t index = key_index(pair->key);
      if (index == staged_.size() || !is_allowed(configuration_keys()[index], pair->value)) {
        return false;
      }
      staged_[index] = pair->value;
    }
    return true;
  }
  KeyReader reader(list);
  const auto keys = configuration_keys();
  while (const auto key = reader.next()) {
    bool known = false;
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (names(*key, keys[i].id)) {
        staged_[i] = 0;
        known = true;
      }
    }
    if (!known) {
      return false;
    }
  }
  return true;
}

bool UbloxKeyStore::apply(UbloxConfigurationState& present, Action action, std::uint8_t layers) {
  if ((layers & kLayerMaskRam) != 0 && !apply_to_ram(present)) {
    return false;
  }
  const auto write = [&](Layer& layer) {
    for (std::size_t i = 0; i < staged_.size(); ++i) {
      if (staged_[i]) {
        layer[i] = action == Action::set ? staged_[i] : std::nullopt;
      }
    }
  };
  if ((layers & kLayerMaskBattery) != 0) write(backup_);
  if ((layers & kLayerMaskFlash) != 0) write(flash_);
  return true;
}

bool UbloxKeyStore::apply_to_ram(UbloxConfigurationState& present) {
  UbloxConfigurationState state = present;
  candidate_ = others_;
  for (std::size_t i = 0; i < staged_.size(); ++i) {
    if (!staged_[i]) {
      continue;
    }
    if (map_.bound(i)) {
      map_.write(state, i, *staged_[i]);
    } else {
      candidate_[i] = *staged_[i];
    }
  }
  if (!can_be_honoured(state, candidate_)) {
    return false;
  }
  present = state;
  others_ = candidate_;
  return true;
}

bool UbloxKeyStore::can_be_honoured(const UbloxConfigurationState& state,
                                    const Values& others) const {
  return line_is_sound(*profile_, state.ports[kPortUart1]) && others[uart1_enabled_] != 0 &&
         std::chrono::milliseconds{state.rate.measurement_period_ms} >= profile_->shortest_period &&
         systems_are_sound(std::span(state.systems).first(profile_->systems.size())) &&
         sentences_are_sound(state.nmea) &&
         state.navx5.minimum_satellites <= state.navx5.maximum_satellites;
}

void UbloxKeyStore::reload(UbloxConfigurationState& present) {
  interrupt();
  present = defaults_;
  for (std::size_t i = 0; i < others_.size(); ++i) {
    others_[i] = configuration_keys()[i].initial;
    staged_[i] = backup_[i] ? backup_[i] : flash_[i];
  }
  // Saved items that cannot be honoured together leave the defaults in force.
  static_cast<void>(apply_to_ram(present));
}

bool UbloxKeyStore::set_store(UbloxConfigurationState& present, Payload payload) {
  constexpr std::uint8_t kBackupDevice = 0x01;
  constexpr std::uint8_t kFlashDevice = 0x02;
  if (payload.size() != CfgCfg::kLength && payload.size() != CfgCfg::kLength + 1 /*devices*/) {
    return false;
  }
  const auto masks = read_payload<CfgCfg>(payload);
  const std::uint8_t devices = payload.size() > CfgCfg::kLength
                                   ? payload[CfgCfg::kLength]
                                   : std::uint8_t{kBackupDevice | kFlashDevice};
  const bool changes = masks.clear_mask != 0 || masks.save_mask != 0;
  if (changes && (devices & (kBackupDevice | kFlashDevice)) == 0) {
    return false;  // memory that a receiver of this type does not have
  }
  for (const auto& [layer, device] :
       {std::pair{&backup_, kBackupDevice}, std::pair{&flash_, kFlashDevice}}) {
    if ((devices & device) == 0) {
      continue;
    }
    if (masks.clear_mask != 0) {
      clear(*layer);
    }
    if (masks.save_mask != 0) {
      for (std::size_t i = 0; i < layer->size(); ++i) {
        (*layer)[i] = value(present, kLayerRam, i);
      }
    }
  }
  if (masks.load_mask != 0) {
    reload(present);
  }
  return true;
}

}  // namespace rigwire::emulators
