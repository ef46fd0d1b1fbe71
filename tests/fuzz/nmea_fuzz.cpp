// NMEA sentences from arbitrary bytes: bounds hold, readers accept only values within their ranges.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/nmea/position_sentences.h"
#include "protocols/nmea/sentence.h"

namespace {

using namespace rigwire::protocols::nmea;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void require_position(double latitude_deg, double longitude_deg) {
  require(std::abs(latitude_deg) <= 90.0 && std::abs(longitude_deg) <= 180.0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> all(data, size);
  std::size_t at = 0;
  while (at < size) {
    const auto rest = all.subspan(at);
    const auto sentence = decode_sentence(rest);
    if (sentence.incomplete()) {
      require(rest.size() < kMaximumSentence);
    }
    if (!sentence.ok()) {
      const std::size_t next = find_start(all, at + 1);
      require(next > at && next <= size);
      at = next;
      continue;
    }
    require(sentence.consumed() <= rest.size() && sentence.consumed() <= kMaximumSentence);
    require(sentence->field_count <= kMaximumFields);
    if (const auto rmc = read_rmc(*sentence); rmc.ok() && rmc->valid) {
      require_position(rmc->latitude_deg, rmc->longitude_deg);
      require(std::isfinite(rmc->ground_speed_mps) && rmc->ground_speed_mps >= 0.0);
    }
    if (const auto gga = read_gga(*sentence); gga.ok() && gga->quality > 0) {
      require_position(gga->latitude_deg, gga->longitude_deg);
      require(std::isfinite(gga->altitude_m) && std::isfinite(gga->separation_m));
    }
    Sentence copy(sentence->address);
    for (std::size_t i = 0; i < sentence->field_count; ++i) {
      copy.field(sentence->fields[i]);
    }
    require(decode_sentence(copy.bytes()).ok());
    at += sentence.consumed();
  }
  return 0;
}
