// What a node's dictionary lets a client read and write: access, lengths, limits, and the rules
// that CiA 301, 7.5.2, gives the communication objects.
#include <algorithm>

#include "emulators/canopen/canopen_node.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
namespace object = protocols::canopen::object;
using canopen::ObjectAddress;
using canopen::SdoAbort;
using Refusal = std::optional<SdoAbort>;

namespace {

constexpr std::uint16_t kPdoMask = 0xFF80;  // 128 PDOs of each kind

bool is_cob_id(ObjectAddress address) {
  return address == object::kEmergencyId || address == object::kSynchronisationId ||
         ((address.index & kPdoMask) == object::kTransmitPdo && address.sub == canopen::kPdoId);
}

bool same_identifier_bits(std::int64_t a, std::int64_t b) {
  constexpr std::int64_t kRest = ~static_cast<std::int64_t>(canopen::kCobInvalid);
  return ((a ^ b) & kRest) == 0;
}

bool valid(std::int64_t cob_id) {
  return (static_cast<std::uint32_t>(cob_id) & canopen::kCobInvalid) == 0;
}

}  // namespace

std::int64_t CanopenNode::number(ObjectAddress address) const {
  const auto live = profile_.live(address);
  return live ? *live : dictionary_.value(address);
}

Refusal CanopenNode::read(ObjectAddress address, SdoValue& value) const {
  const canopen::ObjectEntry* entry = dictionary_.find(address);
  if (entry == nullptr) {
    return dictionary_.has_object(address.index) ? SdoAbort::no_such_subindex
                                                 : SdoAbort::no_such_object;
  }
  if (address.index == object::kErrorField &&
      address.sub > dictionary_.value({object::kErrorField, 0})) {
    return SdoAbort::no_data;
  }
  if (entry->type == canopen::DataType::domain) {
    value.domain = {reinterpret_cast<const std::uint8_t*>(eds_.data()), eds_.size()};
    return std::nullopt;
  }
  if (entry->type == canopen::DataType::visible_string) {
    const std::string_view text = profile_.text(address).substr(0, SdoValue::kCapacity);
    std::copy(text.begin(), text.end(), value.bytes.begin());
    value.length = static_cast<std::uint8_t>(text.size());
    return std::nullopt;
  }
  const std::size_t bytes = canopen::size_of(entry->type);
  canopen::store(entry->type, std::span(value.bytes).first(bytes), number(address));
  value.length = static_cast<std::uint8_t>(bytes);
  return std::nullopt;
}

Refusal CanopenNode::write(SimTime now, ObjectAddress address, std::span<const std::uint8_t> data,
                           bool sized) {
  const canopen::ObjectEntry* entry = dictionary_.find(address);
  if (entry == nullptr) {
    return dictionary_.has_object(address.index) ? SdoAbort::no_such_subindex
                                                 : SdoAbort::no_such_object;
  }
  if (entry->access != canopen::Access::read_write) {
    return SdoAbort::write_of_read_only;
  }
  const std::size_t bytes = canopen::size_of(entry->type);
  if (data.size() < bytes) {
    return SdoAbort::too_short;
  }
  if (data.size() > bytes && sized) {
    return SdoAbort::too_long;
  }
  const std::int64_t value = canopen::load(entry->type, data.first(bytes));
  if (address.index == object::kStore || address.index == object::kRestore) {
    return command(address, value);
  }
  if (entry->lower == entry->upper && value != entry->upper) {
    return SdoAbort::value_range;  // 1003:0 (CiA 301, object 1003)
  }
  if (value > entry->upper) {
    return SdoAbort::value_too_high;
  }
  if (value < entry->lower) {
    return SdoAbort::value_too_low;
  }
  if (const auto refusal = check(address, value)) {
    return refusal;
  }
  std::array<std::int64_t, canopen::kTransmitPdos> timers{};
  for (std::size_t i = 0; i < timers.size(); ++i) {
    timers[i] = pdo_parameter(i, canopen::kPdoEventTimer_ms);
  }
  if (const auto refusal = profile_.write(address, value)) {
    return refusal;
  }
  dictionary_.set(address, value);
  if (address == object::kHeartbeatTime) {
    heartbeat_ = value > 0 ? now + value * std::chrono::milliseconds{1} : kNever;
  }
  // The profile may set a timer by an object of its own.
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (address.index == object::kTransmitPdo + i ||
        timers[i] != pdo_parameter(i, canopen::kPdoEventTimer_ms)) {
      start_timer(now, i);
    }
  }
  return std::nullopt;
}

Refusal CanopenNode::command(ObjectAddress address, std::int64_t value) {
  const bool save = address.index == object::kStore;
  if (value != (save ? canopen::kSaveSignature : canopen::kLoadSignature)) {
    return SdoAbort::cannot_store;
  }
  if (save) {
    restore_ = false;
    return remember(remembered().node_id, dictionary_.saved()) ? Refusal{} : SdoAbort::cannot_store;
  }
  // Valid after the next reset; what was saved is gone. The node-ID is no parameter of 1011.
  restore_ = true;
  return remember(remembered().node_id, {}) ? Refusal{} : SdoAbort::cannot_store;
}

Refusal CanopenNode::check(ObjectAddress address, std::int64_t value) const {
  if (is_cob_id(address)) {
    const std::int64_t old = dictionary_.value(address);
    const bool extended = (static_cast<std::uint32_t>(value) & canopen::kCobExtended) != 0;
    const bool moved = valid(old) && valid(value) && !same_identifier_bits(old, value);
    if (extended || (moved && address != object::kSynchronisationId)) {
      return SdoAbort::value_range;
    }
  }
  if ((address.index & kPdoMask) == object::kTransmitPdo) {
    return check_pdo(address, value);
  }
  if ((address.index & kPdoMask) == object::kTransmitMapping) {
    return check_mapping(address, value);
  }
  return std::nullopt;
}

Refusal CanopenNode::check_pdo(ObjectAddress address, std::int64_t value) const {
  if (address.sub == canopen::kPdoType && value > canopen::kGreatestSynchronous &&
      value < canopen::kOnChange) {
    return SdoAbort::value_range;
  }
  if (address.sub == canopen::kPdoInhibit_100us &&
      valid(dictionary_.value({address.index, canopen::kPdoId}))) {
    return SdoAbort::not_in_this_state;
  }
  return std::nullopt;
}

Refusal CanopenNode::check_mapping(ObjectAddress address, std::int64_t value) const {
  const auto pdo =
      static_cast<std::uint16_t>(address.index - object::kTransmitMapping + object::kTransmitPdo);
  const bool exists = valid(dictionary_.value({pdo, canopen::kPdoId}));
  if (exists || (address.sub > 0 && dictionary_.value({address.index, 0}) != 0)) {
    return SdoAbort::not_in_this_state;
  }
  const auto mapped = [this](std::int64_t word) {
    const auto bits = static_cast<std::uint32_t>(word);
    const canopen::ObjectEntry* entry = dictionary_.find(
        {static_cast<std::uint16_t>(bits >> 16U), static_cast<std::uint8_t>((bits >> 8U) & 0xFFU)});
    const bool fits = entry != nullptr && entry->has(canopen::EntryFlag::kMappable) &&
                      canopen::mapping_of(*entry) == bits;
    return fits ? entry : nullptr;
  };
  if (address.sub > 0) {
    return value == 0 || mapped(value) != nullptr ? Refusal{} : SdoAbort::not_mappable;
  }
  std::size_t bytes = 0;
  for (std::int64_t i = 1; i <= value; ++i) {
    const canopen::ObjectEntry* entry =
        mapped(dictionary_.value({address.index, static_cast<std::uint8_t>(i)}));
    if (entry == nullptr) {
      return SdoAbort::not_mappable;
    }
    bytes += canopen::size_of(entry->type);
  }
  return bytes <= 8 ? Refusal{} : SdoAbort::mapping_too_long;
}

}  // namespace rigwire::emulators
