#include "emulators/canopen/canopen_node.h"

#include <algorithm>
#include <string>

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
namespace object = protocols::canopen::object;
using canopen::NetworkCommand;
using canopen::NodeState;
using canopen::ObjectAddress;
using canopen::SdoAbort;
using protocols::can::Frame;
using Abort = std::optional<SdoAbort>;

namespace {

constexpr std::uint16_t kLastCommunicationIndex = 0x1FFF;
constexpr std::uint16_t kLastIndex = 0xFFFF;
constexpr Duration kMillisecond = std::chrono::milliseconds{1};
constexpr Duration kInhibitUnit = std::chrono::microseconds{100};

constexpr std::uint32_t kMark = 0x32504F43;  // "COP2"

bool on_event(std::int64_t type) {
  return type == canopen::kOnChange || type == canopen::kOnTimer;
}

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

CanopenNode::CanopenNode(const CanopenNodeSettings& settings, ObjectDictionary& dictionary,
                         CanopenProfile& profile, NonvolatileMemory& memory, FrameOutput& output)
    : settings_(settings),
      dictionary_(dictionary),
      profile_(profile),
      memory_(memory),
      output_(output),
      node_id_(settings.node_id) {}

void CanopenNode::describe(const std::string& file, const std::string& description,
                           const std::string& vendor_name) {
  canopen::EdsDevice device{file, description, vendor_name,
                            std::string(profile_.text(object::kDeviceName))};
  const canopen::LssIdentity numbers = identity();
  device.vendor = numbers[0];
  device.product = numbers[1];
  device.revision = numbers[2];
  eds_ = canopen::make_eds(device, dictionary_.table(), [this](const canopen::ObjectEntry& entry) {
    if (canopen::size_of(entry.type) != 0) {
      return dictionary_.delivered_text(entry);
    }
    return std::string(entry.type == canopen::DataType::domain ? std::string_view{}
                                                               : profile_.text(entry.address));
  });
}

canopen::LssIdentity CanopenNode::identity() const {
  canopen::LssIdentity numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = static_cast<std::uint32_t>(dictionary_.value(
        {object::kVendor.index, static_cast<std::uint8_t>(object::kVendor.sub + i)}));
  }
  return numbers;
}

CanopenNode::Remembered CanopenNode::remembered() const {
  const auto content = unseal(kMark, memory_.content());
  if (!content || content->empty()) {
    return {0, memory_.content()};  // parameters alone, as before there was LSS; else of no use
  }
  return {content->front(), content->subspan(1)};
}

bool CanopenNode::remember(std::uint8_t node_id, std::span<const std::uint8_t> parameters) {
  std::vector<std::uint8_t> content{node_id};
  content.insert(content.end(), parameters.begin(), parameters.end());
  return memory_.store(seal(kMark, content));
}

bool CanopenNode::store_node_id(std::uint8_t node_id) {
  return remember(node_id, remembered().parameters);
}

void CanopenNode::power(SimTime now, bool on) {
  powered_ = on;
  silent_until_ = now;
  if (on) {
    reset(now, kLastIndex);
  } else {
    state_ = NodeState::initialising;
    boot_ = heartbeat_ = kNever;
    pdos_ = {};
  }
}

void CanopenNode::reset_communication(SimTime now) {
  reset(now, kLastCommunicationIndex);
}

void CanopenNode::reset(SimTime now, std::uint16_t last_index) {
  const Remembered kept = remembered();
  lss_.restart(last_index != kLastIndex ? lss_.pending_node_id()
               : kept.node_id == 0      ? settings_.node_id
                                        : kept.node_id);
  node_id_ = lss_.pending_node_id();
  dictionary_.set_node_id(node_id_);
  const std::uint16_t first = last_index == kLastCommunicationIndex ? 0x1000 : 0;
  dictionary_.load(restore_ ? std::span<const std::uint8_t>{} : kept.parameters, first, last_index);
  server_.reset();
  pdos_ = {};
  state_ = NodeState::initialising;
  heartbeat_ = kNever;
  boot_ = now + settings_.boot;
}

SimTime CanopenNode::next_event() const {
  SimTime next = std::min(boot_, heartbeat_);
  for (const Pdo& pdo : pdos_) {
    next = std::min(next, pdo.timer);
    if (pdo.pending) {
      next = std::min(next, pdo.allowed);
    }
  }
  return next;
}

void CanopenNode::advance(SimTime now) {
  for (SimTime instant = next_event(); instant <= now; instant = next_event()) {
    if (boot_ == instant) {
      boot_ = kNever;
      if (node_id_ == canopen::kNoNodeId) {
        continue;
      }
      send(instant, canopen::make_heartbeat(node_id_, NodeState::initialising));
      enter(instant, settings_.starts_itself ? NodeState::operational : NodeState::pre_operational);
      const std::int64_t period = dictionary_.value(object::kHeartbeatTime);
      heartbeat_ = period > 0 ? instant + period * kMillisecond : kNever;
      continue;
    }
    if (heartbeat_ == instant) {
      heartbeat_ += dictionary_.value(object::kHeartbeatTime) * kMillisecond;
      send(instant, canopen::make_heartbeat(node_id_, state_));
      continue;
    }
    for (std::size_t i = 0; i < pdos_.size(); ++i) {
      Pdo& pdo = pdos_[i];
      if (pdo.timer == instant || (pdo.pending && pdo.allowed <= instant)) {
        if (pdo.timer == instant) {
          start_timer(instant, i);
        }
        send_pdo(instant, i);
      }
    }
  }
}

void CanopenNode::enter(SimTime now, NodeState state) {
  const bool starts = state == NodeState::operational && state_ != NodeState::operational;
  state_ = state;
  if (state == NodeState::stopped) {
    server_.reset();
  }
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    if (state != NodeState::operational) {
      pdos_[i] = {};
    } else if (starts && on_event(pdo_parameter(i, canopen::kPdoType))) {
      start_timer(now, i);
      send_pdo(now, i);
    }
  }
}

void CanopenNode::start_timer(SimTime now, std::size_t pdo) {
  const std::int64_t period = pdo_parameter(pdo, canopen::kPdoEventTimer_ms);
  const bool runs = state_ == NodeState::operational && period > 0 &&
                    on_event(pdo_parameter(pdo, canopen::kPdoType));
  pdos_[pdo].timer = runs ? now + period * kMillisecond : kNever;
}

std::int64_t CanopenNode::pdo_parameter(std::size_t pdo, std::uint8_t sub) const {
  return dictionary_.value({static_cast<std::uint16_t>(object::kTransmitPdo + pdo), sub});
}

void CanopenNode::obey(SimTime now, NetworkCommand command) {
  switch (command) {
    case NetworkCommand::start:
      enter(now, NodeState::operational);
      break;
    case NetworkCommand::stop:
      enter(now, NodeState::stopped);
      break;
    case NetworkCommand::enter_pre_operational:
      enter(now, NodeState::pre_operational);
      break;
    case NetworkCommand::reset_node:
      reset(now, kLastIndex);
      break;
    case NetworkCommand::reset_communication:
      reset(now, kLastCommunicationIndex);
      break;
  }
}

void CanopenNode::receive(SimTime now, const Frame& frame) {
  advance(now);
  received_.bytes += frame.length <= 8 ? frame.payload().size() : 0U;
  if (frame.length > 8) {
    ++received_.malformed;
    return;
  }
  if (!powered_ || boot_ != kNever || frame.extended) {
    ++received_.ignored;
    return;
  }
  if (frame.id == canopen::kLssRequestId && !frame.remote) {
    const bool complete = frame.payload().size() == canopen::kLssBytes;
    ++(complete ? received_.accepted : received_.malformed);
    if (const auto answer = lss_.receive(now, frame.payload(), *this)) {
      send(now, canopen::make_frame(canopen::kLssAnswerId, *answer));
    }
    return;
  }
  if (node_id_ == canopen::kNoNodeId) {
    ++received_.ignored;
    return;
  }
  const std::uint32_t node = node_id_;
  if (frame.id == canopen::kHeartbeatBase + node || frame.id == canopen::kSdoAnswerBase + node) {
    ++duplicates_;
    ++received_.ignored;
  } else if (frame.id == canopen::kNetworkManagementId) {
    const auto request = canopen::decode_network_request(frame);
    if (!request) {
      ++received_.malformed;
    } else if (request->node_id == canopen::kAllNodes || request->node_id == node) {
      ++received_.accepted;
      obey(now, request->command);
    } else {
      ++received_.ignored;
    }
  } else if (frame.id ==
                 static_cast<std::uint32_t>(dictionary_.value(object::kSynchronisationId)) &&
             !frame.remote) {
    ++received_.accepted;
    synchronise(now);
  } else if (frame.id == canopen::kSdoRequestBase + node && state_ != NodeState::stopped) {
    const auto request = canopen::decode_sdo_request(frame.payload());
    if (frame.remote || !request.ok()) {
      ++received_.malformed;
      return;
    }
    ++received_.accepted;
    if (const auto answer = server_.answer(now, *request, *this)) {
      send(now, canopen::make_frame(canopen::kSdoAnswerBase + node, *answer));
    }
    changed(now);  // by what was written, after its answer
  } else {
    ++received_.ignored;
  }
}

void CanopenNode::synchronise(SimTime now) {
  if (state_ != NodeState::operational) {
    return;
  }
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    const std::int64_t type = pdo_parameter(i, canopen::kPdoType);
    Pdo& pdo = pdos_[i];
    if (type == canopen::kAcyclicSynchronous) {
      std::array<std::uint8_t, 8> payload{};
      if (fill(i, payload) != pdo.length || payload != pdo.sent) {
        send_pdo(now, i);
      }
    } else if (type <= canopen::kGreatestSynchronous && ++pdo.syncs >= type) {
      pdo.syncs = 0;
      send_pdo(now, i);
    }
  }
}

void CanopenNode::changed(SimTime now) {
  if (state_ != NodeState::operational) {
    return;
  }
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    std::array<std::uint8_t, 8> payload{};
    if (pdo_parameter(i, canopen::kPdoType) == canopen::kOnChange &&
        (fill(i, payload) != pdos_[i].length || payload != pdos_[i].sent)) {
      send_pdo(now, i);
    }
  }
}

std::uint8_t CanopenNode::fill(std::size_t pdo, std::array<std::uint8_t, 8>& payload) const {
  const auto mapping = static_cast<std::uint16_t>(object::kTransmitMapping + pdo);
  const std::int64_t entries = dictionary_.value({mapping, 0});
  std::size_t length = 0;
  for (std::uint8_t i = 1; i <= entries; ++i) {
    const auto word = static_cast<std::uint32_t>(dictionary_.value({mapping, i}));
    const ObjectAddress address{static_cast<std::uint16_t>(word >> 16U),
                                static_cast<std::uint8_t>((word >> 8U) & 0xFFU)};
    const canopen::ObjectEntry* entry = dictionary_.find(address);
    const std::size_t bytes = entry == nullptr ? 0 : canopen::size_of(entry->type);
    if (bytes == 0 || length + bytes > payload.size()) {
      break;
    }
    canopen::store(entry->type, std::span(payload).subspan(length, bytes), number(address));
    length += bytes;
  }
  return static_cast<std::uint8_t>(length);
}

void CanopenNode::send_pdo(SimTime now, std::size_t index) {
  const auto identifier = static_cast<std::uint32_t>(pdo_parameter(index, canopen::kPdoId));
  Pdo& pdo = pdos_[index];
  if ((identifier & canopen::kCobInvalid) != 0) {
    pdo.pending = false;
    return;
  }
  pdo.pending = now < pdo.allowed;
  if (pdo.pending || !pace_.has_time(now, static_cast<std::uint32_t>(index))) {
    return;
  }
  pdo.sent = {};
  pdo.length = fill(index, pdo.sent);
  pdo.allowed = now + pdo_parameter(index, canopen::kPdoInhibit_100us) * kInhibitUnit;
  send(now, canopen::make_frame(identifier, std::span(pdo.sent).first(pdo.length)));
}

void CanopenNode::report_error(SimTime now, std::uint16_t code, std::uint8_t error_register) {
  dictionary_.set(object::kErrorRegister, error_register);
  if (code != 0) {
    constexpr auto kEntries = static_cast<std::uint8_t>(canopen::kErrorFieldEntries);
    for (std::uint8_t sub = kEntries; sub > 1; --sub) {
      dictionary_.set({object::kErrorField, sub},
                      dictionary_.value({object::kErrorField, static_cast<std::uint8_t>(sub - 1)}));
    }
    dictionary_.set({object::kErrorField, 1}, code);
    const std::int64_t count = dictionary_.value({object::kErrorField, 0});
    dictionary_.set({object::kErrorField, 0}, std::min<std::int64_t>(count + 1, kEntries));
  }
  const auto identifier = static_cast<std::uint32_t>(dictionary_.value(object::kEmergencyId));
  const bool speaks = state_ == NodeState::operational || state_ == NodeState::pre_operational;
  if (speaks && (identifier & canopen::kCobInvalid) == 0) {
    send(now, canopen::make_emergency(identifier, {code, error_register, 0}));
  }
}

double CanopenNode::nominal_rate_hz() const {
  const auto rate = [](std::int64_t period_ms) {
    return period_ms > 0 ? 1e3 / static_cast<double>(period_ms) : 0.0;
  };
  double sum = rate(dictionary_.value(object::kHeartbeatTime));
  for (std::size_t i = 0; i < pdos_.size(); ++i) {
    const auto identifier = static_cast<std::uint32_t>(pdo_parameter(i, canopen::kPdoId));
    if ((identifier & canopen::kCobInvalid) == 0 && on_event(pdo_parameter(i, canopen::kPdoType))) {
      sum += rate(pdo_parameter(i, canopen::kPdoEventTimer_ms));
    }
  }
  return sum;
}

void CanopenNode::send(SimTime now, const Frame& frame) {
  if (now >= silent_until_) {
    output_.send(now + settings_.processing_delay, frame);
  }
}

// What a node's dictionary lets a client read and write: access, lengths, limits, and the rules
// that CiA 301, 7.5.2, gives the communication objects.

std::int64_t CanopenNode::number(ObjectAddress address) const {
  const auto live = profile_.live(address);
  return live ? *live : dictionary_.value(address);
}

Abort CanopenNode::read(ObjectAddress address, SdoValue& value) const {
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

Abort CanopenNode::write(SimTime now, ObjectAddress address, std::span<const std::uint8_t> data,
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
  if (refusal_.holds(now)) {
    return SdoAbort::not_in_this_state;
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

std::string_view CanopenNode::configure(SimTime now, ObjectAddress address, std::int64_t value) {
  if (!powered_ || boot_ != kNever || state_ == NodeState::stopped) {
    return "it has no supply, boots or is stopped";
  }
  const canopen::DataType type = dictionary_.find(address)->type;
  std::array<std::uint8_t, 4> bytes{};
  const std::span<std::uint8_t> written = std::span(bytes).first(canopen::size_of(type));
  canopen::store(type, written, value);
  return write(now, address, written, true) ? "it aborts the SDO" : "";
}

Abort CanopenNode::command(ObjectAddress address, std::int64_t value) {
  const bool save = address.index == object::kStore;
  if (value != (save ? canopen::kSaveSignature : canopen::kLoadSignature)) {
    return SdoAbort::cannot_store;
  }
  if (save) {
    restore_ = false;
    return remember(remembered().node_id, dictionary_.saved()) ? Abort{} : SdoAbort::cannot_store;
  }
  // Valid after the next reset; what was saved is gone. The node-ID is no parameter of 1011.
  restore_ = true;
  return remember(remembered().node_id, {}) ? Abort{} : SdoAbort::cannot_store;
}

Abort CanopenNode::check(ObjectAddress address, std::int64_t value) const {
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

Abort CanopenNode::check_pdo(ObjectAddress address, std::int64_t value) const {
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

Abort CanopenNode::check_mapping(ObjectAddress address, std::int64_t value) const {
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
    return value == 0 || mapped(value) != nullptr ? Abort{} : SdoAbort::not_mappable;
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
  return bytes <= 8 ? Abort{} : SdoAbort::mapping_too_long;
}

}  // namespace rigwire::emulators
