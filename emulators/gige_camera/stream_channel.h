// The stream channel: blocks wait here for the network, leave packet by packet, and are kept for
// clients that miss some of them.
//
// Pacing. A packet leaves when the one before it has left: after the time that its bytes take on a
// link of 1 Gbit/s with what Ethernet adds, plus the packet delay that the client has set; and no
// faster than the throughput limit, counted over IP packets, where that holds. Packets that are
// asked for again go first.
//
// Blocks come exposure by exposure, one or several each (a block for each component without
// multi-part). A queue that is full loses the newest exposure with all its blocks, whose numbers
// are then missing on the wire.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/bounded_queue.h"
#include "emulators/gige_camera/datagram.h"
#include "emulators/gige_camera/stream_block.h"
#include "protocols/gige_vision/gvcp.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct StreamCounters {
  std::uint64_t blocks = 0;       ///< Blocks sent completely.
  std::uint64_t lost_blocks = 0;  ///< Blocks of exposures lost because the queue was full.
  std::uint64_t packets = 0;      ///< Packets sent, including resent ones.
  std::uint64_t resent_packets = 0;
  std::uint64_t refused_resends = 0;  ///< Resend requests for packets that are not available.
};

class StreamChannel {
 public:
  using Status = protocols::gige_vision::Status;

  /// How many exposures wait, and are kept after they were sent; blocks of an exposure at most.
  struct Capacity {
    std::size_t queued = 1;
    std::size_t retained = 1;
    std::size_t blocks = 1;
  };

  /// `output` must outlive it.
  StreamChannel(DatagramOutput& output, const Capacity& capacity, std::size_t longest_packet);

  /// Where packets go; blocks are numbered from 1 again.
  void open(const UdpEnd& destination);
  /// Nothing is sent any more, and nothing is kept.
  void close();
  [[nodiscard]] bool is_open() const { return destination_.has_value(); }
  void set_destination(const UdpEnd& destination);
  void set_do_not_fragment(bool on) { do_not_fragment_ = on; }
  /// The pause between packets; a limit of 0 bytes per second is none.
  void set_pace(Duration delay, double limit_bytes_per_s);
  /// Whether a client reads the newer statuses.
  void set_extended_status(bool on) { extended_status_ = on; }

  /// Gives the blocks of an exposure the next numbers and queues them, all or none. Precondition:
  /// is_open(), all but the numbers set, no more blocks than the capacity says.
  void offer(SimTime now, std::span<StreamBlock> blocks);
  void resend(SimTime now, const protocols::gige_vision::PacketResend& request);
  /// One packet of `packet_size` bytes with IP and UDP headers, out of turn.
  void fire_test_packet(SimTime now, const UdpEnd& to, std::uint32_t packet_size);

  void advance(SimTime now);
  [[nodiscard]] SimTime next_event() const;
  /// The number that the next block gets.
  [[nodiscard]] std::uint64_t next_number() const { return next_number_; }
  [[nodiscard]] const StreamCounters& counters() const { return counters_; }
  /// How long a packet keeps the network busy.
  [[nodiscard]] Duration time_of(std::size_t packet_size) const;

 private:
  /// Packets that are to be sent again, or refused.
  struct Again {
    std::uint64_t block = 0;
    bool extended_ids = false;
    std::uint32_t next = 0;
    std::uint32_t last = 0;
    Status refusal = Status::success;
  };

  /// A block with the exposure that it is of, counted over those that were not lost.
  struct Kept {
    StreamBlock block;
    std::uint64_t exposure = 0;
  };

  [[nodiscard]] Kept& place(std::uint64_t index) { return kept_[index % kept_.size()]; }
  [[nodiscard]] const StreamBlock* find(std::uint64_t number) const;
  [[nodiscard]] std::size_t waiting_exposures();
  [[nodiscard]] bool idle() const;
  void wake(SimTime now);
  void send_again();
  void send_next(StreamBlock& block);
  void transmit(std::size_t size);

  DatagramOutput& output_;
  Capacity capacity_;
  std::vector<Kept> kept_;  ///< The i-th block that was queued in place i modulo their number.
  std::vector<std::uint8_t> packet_;
  BoundedQueue<Again, 64> again_;

  std::optional<UdpEnd> destination_;
  bool do_not_fragment_ = false;
  bool extended_status_ = false;
  Duration delay_{0};
  double limit_bytes_per_s_ = 0.0;

  std::uint64_t next_number_ = 1;
  std::uint64_t queued_ = 0;     ///< Blocks queued so far.
  std::uint64_t sent_ = 0;       ///< Blocks sent completely.
  std::uint64_t forgotten_ = 0;  ///< Sent blocks that are no longer retained.
  std::uint64_t exposures_ = 0;  ///< Exposures queued so far.
  SimTime free_at_{};            ///< When the next packet can leave.
  StreamCounters counters_;
};

}  // namespace rigwire::emulators
