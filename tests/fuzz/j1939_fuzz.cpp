// Identifiers, requests, claims and acknowledgements survive the round trip; any frame is harmless.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/bytes.h"
#include "protocols/can/bits.h"
#include "protocols/j1939/message.h"

namespace can = rigwire::protocols::can;
namespace j1939 = rigwire::protocols::j1939;

static void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 6) {
    return 0;
  }
  can::Frame frame;
  frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
  frame.extended = (data[4] & 1U) != 0;
  frame.remote = (data[4] & 2U) != 0;
  frame.length = data[5];
  std::copy_n(data + 6, std::min<std::size_t>(size - 6, frame.data.size()), frame.data.begin());

  require(j1939::pack(j1939::unpack(frame.id)) == (frame.id & 0x1FFFFFFFU));
  require(can::exact_bits(frame) <= can::worst_case_bits(frame));
  const auto identifier = j1939::identify(frame);
  if (const auto request = j1939::decode_request(frame); request.ok()) {
    const auto again = j1939::make_request(identifier->source, identifier->destination, *request);
    require(*j1939::decode_request(again) == *request);
  }
  if (const auto claim = j1939::decode_address_claim(frame); claim.ok()) {
    require(*j1939::decode_address_claim(j1939::make_address_claim(1, *claim)) == *claim);
  }
  if (const auto answer = j1939::decode_acknowledgement(frame); answer.ok()) {
    require(*j1939::decode_acknowledgement(j1939::make_acknowledgement(1, 2, *answer)) == *answer);
  }
  return 0;
}
