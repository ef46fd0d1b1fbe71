#include "emulators/gige_camera/register_bank.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "protocols/bytes.h"

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;
using gev::Access;
using gev::Status;
using protocols::load_big;
using protocols::store_big;

constexpr std::size_t kLongestString = 512;

std::uint32_t begin_of(const BankRegister& target) {
  return target.row.address;
}

/// The integer in a register of four or eight bytes.
std::int64_t integer(std::span<const std::uint8_t> bytes) {
  return bytes.size() == 8 ? load_big<std::int64_t>(bytes, 0)
                           : std::int64_t{load_big<std::uint32_t>(bytes, 0)};
}

bool divides(std::int64_t value, const gev::IntegerFeature& kind) {
  return (value - kind.minimum) % kind.increment == 0;
}

}  // namespace

RegisterBank::RegisterBank(std::vector<gev::Feature> features, std::string description,
                           std::uint32_t description_address)
    : features_(std::move(features)),
      description_(std::move(description)),
      description_address_(description_address) {
  for (const gev::RegisterRow& row : gev::kBootstrapRegisters) {
    add({row, nullptr, 0, 0});
  }
  for (const gev::FeatureRegister& own : gev::feature_registers(features_)) {
    add({own.row, &features_[own.feature], own.selected, 0});
  }
  std::ranges::sort(registers_, {}, begin_of);
}

void RegisterBank::add(const BankRegister& target) {
  registers_.push_back(target);
  registers_.back().offset = memory_.size();
  memory_.resize(memory_.size() + target.row.length);
}

const BankRegister* RegisterBank::covering(std::uint32_t address) const {
  auto after = std::ranges::upper_bound(registers_, address, {}, begin_of);
  if (after == registers_.begin()) {
    return nullptr;
  }
  --after;
  return address - after->row.address < after->row.length ? &*after : nullptr;
}

const BankRegister& RegisterBank::at(std::uint32_t address) const {
  const BankRegister* const target = covering(address);
  assert(target != nullptr && target->row.address == address);
  return *target;
}

std::span<std::uint8_t> RegisterBank::memory(const BankRegister& target) {
  return std::span(memory_).subspan(target.offset, target.row.length);
}
std::span<const std::uint8_t> RegisterBank::memory(const BankRegister& target) const {
  return std::span(memory_).subspan(target.offset, target.row.length);
}

std::uint32_t RegisterBank::word(std::uint32_t address) const {
  return load_big<std::uint32_t>(memory(at(address)), 0);
}
void RegisterBank::set_word(std::uint32_t address, std::uint32_t value) {
  store_big(memory(at(address)), 0, value);
}

double RegisterBank::real(std::uint32_t address) const {
  return std::bit_cast<double>(load_big<std::uint64_t>(memory(at(address)), 0));
}
void RegisterBank::set_real(std::uint32_t address, double value) {
  store_big(memory(at(address)), 0, std::bit_cast<std::uint64_t>(value));
}

std::string_view RegisterBank::text(std::uint32_t address) const {
  const std::span<const std::uint8_t> bytes = memory(at(address));
  const auto end = std::ranges::find(bytes, std::uint8_t{0});
  return {reinterpret_cast<const char*>(bytes.data()),
          static_cast<std::size_t>(end - bytes.begin())};
}
void RegisterBank::set_text(std::uint32_t address, std::string_view text) {
  const std::span<std::uint8_t> bytes = memory(at(address));
  std::ranges::fill(bytes, std::uint8_t{0});
  std::ranges::copy(text.substr(0, bytes.size() - 1), bytes.begin());
}

Status RegisterBank::read(std::uint32_t address, std::span<std::uint8_t> out,
                          RegisterOwner& owner) {
  // The description is one block; no register lies at or above its address.
  if (address >= description_address_) {
    const std::size_t from = address - description_address_;
    if (from > description_.size() || out.size() > description_.size() - from) {
      return Status::invalid_address;
    }
    std::copy_n(description_.begin() + static_cast<std::ptrdiff_t>(from), out.size(), out.begin());
    return Status::success;
  }
  for (std::size_t done = 0; done < out.size();) {
    const auto here = static_cast<std::uint32_t>(address + done);
    const BankRegister* const target = covering(here);
    if (target == nullptr) {
      if (here >= gev::kDiscoverySize) {
        return Status::invalid_address;
      }
      std::ranges::fill(out.subspan(done, 4), std::uint8_t{0});
      done += 4;
      continue;
    }
    if (target->row.access == Access::write_only) {
      return Status::access_denied;
    }
    owner.refresh(*target);
    const std::span<const std::uint8_t> from = memory(*target).subspan(here - target->row.address);
    const std::size_t count = std::min(from.size(), out.size() - done);
    std::ranges::copy(from.first(count), out.subspan(done).begin());
    done += count;
  }
  return Status::success;
}

RegisterBank::Written RegisterBank::write(std::uint32_t address,
                                          std::span<const std::uint8_t> bytes,
                                          RegisterOwner& owner) {
  Written result;
  while (result.bytes < bytes.size()) {
    const auto here = static_cast<std::uint32_t>(address + result.bytes);
    const BankRegister* const target = covering(here);
    if (target == nullptr) {
      const bool described =
          here >= description_address_ && here - description_address_ < description_.size();
      result.status = described ? Status::write_protect : Status::invalid_address;
      return result;
    }
    if (target->row.access == Access::read_only) {
      result.status = Status::write_protect;
      return result;
    }
    // Strings may be written in pieces, numbers only as a whole.
    const std::size_t from = here - target->row.address;
    const std::size_t count = std::min(bytes.size() - result.bytes, target->row.length - from);
    const bool string = target->row.length > 8;
    if (!string && count != target->row.length) {
      result.status = Status::bad_alignment;
      return result;
    }
    std::array<std::uint8_t, kLongestString> former{};
    const std::span<std::uint8_t> place = memory(*target).subspan(from, count);
    std::ranges::copy(place, former.begin());
    std::ranges::copy(bytes.subspan(result.bytes, count), place.begin());
    result.status = check_value(*target, owner);
    if (!is_error(result.status)) {
      result.status = owner.written(*target);
    }
    if (is_error(result.status)) {
      std::copy_n(former.begin(), count, place.begin());
      return result;
    }
    result.bytes += count;
  }
  return result;
}

const BankRegister* RegisterBank::limit(std::string_view feature) const {
  if (feature.empty()) {
    return nullptr;
  }
  const auto found = std::ranges::find_if(registers_, [feature](const BankRegister& target) {
    return target.feature != nullptr && target.feature->name == feature;
  });
  assert(found != registers_.end());
  return &*found;
}

// Checks a written value against its feature: minimum, maximum (also one held by another register)
// and increment of an integer, range of a float, entries of an enumeration, 0 or 1 of a boolean,
// value of a command.
Status RegisterBank::check_value(const BankRegister& target, RegisterOwner& owner) {
  if (target.feature == nullptr) {
    return Status::success;
  }
  const std::span<const std::uint8_t> bytes = memory(target);
  const gev::FeatureKind& kind = target.feature->kind;
  bool allowed = true;
  if (const auto* const whole = std::get_if<gev::IntegerFeature>(&kind)) {
    std::int64_t maximum = whole->maximum;
    if (const BankRegister* const room = limit(whole->maximum_of)) {
      owner.refresh(*room);
      maximum = integer(memory(*room));
    }
    const std::int64_t value = integer(bytes);
    allowed = value >= whole->minimum && value <= maximum && divides(value, *whole);
  } else if (const auto* const number = std::get_if<gev::FloatFeature>(&kind)) {
    double maximum = number->maximum;
    if (const BankRegister* const room = limit(number->maximum_of)) {
      owner.refresh(*room);
      maximum = std::bit_cast<double>(load_big<std::uint64_t>(memory(*room), 0));
    }
    const auto value = std::bit_cast<double>(load_big<std::uint64_t>(bytes, 0));
    allowed = std::isfinite(value) && value >= number->minimum && value <= maximum;
  } else if (const auto* const choice = std::get_if<gev::EnumerationFeature>(&kind)) {
    allowed = std::ranges::find(choice->entries, integer(bytes), &gev::Entry::value) !=
              choice->entries.end();
  } else if (std::holds_alternative<gev::BooleanFeature>(kind)) {
    allowed = integer(bytes) == 0 || integer(bytes) == 1;
  } else if (const auto* const command = std::get_if<gev::CommandFeature>(&kind)) {
    allowed = integer(bytes) == command->value;
  }
  return allowed ? Status::success : Status::invalid_parameter;
}

}  // namespace rigwire::emulators
