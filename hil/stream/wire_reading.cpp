#include "hil/stream/wire_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "hil/configuration/plain_text.h"
#include "hil/record/byte_place.h"
#include "protocols/bit_fields.h"
#include "protocols/bytes.h"
#include "protocols/can/frame_text.h"
#include "protocols/can/signal.h"
#include "protocols/gige_vision/gvcp.h"
#include "protocols/gige_vision/gvsp.h"
#include "protocols/nmea/field_names.h"
#include "protocols/nmea/sentence.h"
#include "protocols/rtcm3/frame.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::hil {
namespace {

namespace can = protocols::can;
namespace gige = protocols::gige_vision;
namespace nmea = protocols::nmea;
namespace rtcm3 = protocols::rtcm3;
namespace ubx = protocols::ubx;
namespace velodyne = protocols::velodyne;

using Bytes = std::span<const std::uint8_t>;

// UBX: the members of a message's list of fields, gaps apart, in its order.
template <class Message>
constexpr std::string_view kNames;
template <>
constexpr std::string_view kNames<ubx::NavPosllh> =
    "time of week, ms;longitude, 1e-7 deg;latitude, 1e-7 deg;height above ellipsoid, mm;height "
    "above sea level, mm;horizontal accuracy, mm;vertical accuracy, mm";
template <>
constexpr std::string_view kNames<ubx::NavStatus> =
    "time of week, ms;fix type;flags;fix status;flags 2;time to first fix, ms;time since start, ms";
template <>
constexpr std::string_view kNames<ubx::NavPvt92> =
    "time of week, ms;year;month;day;hour;minute;second;valid;time accuracy, ns;nanosecond;fix "
    "type;flags;flags 2;satellites used;longitude, 1e-7 deg;latitude, 1e-7 deg;height above "
    "ellipsoid, mm;height above sea level, mm;horizontal accuracy, mm;vertical accuracy, "
    "mm;velocity north, east, down, mm/s;ground speed, mm/s;heading of motion, 1e-5 deg;speed "
    "accuracy, mm/s;heading accuracy, 1e-5 deg;position dilution, 0.01;flags 3;heading of vehicle, "
    "1e-5 deg;declination, 0.01 deg;declination accuracy, 0.01 deg";
// The older message ends where the newer one goes on.
template <>
constexpr std::string_view kNames<ubx::NavPvt> =
    kNames<ubx::NavPvt92>.substr(0, kNames<ubx::NavPvt92>.find(";flags 3"));
template <>
constexpr std::string_view kNames<ubx::NavSatHead> = "time of week, ms;version;satellites";
template <>
constexpr std::string_view kNames<ubx::NavSatBlock> =
    "system;satellite;C/N0, dBHz;elevation, deg;azimuth, deg;residual, 0.1 m;flags";
template <>
constexpr std::string_view kNames<ubx::AckAck> = "class of the request;id of the request";
template <>
constexpr std::string_view kNames<ubx::AckNak> = kNames<ubx::AckAck>;

template <class Field>
inline constexpr bool kIsGap = false;
template <std::size_t kBytes>
inline constexpr bool kIsGap<ubx::Gap<kBytes>> = true;

template <class Message>
constexpr std::size_t named_fields() {
  std::size_t count = 0;
  const Message message;
  ubx::detail::for_each_field(Message::fields(message), [&](std::size_t, auto& field) {
    count += kIsGap<std::remove_cvref_t<decltype(field)>> ? 0U : 1U;
  });
  return count;
}

template <class Value>
std::string text_of(const Value& value) {
  if constexpr (std::floating_point<Value>) {
    return fmt::format("{:g}", value);
  } else if constexpr (std::integral<Value>) {
    return std::to_string(value);
  } else {
    return fmt::format("{}", fmt::join(value, " "));
  }
}

/// Appends the fields of a payload, or of a part of it that begins at byte `from` of the frame.
template <class Message>
void append_fields(WireReading& reading, Bytes part, std::size_t from,
                   const std::string& before = {}) {
  static_assert(static_cast<std::size_t>(std::ranges::count(kNames<Message>, ';')) + 1 ==
                named_fields<Message>());
  const auto message = ubx::read_payload<Message>(part);
  std::string_view names = kNames<Message>;
  ubx::detail::for_each_field(Message::fields(message), [&](std::size_t offset, auto& field) {
    using Field = std::remove_cvref_t<decltype(field)>;
    if constexpr (!kIsGap<Field>) {
      const std::size_t end = std::min(names.find(';'), names.size());
      reading.fields.push_back({before + std::string(names.substr(0, end)), text_of(field),
                                from + offset, sizeof(Field)});
      names.remove_prefix(std::min(end + 1, names.size()));
    }
  });
}

/// Whether the frame is one of that message, whose fields are added then.
template <class Message>
bool append_message(WireReading& reading, const ubx::FrameView& frame) {
  const bool is_one = frame.id == Message::kId && frame.payload.size() == Message::kLength;
  if (is_one) {
    append_fields<Message>(reading, frame.payload, ubx::kHeaderBytes);
  }
  return is_one;
}

bool append_satellites(WireReading& reading, const ubx::FrameView& frame) {
  const auto told = ubx::decode_blocks<ubx::NavSatHead, ubx::NavSatBlock>(frame);
  if (!told.ok()) {
    return false;
  }
  append_fields<ubx::NavSatHead>(reading, frame.payload, ubx::kHeaderBytes);
  for (std::size_t i = 0; i < told->size(); ++i) {
    const std::size_t at = ubx::NavSatHead::kLength + i * ubx::NavSatBlock::kLength;
    if (ubx::kHeaderBytes + at >= kShownBytes) {
      break;
    }
    append_fields<ubx::NavSatBlock>(reading, frame.payload.subspan(at), ubx::kHeaderBytes + at,
                                    fmt::format("{}: ", i + 1));
  }
  return true;
}

void read_ubx(WireReading& reading, const ubx::FrameView& frame) {
  const auto [of_class, id] = frame.id;
  const std::size_t size = frame.payload.size();
  reading.text = fmt::format("UBX 0x{:02X} 0x{:02X}", of_class, id);
  reading.fields = {{"synchronization", "", 0, 2},
                    {"class", fmt::format("0x{:02X}", of_class), 2, 1},
                    {"id", fmt::format("0x{:02X}", id), 3, 1},
                    {"length", std::to_string(size), 4, 2}};
  if (!(append_message<ubx::NavPvt>(reading, frame) ||
        append_message<ubx::NavPvt92>(reading, frame) ||
        append_message<ubx::NavPosllh>(reading, frame) ||
        append_message<ubx::NavStatus>(reading, frame) ||
        append_message<ubx::AckAck>(reading, frame) ||
        append_message<ubx::AckNak>(reading, frame) || append_satellites(reading, frame)) &&
      size != 0) {
    reading.fields.push_back({"payload", "", ubx::kHeaderBytes, size});
  }
  reading.fields.push_back({"checksum", "", ubx::kHeaderBytes + size, ubx::kChecksumBytes});
}

/// A field of a message that is a string of bits, most significant first.
struct BitRow {
  enum class Shown : std::uint8_t { number, hexadecimal };

  std::string_view name;  ///< Empty: reserved bits.
  unsigned bits;
  Shown shown = Shown::number;
  protocols::Sign sign = protocols::Sign::none;
  double step = 1.0;
  std::string_view unit{};
};

/// Appends the fields of `rows` from the bit `from` on, as far as `bytes` has them.
void append_rows(WireReading& reading, Bytes bytes, std::size_t from,
                 std::span<const BitRow> rows) {
  protocols::BitReader reader(bytes.subspan(from / 8));
  reader.spare(from % 8);
  std::size_t at = from;
  for (const BitRow& row : rows) {
    const std::size_t end = at + row.bits;
    if (end > 8 * bytes.size() || at / 8 >= kShownBytes) {
      return;
    }
    std::string value;
    if (row.name.empty()) {
      reader.spare(row.bits);
    } else if (row.shown == BitRow::Shown::hexadecimal) {
      std::uint64_t code = 0;
      reader.whole(row.bits, code);
      value = fmt::format("0x{:0{}X}", code, (row.bits + 3) / 4);
    } else {
      double number = 0.0;
      reader.scaled(row.bits, row.sign, row.step, number);
      value = fmt::format("{:.12g}{}{}", number, row.unit.empty() ? "" : " ", row.unit);
    }
    if (!row.name.empty()) {
      reading.fields.push_back(
          {std::string(row.name), std::move(value), at / 8, (end + 7) / 8 - at / 8});
    }
    at = end;
  }
}

constexpr auto kHexadecimal = BitRow::Shown::hexadecimal;

// RTCM 3 behind the message's number and the station's (RTCM 10403.3): tables 3.5-6 and 3.5-7,
// 3.5-1, 3.5-9, 3.5-78, and the first of 1230.
constexpr double kCoordinate_m = 1e-4;
constexpr std::array<BitRow, 10> kAntennaRows{
    {{"year of the ITRF", 6},
     {"systems", 3, kHexadecimal},
     {"computed station", 1},
     {"x", 38, BitRow::Shown::number, protocols::Sign::twos, kCoordinate_m, "m"},
     {"one oscillator", 1},
     {"", 1},
     {"y", 38, BitRow::Shown::number, protocols::Sign::twos, kCoordinate_m, "m"},
     {"quarter cycles", 2},
     {"z", 38, BitRow::Shown::number, protocols::Sign::twos, kCoordinate_m, "m"},
     {"antenna height", 16, BitRow::Shown::number, protocols::Sign::none, kCoordinate_m, "m"}}};
constexpr std::array<BitRow, 5> kGpsRows{{{"time of week, ms", 30},
                                          {"more follow", 1},
                                          {"satellites", 5},
                                          {"free of divergence", 1},
                                          {"smoothing", 3}}};
constexpr std::array<BitRow, 5> kGlonassRows{{{"time of day, ms", 27},
                                              {"more follow", 1},
                                              {"satellites", 5},
                                              {"free of divergence", 1},
                                              {"smoothing", 3}}};
constexpr std::array<BitRow, 9> kMsmRows{{{"time of epoch", 30},
                                          {"more follow", 1},
                                          {"issue of station data", 3},
                                          {"", 7},
                                          {"clock steering", 2},
                                          {"external clock", 2},
                                          {"smoothing", 4},
                                          {"satellites' mask", 64, kHexadecimal},
                                          {"signals' mask", 32, kHexadecimal}}};
constexpr std::array<BitRow, 3> kBiasRows{{{"aligned", 1}, {"", 3}, {"signals", 4, kHexadecimal}}};

std::span<const BitRow> rows_of_rtcm(std::uint16_t message) {
  struct Range {
    std::uint16_t first;
    std::uint16_t last;
    std::span<const BitRow> rows;
  };
  constexpr std::size_t kHeightRow = 9;
  const std::array<Range, 6> ranges{
      {{1001, 1004, kGpsRows},
       {1005, 1005, std::span<const BitRow>(kAntennaRows).first(kHeightRow)},
       {1006, 1006, kAntennaRows},
       {1009, 1012, kGlonassRows},
       {1071, 1137, kMsmRows},
       {1230, 1230, kBiasRows}}};
  const auto found = std::ranges::find_if(
      ranges, [&](const Range& range) { return range.first <= message && message <= range.last; });
  return found == ranges.end() ? std::span<const BitRow>{} : found->rows;
}

void read_rtcm(WireReading& reading, Bytes bytes, const rtcm3::FrameView& frame) {
  constexpr std::array<BitRow, 5> kFrameRows{
      {{"preamble", 8, kHexadecimal}, {"", 6}, {"length", 10}, {"message", 12}, {"station", 12}}};
  const std::size_t end = rtcm3::kHeaderBytes + frame.payload.size();
  reading.text = fmt::format("RTCM {}", frame.message());
  append_rows(reading, bytes.first(end), 0, kFrameRows);
  constexpr std::size_t kContent = 8 * rtcm3::kHeaderBytes + 12 /*message*/ + 12 /*station*/;
  append_rows(reading, bytes.first(end), kContent, rows_of_rtcm(frame.message()));
  // What no row says.
  const std::size_t told = reading.fields.back().from + reading.fields.back().bytes;
  if (told < end) {
    reading.fields.push_back({"content", "", told, end - told});
  }
  reading.fields.push_back({"checksum", "", end, rtcm3::kChecksumBytes});
}

// GigE Vision (protocols/gige_vision/gvsp.h, gvcp.h).
constexpr std::array<BitRow, 4> kShortHeaderRows{
    {{"status", 16, kHexadecimal}, {"block", 16}, {"format", 8}, {"packet", 24}}};
constexpr std::array<BitRow, 7> kExtendedHeaderRows{{{"status", 16, kHexadecimal},
                                                     {"flags", 16, kHexadecimal},
                                                     {"format", 8, kHexadecimal},
                                                     {"", 16},
                                                     {"parts", 8},
                                                     {"block", 64},
                                                     {"packet", 32}}};
constexpr std::array<BitRow, 10> kImageLeaderRows{{{"flags", 16, kHexadecimal},
                                                   {"payload type", 16, kHexadecimal},
                                                   {"timestamp", 64},
                                                   {"pixel format", 32, kHexadecimal},
                                                   {"width", 32},
                                                   {"height", 32},
                                                   {"offset x", 32},
                                                   {"offset y", 32},
                                                   {"padding x", 16},
                                                   {"padding y", 16}}};
constexpr std::array<BitRow, 19> kMultipartLeaderRows{{{"flags", 16, kHexadecimal},
                                                       {"payload type", 16, kHexadecimal},
                                                       {"timestamp", 64},
                                                       {"part 0, data type", 16},
                                                       {"part 0, length", 48},
                                                       {"part 0, pixel format", 32, kHexadecimal},
                                                       {"", 16},
                                                       {"part 0, source", 8},
                                                       {"part 0, zones", 8},
                                                       {"part 0, directions", 32, kHexadecimal},
                                                       {"part 0, purpose", 16},
                                                       {"part 0, region", 16},
                                                       {"part 0, width", 32},
                                                       {"part 0, height", 32},
                                                       {"part 0, offset x", 32},
                                                       {"part 0, offset y", 32},
                                                       {"part 0, padding x", 16},
                                                       {"part 0, padding y", 16},
                                                       {"", 32}}};
constexpr std::array<BitRow, 3> kImageTrailerRows{
    {{"", 16}, {"payload type", 16, kHexadecimal}, {"height", 32}}};
constexpr std::array<BitRow, 3> kMultipartPayloadRows{{{"part", 8}, {"zone", 8}, {"offset", 48}}};
constexpr std::array<BitRow, 5> kCommandRows{{{"key", 8, kHexadecimal},
                                              {"flags", 8, kHexadecimal},
                                              {"command", 16, kHexadecimal},
                                              {"length", 16},
                                              {"request", 16}}};
constexpr std::array<BitRow, 4> kAcknowledgeRows{{{"status", 16, kHexadecimal},
                                                  {"acknowledge", 16, kHexadecimal},
                                                  {"length", 16},
                                                  {"request", 16}}};
constexpr std::array<BitRow, 2> kWriteRows{
    {{"address", 32, kHexadecimal}, {"value", 32, kHexadecimal}}};

/// Appends the rest after the fields of the rows.
void append_rest(WireReading& reading, Bytes bytes, std::string_view name, std::size_t from) {
  if (from < bytes.size()) {
    reading.fields.push_back({std::string(name), "", from, bytes.size() - from});
  }
}

void read_nmea(WireReading& reading, const nmea::SentenceView& sentence, Bytes bytes) {
  const auto place = [&](std::string_view text) {
    return static_cast<std::size_t>(text.data() - reinterpret_cast<const char*>(bytes.data()));
  };
  reading.fields = {{"talker and type", std::string(sentence.address), place(sentence.address),
                     sentence.address.size()}};
  const std::size_t count = std::min(sentence.field_count, nmea::kMaximumFields);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view text = sentence.fields[i];
    const std::string_view name = nmea::field_name(sentence.type(), i, count);
    if (!text.empty()) {
      reading.fields.push_back({name.empty() ? fmt::format("field {}", i + 1) : std::string(name),
                                std::string(text), place(text), text.size()});
    }
  }
}

}  // namespace

WireReading read_serial(std::span<const std::uint8_t> bytes) {
  WireReading reading;
  if (const auto frame = ubx::decode_frame(bytes); frame.ok()) {
    read_ubx(reading, *frame);
  } else if (const auto correction = rtcm3::decode_frame(bytes); correction.ok()) {
    read_rtcm(reading, bytes, *correction);
  } else if (!bytes.empty() && bytes.front() == '$') {
    const auto end = std::ranges::find(bytes, std::uint8_t{'\r'});
    reading.text = printable(std::string(bytes.begin(), end));
    if (const auto sentence = nmea::decode_sentence(bytes); sentence.ok()) {
      read_nmea(reading, *sentence, bytes);
    }
  } else {
    reading.text = serial_place(bytes, 0);
  }
  return reading;
}

WireReading read_datagram(std::span<const std::uint8_t> bytes) {
  WireReading reading{datagram_place(bytes, 0), {}};
  if (bytes.size() != velodyne::kDataPacketSize) {
    return reading;
  }
  const auto packet = velodyne::decode_data_packet(bytes);
  if (!packet.ok()) {
    return reading;
  }
  constexpr std::size_t kHead = 2 /*flag*/ + 2 /*azimuth*/;
  for (std::size_t block = 0; block * velodyne::kBlockSize < kShownBytes; ++block) {
    const velodyne::Block& told = packet->blocks[block];
    std::size_t at = block * velodyne::kBlockSize;
    const std::string name = fmt::format("block {}, ", block);
    reading.fields.push_back({name + "flag", fmt::format("0x{:04X}", told.flag), at, 2});
    reading.fields.push_back(
        {name + "azimuth", fmt::format("{:.2f} deg", 0.01 * told.azimuth_counts), at + 2, 2});
    at += kHead;
    for (std::size_t i = 0; i < told.channels.size() && at < kShownBytes; ++i) {
      const velodyne::Channel& channel = told.channels[i];
      reading.fields.push_back({fmt::format("{}channel {}, distance", name, i),
                                fmt::format("{} counts", channel.distance_counts), at, 2});
      reading.fields.push_back({fmt::format("{}channel {}, reflectivity", name, i),
                                std::to_string(channel.reflectivity), at + 2, 1});
      at += velodyne::kChannelSize;
    }
  }
  return reading;
}

/// Reads the header of a GVSP packet and, by its format, leader, payload or trailer; the fields are
/// those of protocols/gige_vision.
WireReading read_stream_packet(std::span<const std::uint8_t> bytes) {
  WireReading reading;
  const auto packet = gige::decode_stream_packet(bytes);
  if (!packet.ok()) {
    return reading;
  }
  const gige::PacketHeader& header = packet->header;
  const std::size_t payload = gige::packet_header_size(header.extended_ids);
  append_rows(
      reading, bytes, 0,
      header.extended_ids ? std::span<const BitRow>(kExtendedHeaderRows) : kShortHeaderRows);
  const auto tell = [&](std::string_view kind, std::span<const BitRow> rows,
                        std::string_view rest) {
    reading.text = fmt::format("GVSP block {}, packet {}, {}", header.block, header.packet, kind);
    append_rows(reading, bytes, 8 * payload, rows);
    std::size_t bits = 0;
    for (const BitRow& row : rows) {
      bits += row.bits;
    }
    append_rest(reading, bytes, rest, payload + bits / 8);
  };
  const auto type = gige::decode_payload_type(packet->payload);
  const bool parts =
      type.ok() && (*type & ~gige::PayloadType::kWithChunks) == gige::PayloadType::kMultipart;
  switch (header.format) {
    case gige::PacketFormat::leader:
      tell("leader", parts ? std::span<const BitRow>(kMultipartLeaderRows) : kImageLeaderRows,
           "further parts");
      break;
    case gige::PacketFormat::trailer:
      tell("trailer", std::span<const BitRow>(kImageTrailerRows).first(parts ? 2 : 3), "chunks");
      break;
    case gige::PacketFormat::payload:
      tell("payload", {}, "pixels");
      break;
    case gige::PacketFormat::multipart:
      tell("payload", kMultipartPayloadRows, "pixels");
      break;
  }
  return reading;
}

WireReading read_control_packet(std::span<const std::uint8_t> bytes) {
  WireReading reading;
  if (bytes.size() < gige::kGvcpHeaderSize) {
    return reading;
  }
  const bool command = bytes.front() == gige::kCommandKey;
  const auto code = protocols::load_big<std::uint16_t>(bytes, 2);
  reading.text = fmt::format("GVCP {} 0x{:04X}", command ? "command" : "acknowledge", code);
  append_rows(reading, bytes, 0,
              command ? std::span<const BitRow>(kCommandRows) : kAcknowledgeRows);
  if (command && code == static_cast<std::uint16_t>(gige::CommandCode::write_registers)) {
    for (std::size_t at = gige::kGvcpHeaderSize; at + 8 <= bytes.size(); at += 8) {
      append_rows(reading, bytes, 8 * at, kWriteRows);
    }
  } else {
    append_rest(reading, bytes, "payload", gige::kGvcpHeaderSize);
  }
  return reading;
}

const can::OwnedMessage* message_of(const can::Frame& frame,
                                    std::span<const can::OwnedMessage> messages) {
  const auto found = std::ranges::find_if(messages, [&](const can::OwnedMessage& known) {
    return known.id == frame.id && known.extended == frame.extended;
  });
  return found == messages.end() || frame.remote ? nullptr : &*found;
}

WireReading read_frame(const can::Frame& frame, std::span<const can::OwnedMessage> messages) {
  WireReading reading{can::frame_text(frame), {}};
  const can::OwnedMessage* const message = message_of(frame, messages);
  if (message == nullptr) {
    return reading;
  }
  reading.text += " " + message->name;
  const auto payload = frame.payload();
  for (std::size_t i = 0; i < message->signals.size(); ++i) {
    const can::Reading told = can::get(*message, i, payload);
    if (!told.valid()) {
      continue;
    }
    const auto& signal = message->signals[i];
    WireField field{
        signal.name,
        fmt::format("{:.6g}{}{}", told.value, signal.unit.empty() ? "" : " ", signal.unit), 0, 0};
    for (std::size_t byte = 0; byte < payload.size(); ++byte) {
      if (can::bits_in(signal, byte) != 0) {
        field.from = field.bytes == 0 ? byte : field.from;
        field.bytes = byte + 1 - field.from;
      }
    }
    reading.text += fmt::format(" {}={}", field.name, field.value);
    reading.fields.push_back(std::move(field));
  }
  return reading;
}

}  // namespace rigwire::hil
