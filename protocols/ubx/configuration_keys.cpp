#include "protocols/ubx/configuration_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

namespace rigwire::protocols::ubx {
namespace {

constexpr std::array<std::string_view, kMessageRatePorts> kPortSuffixes{"_I2C", "_UART1", "_UART2",
                                                                        "_USB", "_SPI"};

/// All rows in one, with the names of the message rates spelled out.
class Table {
 public:
  Table() {
    for (const auto rows :
         {detail::interface_keys(), detail::navigation_keys(), detail::base_station_keys()}) {
      keys_.insert(keys_.end(), rows.begin(), rows.end());
    }
    names_.reserve(message_rate_keys().size() * kMessageRatePorts);
    for (const MessageRateKeys& message : message_rate_keys()) {
      for (std::uint32_t port = 0; port < kMessageRatePorts; ++port) {
        names_.push_back(
            std::string("CFG-MSGOUT-").append(message.name).append(kPortSuffixes[port]));
        keys_.push_back({message.first + port,
                         KeyType::u1,
                         names_.back(),
                         message.initial,
                         0,
                         0xFF,
                         0,
                         1.0,
                         {}});
      }
    }
    std::ranges::sort(keys_, {}, &ConfigurationKey::id);
  }
  [[nodiscard]] const std::vector<ConfigurationKey>& keys() const { return keys_; }

 private:
  std::vector<std::string> names_;
  std::vector<ConfigurationKey> keys_;
};

std::int64_t signed_value(KeyType type, std::uint64_t value) {
  switch (type) {
    case KeyType::i1:
      return std::bit_cast<std::int8_t>(static_cast<std::uint8_t>(value));
    case KeyType::i2:
      return std::bit_cast<std::int16_t>(static_cast<std::uint16_t>(value));
    case KeyType::i4:
      return std::bit_cast<std::int32_t>(static_cast<std::uint32_t>(value));
    default:
      return static_cast<std::int64_t>(value);
  }
}

}  // namespace

bool is_allowed(const ConfigurationKey& key, std::uint64_t value) {
  switch (key.type) {
    case KeyType::r4:
      return std::isfinite(std::bit_cast<float>(static_cast<std::uint32_t>(value)));
    case KeyType::r8:
      return std::isfinite(std::bit_cast<double>(value));
    case KeyType::x8:
      return true;
    default:
      break;
  }
  const std::int64_t number = signed_value(key.type, value);
  return number >= key.lower && number <= key.upper &&
         (key.choices == 0 || (key.choices >> static_cast<unsigned>(number) & 1U) != 0);
}

std::span<const ConfigurationKey> configuration_keys() {
  static const Table kTable;
  return kTable.keys();
}

std::size_t key_index(std::uint32_t id) {
  const auto keys = configuration_keys();
  const auto found = std::ranges::lower_bound(keys, id, {}, &ConfigurationKey::id);
  return found != keys.end() && found->id == id ? static_cast<std::size_t>(found - keys.begin())
                                                : keys.size();
}

std::size_t key_index(std::string_view name) {
  const auto keys = configuration_keys();
  return static_cast<std::size_t>(std::ranges::find(keys, name, &ConfigurationKey::name) -
                                  keys.begin());
}

}  // namespace rigwire::protocols::ubx
