// Any bytes as a capture: every block ends within them, what a packet refers to lies in them, and
// what is laid out in a packet is taken apart without reading beyond it.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <variant>

#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcapng.h"

namespace pcapng = rigwire::protocols::pcapng;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void take_apart(std::span<const std::uint8_t> packet) {
  if (const auto frame = pcapng::can_frame(packet); frame.ok()) {
    const auto again = pcapng::can_frame(pcapng::can_packet(*frame));
    require(again.ok() && *again == *frame);
  }
  if (const auto datagram = pcapng::udp_packet(packet); datagram.ok()) {
    pcapng::Bytes laid_out;
    pcapng::append_udp(laid_out, datagram->from, datagram->to, datagram->bytes);
    const auto again = pcapng::udp_packet(laid_out);
    require(again.ok() && again->from == datagram->from && again->to == datagram->to &&
            again->bytes.size() == datagram->bytes.size());
  }
  require(pcapng::serial_bytes(packet).size() <= packet.size());
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> rest(data, size);
  take_apart(rest);
  pcapng::Reader reader;
  while (!rest.empty()) {
    const auto block = reader.next(rest);
    if (!block.ok()) {
      require(block.malformed() || block.shortage().needed > rest.size());
      break;
    }
    require(block.consumed() >= 12 && block.consumed() <= rest.size());
    if (const auto* packet = std::get_if<pcapng::Packet>(&*block)) {
      require(packet->interface < reader.interfaces().size());
      take_apart(packet->bytes);
      pcapng::Bytes written;
      pcapng::append(written, *packet);
      require(written.size() >= 32 + packet->bytes.size());
    }
    rest = rest.subspan(block.consumed());
  }
  return 0;
}
