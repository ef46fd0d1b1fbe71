#include "drivers/slcan_adapter.h"

#include <stdexcept>
#include <string>
#include <string_view>

namespace rigwire::drivers {

namespace slcan = protocols::slcan;
using slcan::Reply;
using slcan::ReplyKind;
using slcan::Verb;

namespace {

constexpr std::string_view kVersion = "V1013\r";  // hardware 1.0, software 1.3
constexpr std::string_view kDetailedVersion = "v1014\r";
constexpr std::string_view kSerialNumber = "NRW01\r";
/// Answers beyond this are dropped: a client that floods commands and reads nothing.
constexpr std::size_t kGreatestBacklog = 4096;

unsigned checked_rate(std::uint32_t bit_rate_bps) {
  const auto code = slcan::rate_code(bit_rate_bps);
  if (!code) {
    throw std::invalid_argument(
        "slcan: bit rate " + std::to_string(bit_rate_bps) +
        " bit/s has no code; allowed are 10000, 20000, 50000, 100000, 125000, 250000, 500000, "
        "800000, 1000000");
  }
  return *code;
}

std::span<const std::uint8_t> as_bytes(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

Reply plain(ReplyKind kind) {
  Reply reply;
  reply.kind = kind;
  return reply;
}

}  // namespace

SlcanAdapter::SlcanAdapter(ByteStream& line, std::uint32_t bit_rate_bps, Clock clock)
    : line_(line),
      bus_rate_code_(checked_rate(bit_rate_bps)),
      clock_(std::move(clock)),
      client_rate_code_(bus_rate_code_) {
  if (!clock_) {
    clock_ = [] {
      return std::chrono::duration_cast<std::chrono::milliseconds>(
          std::chrono::steady_clock::now().time_since_epoch());
    };
  }
  kept_.reserve(kGreatestBacklog);
}

void SlcanAdapter::start(Receiver receiver) {
  receiver_ = std::move(receiver);
  line_.start([this](std::span<const std::uint8_t> bytes) {
    flush();
    for (const std::uint8_t byte : bytes) {
      if (const auto line = splitter_.push(byte)) {
        take_line(*line);
      }
    }
  });
}

bool SlcanAdapter::send(const protocols::can::Frame& frame) {
  if (channel_ == Channel::closed) {
    return true;  // nobody listens
  }
  if (client_rate_code_ != bus_rate_code_) {
    ++counters_.wrong_rate;
    return false;
  }
  if (!flush()) {
    ++counters_.backlogged;
    return false;
  }
  std::optional<std::uint16_t> stamp;
  if (time_stamps_) {
    stamp = static_cast<std::uint16_t>(clock_().count() % slcan::kTimeStampModulus);
  }
  write(slcan::write_frame(frame, stamp).span());
  return true;
}

EndpointStatus SlcanAdapter::status() const {
  return {"slcan " + line_.status().address,
          channel_ != Channel::closed && line_.status().client_present};
}

void SlcanAdapter::take_line(const slcan::LineSplitter::Line& line) {
  if (line.too_long) {
    ++counters_.too_long_lines;
    answer(plain(ReplyKind::refused));
    return;
  }
  if (line.text.empty()) {
    return;  // masters send a few CR to clear the line
  }
  const auto command = slcan::parse_command(line.text);
  if (!command.ok()) {
    answer(plain(ReplyKind::refused));
    return;
  }
  switch (command->verb) {
    case Verb::version:
      write(as_bytes(kVersion));
      break;
    case Verb::detailed_version:
      write(as_bytes(kDetailedVersion));
      break;
    case Verb::serial_number:
      write(as_bytes(kSerialNumber));
      break;
    default:
      answer(execute(*command));
      break;
  }
}

Reply SlcanAdapter::execute(const slcan::Command& command) {
  const Reply done = plain(ReplyKind::done);
  const Reply refused = plain(ReplyKind::refused);
  switch (command.verb) {
    case Verb::open:
      channel_ = Channel::open;
      return done;
    case Verb::listen_only:
      channel_ = Channel::listening;
      return done;
    case Verb::close:
      channel_ = Channel::closed;
      return done;
    case Verb::bit_rate:
      if (channel_ != Channel::closed) {
        return refused;
      }
      client_rate_code_ = command.number;
      return done;
    case Verb::time_stamps:
      time_stamps_ = command.number != 0;
      return done;
    case Verb::auto_poll:
      auto_poll_ = command.number != 0;
      return done;
    case Verb::status_flags:
      return channel_ == Channel::closed ? refused : plain(ReplyKind::status_flags);
    case Verb::frame: {
      if (channel_ != Channel::open) {
        return refused;
      }
      if (client_rate_code_ != bus_rate_code_) {
        ++counters_.wrong_rate;
      } else if (receiver_) {
        receiver_(command.frame);
      }
      Reply taken = plain(auto_poll_ ? ReplyKind::frame_taken : ReplyKind::done);
      taken.frame = command.frame;
      return taken;
    }
    default:
      return refused;
  }
}

void SlcanAdapter::answer(const Reply& reply) {
  if (reply.kind == ReplyKind::refused) {
    ++counters_.refused_commands;
  }
  write(slcan::write_reply(reply).span());
}

bool SlcanAdapter::flush() {
  if (!kept_.empty()) {
    const std::size_t taken = line_.write(kept_);
    kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  return kept_.empty();
}

void SlcanAdapter::write(std::span<const std::uint8_t> bytes) {
  const std::size_t taken = flush() ? line_.write(bytes) : 0;
  const auto rest = bytes.subspan(taken);
  if (kept_.size() + rest.size() <= kGreatestBacklog) {
    kept_.insert(kept_.end(), rest.begin(), rest.end());
  }
}

}  // namespace rigwire::drivers
