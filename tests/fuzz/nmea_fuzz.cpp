// NMEA sentences from arbitrary bytes: bounds hold, readers accept only values within their ranges.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "protocols/nmea/readers.h"
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

void read_others(const SentenceView& sentence) {
  if (const auto gll = read_gll(sentence); gll.ok() && gll->valid) {
    require_position(gll->latitude_deg, gll->longitude_deg);
  }
  if (const auto vtg = read_vtg(sentence); vtg.ok()) {
    require(vtg->course_deg.value_or(0.0) >= 0.0 && vtg->course_deg.value_or(0.0) <= 360.0);
    require(std::isfinite(vtg->ground_speed_mps.value_or(0.0)));
  }
  if (const auto gsv = read_gsv(sentence); gsv.ok()) {
    require(gsv->satellite_count <= gsv->satellites.size() && gsv->page <= gsv->pages);
  }
  if (const auto gsa = read_gsa(sentence); gsa.ok()) {
    require(gsa->used_count <= gsa->used.size() && gsa->mode >= 1 && gsa->mode <= 3);
  }
  if (const auto zda = read_zda(sentence); zda.ok() && zda->date) {
    require(zda->date->month >= 1 && zda->date->month <= 12);
  }
  if (const auto gst = read_gst(sentence); gst.ok()) {
    require(std::isfinite(gst->range_m.value_or(0.0)));
  }
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
    read_others(*sentence);
    Sentence copy(sentence->address);
    for (std::size_t i = 0; i < sentence->field_count; ++i) {
      copy.field(sentence->fields[i]);
    }
    require(decode_sentence(copy.bytes()).ok());
    at += sentence.consumed();
  }
  return 0;
}
