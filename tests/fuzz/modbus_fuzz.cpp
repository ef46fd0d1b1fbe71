// Modbus decoders on any bytes: what they take lies inside what they were given, and survives a
// round trip.
#include <cstdint>
#include <cstdlib>
#include <variant>

#include "protocols/modbus/mbap.h"
#include "protocols/modbus/pdu.h"

namespace {

using namespace rigwire::protocols::modbus;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check_request(std::span<const std::uint8_t> pdu) {
  const auto decoded = decode_request(pdu);
  if (const auto* refusal = std::get_if<Refusal>(&decoded)) {
    require((refusal->function & kExceptionFlag) == 0);
    return;
  }
  const Pdu encoded = encode_request(std::get<Request>(decoded));
  require(encoded.size == pdu.size());
  const auto again = decode_request(encoded.view());
  require(std::holds_alternative<Request>(again));
  require(std::get<Request>(again) == std::get<Request>(decoded));
}

void check_response(std::span<const std::uint8_t> pdu) {
  const auto decoded = decode_response(pdu);
  if (decoded.incomplete()) {
    require(decoded.shortage().needed > pdu.size() && decoded.shortage().needed <= kPduMaximum);
    return;
  }
  if (!decoded.ok()) {
    return;
  }
  require(decoded.consumed() <= pdu.size());
  const Pdu encoded = encode_response(*decoded);
  require(encoded.size == decoded.consumed());
  const auto again = decode_response(encoded.view());
  require(again.ok() && *again == *decoded);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  auto stream = bytes;
  for (;;) {
    const auto adu = decode_adu(stream);
    if (!adu.ok()) {
      require(!adu.incomplete() || adu.shortage().needed > stream.size());
      break;
    }
    require(adu.consumed() <= stream.size() && adu.consumed() == kMbapHeaderSize + adu->pdu.size());
    require(encode_adu(adu->header, adu->pdu).size == adu.consumed());
    check_request(adu->pdu);
    check_response(adu->pdu);
    stream = stream.subspan(adu.consumed());
  }
  if (!bytes.empty() && bytes.size() <= kPduMaximum) {
    check_request(bytes);
    check_response(bytes);
  }
  return 0;
}
