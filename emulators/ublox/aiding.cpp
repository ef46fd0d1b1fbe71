#include "emulators/ublox/aiding.h"

#include <algorithm>
#include <cmath>

#include "protocols/ubx/aiding.h"

namespace rigwire::emulators {
namespace {

namespace gps = protocols::gps;
namespace ubx = protocols::ubx;

// Words 3..10.
std::array<std::uint32_t, 8> content(const gps::SubframeData& data) {
  std::array<std::uint32_t, 8> words{};
  std::copy(data.words.begin() + 2, data.words.end(), words.begin());
  return words;
}

template <class Message>
std::size_t put(const Message& message, ubx::MessageId id, std::span<std::uint8_t> out) {
  const auto frame = out.first(ubx::frame_size<Message>());
  ubx::write_payload(message, frame.subspan(ubx::kHeaderBytes, Message::kLength));
  ubx::seal_frame(id, frame);
  return frame.size();
}

}  // namespace

std::size_t encode_aiding_ephemeris(const SubframeReception& reception, std::size_t prn,
                                    ubx::MessageId id, std::span<std::uint8_t> out) {
  const auto& known = reception.ephemeris(prn);
  const auto satellite = static_cast<std::uint32_t>(prn);
  if (!known) {
    return put(ubx::AidEphHead{.satellite = satellite}, id, out);
  }
  gps::Ephemeris decoded = *known;
  decoded.l2_code = 0;
  decoded.l2_p_data_off = false;
  decoded.age_of_data_offset = 0;
  ubx::AidEph message{.satellite = satellite};
  gps::SubframeData data;
  gps::set_head(data, {.next_step = static_cast<std::uint32_t>(decoded.ephemeris_time_s) /
                                    gps::kStepSeconds % gps::kStepsPerWeek,
                       .anti_spoof = false,
                       .subframe_id = 1});
  message.handover_word = data.words[1];
  gps::put_ephemeris(data, 1, decoded, decoded.week);
  message.subframe1 = content(data);
  gps::put_ephemeris(data, 2, decoded, decoded.week);
  message.subframe2 = content(data);
  gps::put_ephemeris(data, 3, decoded, decoded.week);
  message.subframe3 = content(data);
  return put(message, id, out);
}

std::size_t encode_aiding_almanac(const SubframeReception& reception, std::size_t prn,
                                  ubx::MessageId id, std::span<std::uint8_t> out) {
  const auto& known = reception.almanac(prn);
  const auto satellite = static_cast<std::uint32_t>(prn);
  if (!known) {
    return put(ubx::AidAlmHead{.satellite = satellite}, id, out);
  }
  gps::SubframeData data;
  gps::put_almanac(data, *known);
  return put(ubx::AidAlm{.satellite = satellite,
                         .week = static_cast<std::uint32_t>(known->week),
                         .words = content(data)},
             id, out);
}

std::size_t encode_aiding_health(const SubframeReception& reception, std::span<std::uint8_t> out) {
  constexpr std::uint32_t kHealthValid = 0x1;
  constexpr std::uint32_t kUtcValid = 0x2;
  constexpr std::uint32_t kIonosphereValid = 0x4;
  ubx::AidHui message;
  if (const auto& health = reception.health(); health) {
    for (std::size_t i = 0; i < gps::kSatellites; ++i) {
      message.health |= health->health[i] == 0 ? 1U << i : 0U;
    }
    message.flags |= kHealthValid;
  }
  if (const auto& page = reception.ionosphere_utc(); page) {
    message.utc_a0_s = page->utc_a0_s;
    message.utc_a1 = page->utc_a1;
    message.utc_reference_s = static_cast<std::int32_t>(page->utc_reference_time_s);
    message.utc_reference_week = static_cast<std::int16_t>(page->utc_reference_week);
    message.leap_seconds = static_cast<std::int16_t>(page->leap_seconds);
    message.leap_week = static_cast<std::int16_t>(page->leap_week);
    message.leap_day = static_cast<std::int16_t>(page->leap_day);
    message.leap_seconds_future = static_cast<std::int16_t>(page->leap_seconds_future);
    for (std::size_t i = 0; i < page->alpha.size(); ++i) {
      message.klobuchar_alpha[i] = static_cast<float>(page->alpha[i]);
      message.klobuchar_beta[i] = static_cast<float>(page->beta[i]);
    }
    message.flags |= kUtcValid | kIonosphereValid;
  }
  return put(message, ubx::AidHui::kId, out);
}

}  // namespace rigwire::emulators
