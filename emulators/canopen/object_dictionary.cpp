#include "emulators/canopen/object_dictionary.h"

#include <array>
#include <cassert>
#include <cstdio>

#include "protocols/bytes.h"

namespace rigwire::emulators {

namespace canopen = protocols::canopen;
using canopen::EntryFlag;
using canopen::ObjectAddress;
using protocols::load_little;
using protocols::store_little;

namespace {

constexpr std::uint32_t kStoreMark = 0x31504F43;     // "COP1"
constexpr std::size_t kRecordBytes = 2 + 1 + 1 + 4;  // index, sub-index, type, value

}  // namespace

ObjectDictionary::ObjectDictionary(std::span<const canopen::ObjectEntry> table,
                                   std::uint8_t node_id)
    : table_(table), node_id_(node_id) {
  for (const canopen::ObjectEntry& entry : table) {
    delivered_.push_back(entry.initial + (entry.has(EntryFlag::kAddNodeId) ? node_id : 0));
  }
  values_ = delivered_;
}

std::size_t ObjectDictionary::row(ObjectAddress address) const {
  const canopen::ObjectEntry* entry = find(address);
  assert(entry != nullptr);
  return static_cast<std::size_t>(entry - table_.data());
}

void ObjectDictionary::set_node_id(std::uint8_t node_id) {
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (table_[i].has(EntryFlag::kAddNodeId)) {
      const bool follows = values_[i] == delivered_[i];
      delivered_[i] += node_id - node_id_;
      values_[i] = follows ? delivered_[i] : values_[i];
    }
  }
  node_id_ = node_id;
}

std::string ObjectDictionary::delivered_text(const canopen::ObjectEntry& entry) const {
  const std::int64_t value = delivered_[row(entry.address)];
  const bool added = entry.has(EntryFlag::kAddNodeId);
  std::array<char, 40> text{};
  if (canopen::is_signed(entry.type)) {
    std::snprintf(text.data(), text.size(), "%lld", static_cast<long long>(value));
  } else {
    std::snprintf(text.data(), text.size(), added ? "$NODEID+0x%llX" : "0x%llX",
                  static_cast<unsigned long long>(added ? value - node_id_ : value));
  }
  return text.data();
}

void ObjectDictionary::set_delivered(ObjectAddress address, std::int64_t value) {
  delivered_[row(address)] = value;
  values_[row(address)] = value;
}

std::vector<std::uint8_t> ObjectDictionary::saved() const {
  std::vector<std::uint8_t> content;
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const canopen::ObjectEntry& entry = table_[i];
    const bool follows = entry.has(EntryFlag::kAddNodeId) && values_[i] == delivered_[i];
    if (entry.has(EntryFlag::kStored) && !follows) {
      std::array<std::uint8_t, kRecordBytes> record{};
      store_little<std::uint16_t>(record, 0, entry.address.index);
      record[2] = entry.address.sub;
      record[3] = static_cast<std::uint8_t>(entry.type);
      store_little<std::uint32_t>(record, 4, static_cast<std::uint32_t>(values_[i]));
      content.insert(content.end(), record.begin(), record.end());
    }
  }
  return seal(kStoreMark, content);
}

void ObjectDictionary::load(std::span<const std::uint8_t> block, std::uint16_t first,
                            std::uint16_t last) {
  const auto wanted = [first, last](ObjectAddress address) {
    return address.index >= first && address.index <= last;
  };
  for (std::size_t i = 0; i < table_.size(); ++i) {
    if (wanted(table_[i].address)) {
      values_[i] = delivered_[i];
    }
  }
  const auto content = unseal(kStoreMark, block);
  if (!content || content->size() % kRecordBytes != 0) {
    return;
  }
  for (std::size_t at = 0; at < content->size(); at += kRecordBytes) {
    const auto record = content->subspan(at, kRecordBytes);
    const ObjectAddress address{load_little<std::uint16_t>(record, 0), record[2]};
    const canopen::ObjectEntry* entry = find(address);
    if (entry == nullptr || !wanted(address) || !entry->has(EntryFlag::kStored) ||
        record[3] != static_cast<std::uint8_t>(entry->type)) {
      continue;
    }
    const std::int64_t value =
        canopen::load(entry->type, record.subspan(4, canopen::size_of(entry->type)));
    const bool limited = entry->access == canopen::Access::read_write;
    if (!limited || (value >= entry->lower && value <= entry->upper)) {
      set(address, value);
    }
  }
}

}  // namespace rigwire::emulators
