// What a client sets in an OpenIMU, and what it makes it do.
#include "emulators/openimu/openimu335ri.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;
using openimu::Command;
using protocols::can::Frame;

namespace {

/// From the answer to the restart.
constexpr Duration kRestartDelay = std::chrono::milliseconds{50};

}  // namespace

void OpenImu::receive_setting(SimTime now, const Frame& frame) {
  const auto setting = openimu::decode_setting(frame, configuration_.commands);
  if (!setting.ok()) {
    ++received_.malformed;
    return;
  }
  const bool meant = address_.held() && setting->address == address_.address();
  const bool taken = meant && apply(now, *setting, j1939::identify(frame)->source);
  ++(taken ? received_.accepted : received_.ignored);
}

void OpenImu::receive_bank(std::uint32_t pgn, std::span<const std::uint8_t> payload) {
  constexpr std::size_t kBankBytes = 8;
  if (payload.size() != kBankBytes) {
    ++received_.malformed;
    return;
  }
  const bool meant = address_.held() && payload[0] == address_.address();
  const bool taken =
      meant && openimu::apply_bank(configuration_.commands, pgn, payload.subspan(1), is_300());
  ++(taken ? received_.accepted : received_.ignored);
}

bool OpenImu::apply(SimTime now, const openimu::Setting& setting, std::uint8_t requester) {
  switch (setting.kind) {
    case Command::reset_algorithm:
    case Command::save_configuration:
      return apply_command(now, setting, requester);
    case Command::packet_rate:
      if (!openimu::is_rate_divider(setting.first)) {
        return false;
      }
      configuration_.rate_divider = setting.first;
      return true;
    case Command::packet_mask:
      configuration_.packet_mask =
          static_cast<std::uint16_t>(setting.word & packets_of(settings_.variant));
      if (!is_300()) {
        apply_priorities(setting);
      }
      return true;
    case Command::filters:
      if (!openimu::is_cut_off(setting.first) || !openimu::is_cut_off(setting.second)) {
        return false;
      }
      configuration_.rate_cut_off_hz = setting.first;
      configuration_.acceleration_cut_off_hz = setting.second;
      rebuild_filters();
      return true;
    case Command::orientation:
      if (!openimu::orientation_axes(setting.word)) {
        return false;
      }
      configuration_.orientation = setting.word;
      rebuild_filters();
      tilt_.reset();
      return true;
    case Command::behaviour:
      apply_behaviour(setting);
      return true;
    case Command::trouble_code:
      if (is_300()) {
        return false;
      }
      configuration_.trouble = {setting.more[0], setting.more[1],
                                (setting.more[2] | (std::uint32_t{setting.more[3]} << 8U) |
                                 (std::uint32_t{setting.more[4]} << 16U)) &
                                    0x7FFFFU,
                                setting.more[5], setting.more[6]};
      return true;
    case Command::magnetic_alignment:
      if (!is_300()) {
        return false;
      }
      // No alignment takes place: always idle, nothing estimated.
      send(now, openimu::make_alignment_answer({.command = setting.first}, address_.address(),
                                               configuration_.commands));
      return true;
    default:
      return false;
  }
}

bool OpenImu::apply_command(SimTime now, const openimu::Setting& setting, std::uint8_t requester) {
  const bool restarts = setting.first != 0;
  if (restarts && is_300()) {
    return false;
  }
  bool done = true;
  if (setting.kind == Command::reset_algorithm) {
    tilt_.reset();
  } else {
    saved_.configuration = configuration_;
    saved_.address = new_address_.value_or(saved_.address);
    done = remember();
  }
  send(now, openimu::make_outcome(setting.kind, address_.address(), requester, done,
                                  configuration_.commands));
  if (restarts) {
    restart_ = now + kRestartDelay;
  }
  return true;
}

void OpenImu::apply_priorities(const openimu::Setting& setting) {
  const auto take = [&setting](std::uint8_t& priority, unsigned position) {
    constexpr unsigned kMeant = 3;
    if (((setting.second >> position) & kMeant) == kMeant) {
      priority = static_cast<std::uint8_t>((setting.first >> position) & 3U);
    }
  };
  take(configuration_.rate_priority, 0);
  take(configuration_.acceleration_priority, 2);
  take(configuration_.slope_priority, 4);
}

void OpenImu::apply_behaviour(const openimu::Setting& setting) {
  unsigned word = setting.word;
  if (!is_300()) {
    const unsigned cleared = setting.more[0] | (static_cast<unsigned>(setting.more[1]) << 8U);
    word = (configuration_.behaviour | setting.word) & ~cleared;
    const std::uint8_t address = setting.more[2];
    if (address >= kFirstArbitraryAddress && address <= kLastArbitraryAddress) {
      new_address_ = address;
    }
  }
  configuration_.behaviour = static_cast<std::uint16_t>(
      (word & kChangeableBehaviour) | (openimu::Behaviour::kDefault & ~kChangeableBehaviour));
}

}  // namespace rigwire::emulators
