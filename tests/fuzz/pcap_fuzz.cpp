// Any bytes as a capture of the older format: every record ends within them, and what IP carries on
// any link is found without reading beyond the packet.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/pcapng/link_packet.h"
#include "protocols/pcapng/pcap.h"

namespace pcapng = rigwire::protocols::pcapng;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

static void take_apart(std::span<const std::uint8_t> packet) {
  using enum pcapng::LinkType;
  const std::uint8_t* end = packet.data() + packet.size();
  for (const pcapng::LinkType link : {ethernet, raw_ip, linux_cooked, linux_cooked_2, socketcan}) {
    if (const auto datagram = pcapng::udp_packet(packet, link); datagram.ok()) {
      require(datagram->bytes.empty() || datagram->bytes.data() + datagram->bytes.size() <= end);
    }
  }
  if (const auto segment = pcapng::tcp_packet(packet); segment.ok()) {
    require(segment->bytes.empty() || segment->bytes.data() + segment->bytes.size() <= end);
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> rest(data, size);
  take_apart(rest);
  pcapng::PcapReader reader;
  const auto head = reader.head(rest);
  if (!head.ok()) {
    return 0;
  }
  rest = rest.subspan(head.consumed());
  while (!rest.empty()) {
    const auto packet = reader.next(rest);
    if (!packet.ok()) {
      require(packet.malformed() || packet.shortage().needed > rest.size());
      break;
    }
    require(packet.consumed() >= pcapng::kPcapRecordHead && packet.consumed() <= rest.size());
    take_apart(packet->bytes);
    rest = rest.subspan(packet.consumed());
  }
  return 0;
}
