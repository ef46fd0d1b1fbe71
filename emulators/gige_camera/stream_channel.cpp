#include "emulators/gige_camera/stream_channel.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace rigwire::emulators {
namespace {

namespace gev = protocols::gige_vision;

/// Preamble and start, Ethernet header, check sum, gap.
constexpr std::size_t kEthernetBytes = 8 + 14 + 4 + 12;
constexpr std::int64_t kNanosecondsPerByte = 8;  // at 1 Gbit/s

}  // namespace

StreamChannel::StreamChannel(DatagramOutput& output, const Capacity& capacity,
                             std::size_t longest_packet)
    : output_(output),
      capacity_(capacity),
      kept_((capacity.queued + capacity.retained) * capacity.blocks),
      packet_(longest_packet) {}

void StreamChannel::open(const UdpEnd& destination) {
  close();
  destination_ = destination;
  next_number_ = 1;
}

void StreamChannel::close() {
  destination_.reset();
  again_.clear();
  for (Kept& kept : kept_) {
    kept = {};
  }
  forgotten_ = sent_ = queued_;
}

void StreamChannel::set_destination(const UdpEnd& destination) {
  assert(is_open());
  destination_ = destination;
}

void StreamChannel::set_pace(Duration delay, double limit_bytes_per_s) {
  delay_ = delay;
  limit_bytes_per_s_ = limit_bytes_per_s;
}

Duration StreamChannel::time_of(std::size_t packet_size) const {
  const Duration link{static_cast<std::int64_t>(packet_size + kEthernetBytes) *
                      kNanosecondsPerByte};
  const Duration with_delay = link + delay_;
  if (limit_bytes_per_s_ <= 0.0) {
    return with_delay;
  }
  return std::max(with_delay, from_seconds(static_cast<double>(packet_size) / limit_bytes_per_s_));
}

void StreamChannel::offer(SimTime now, std::span<StreamBlock> blocks) {
  assert(is_open() && blocks.size() <= capacity_.blocks);
  wake(now);
  const std::uint64_t number = next_number_;
  next_number_ += blocks.size();
  if (waiting_exposures() >= capacity_.queued) {
    // A gap in the numbers: what is kept is older and stays available for resend requests.
    counters_.lost_blocks += blocks.size();
    return;
  }
  const std::uint64_t exposure = exposures_++;
  while (forgotten_ < sent_ &&
         place(forgotten_).exposure + capacity_.queued + capacity_.retained <= exposure) {
    place(forgotten_++) = {};
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    blocks[i].number = number + i;
    blocks[i].next = 0;
    blocks[i].divide();
    place(queued_++) = {std::move(blocks[i]), exposure};
  }
}

const StreamBlock* StreamChannel::find(std::uint64_t number) const {
  const auto kept = std::ranges::find(kept_, number, [](const Kept& k) { return k.block.number; });
  return number != 0 && kept != kept_.end() ? &kept->block : nullptr;
}

std::size_t StreamChannel::waiting_exposures() {
  return sent_ < queued_ ? static_cast<std::size_t>(exposures_ - place(sent_).exposure) : 0;
}

bool StreamChannel::idle() const {
  return again_.empty() && sent_ >= queued_;
}

void StreamChannel::wake(SimTime now) {
  if (idle()) {
    free_at_ = std::max(free_at_, now);
  }
}

void StreamChannel::resend(SimTime now, const gev::PacketResend& request) {
  if (!is_open() || request.channel != 0) {
    ++counters_.refused_resends;
    return;
  }
  // Short numbers are of the newest block that has that one.
  std::uint64_t number = request.block;
  const std::uint64_t newest = next_number_ - 1;
  if (!request.extended_ids) {
    constexpr std::uint64_t kNumbers = 0xFFFF;
    const std::uint64_t back =
        newest == 0 ? 0 : (gev::short_block(newest) + kNumbers - request.block) % kNumbers;
    number = newest > back ? newest - back : newest + 1;
  }
  Again again{request.block, request.extended_ids, request.first, request.last, Status::success};
  const StreamBlock* const block = find(number);
  if (number > newest) {
    again.refusal = Status::packet_not_yet_available;
  } else if (block == nullptr) {
    again.refusal = Status::packet_removed;
  } else if (request.first >= block->packets()) {
    again.refusal = Status::packet_unavailable;
  } else if (request.first >= block->next) {
    again.refusal = Status::packet_not_yet_available;
  } else {
    again.block = number;
    again.last = std::min(request.last, block->next - 1);
  }
  if (is_error(again.refusal)) {
    ++counters_.refused_resends;
    // A client that knows the first statuses only would take "not yet" for "never".
    if (!extended_status_) {
      if (again.refusal == Status::packet_not_yet_available && number <= newest) {
        return;
      }
      again.refusal = Status::packet_unavailable;
    }
  }
  wake(now);
  if (!again_.push(again)) {
    ++counters_.refused_resends;
  }
}

void StreamChannel::fire_test_packet(SimTime now, const UdpEnd& to, std::uint32_t packet_size) {
  const std::size_t size = packet_size - gev::kIpUdpHeaders;
  assert(size <= packet_.size());
  std::ranges::fill(packet_, std::uint8_t{0});
  gev::write_header(packet_, gev::PacketHeader{.format = gev::PacketFormat::payload, .block = 0});
  free_at_ = std::max(free_at_, now);
  output_.send(free_at_, to, std::span(packet_).first(size), true);
  free_at_ += time_of(packet_size);
  ++counters_.packets;
}

void StreamChannel::transmit(std::size_t size) {
  output_.send(free_at_, *destination_, std::span(packet_).first(size), do_not_fragment_);
  free_at_ += time_of(size + gev::kIpUdpHeaders);
  ++counters_.packets;
}

void StreamChannel::send_again() {
  Again& again = again_[0];
  if (is_error(again.refusal)) {
    gev::PacketHeader header;
    header.status = again.refusal;
    header.extended_ids = again.extended_ids;
    header.block = again.block;
    header.packet = again.next;
    transmit(gev::write_header(packet_, header));
    [[maybe_unused]] const Again done = again_.pop();
    return;
  }
  // Between the request and now newer blocks may have taken its place.
  if (const StreamBlock* const block = find(again.block)) {
    transmit(block->write(again.next, Status::packet_resent, packet_));
    ++counters_.resent_packets;
    if (again.next++ < again.last) {
      return;
    }
  }
  [[maybe_unused]] const Again done = again_.pop();
}

void StreamChannel::send_next(StreamBlock& block) {
  transmit(block.write(block.next++, Status::success, packet_));
  if (block.sent()) {
    ++counters_.blocks;
    ++sent_;
  }
}

void StreamChannel::advance(SimTime now) {
  while (is_open() && !idle() && free_at_ <= now) {
    if (!again_.empty()) {
      send_again();
    } else {
      send_next(place(sent_).block);
    }
  }
}

SimTime StreamChannel::next_event() const {
  return is_open() && !idle() ? free_at_ : kNever;
}

}  // namespace rigwire::emulators
