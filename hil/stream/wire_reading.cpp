#include "hil/stream/wire_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <string_view>
#include <type_traits>

#include "hil/configuration/plain_text.h"
#include "hil/record/byte_place.h"
#include "protocols/can/frame_text.h"
#include "protocols/can/signal.h"
#include "protocols/nmea/field_names.h"
#include "protocols/nmea/sentence.h"
#include "protocols/ubx/blocks.h"
#include "protocols/ubx/configuration.h"
#include "protocols/ubx/frame.h"
#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation.h"
#include "protocols/velodyne/data_packet.h"

namespace rigwire::hil {
namespace {

namespace can = protocols::can;
namespace nmea = protocols::nmea;
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
constexpr std::string_view kNames<ubx::NavPvt> =
    "time of week, ms;year;month;day;hour;minute;second;valid;time accuracy, ns;nanosecond;fix "
    "type;flags;flags 2;satellites used;longitude, 1e-7 deg;latitude, 1e-7 deg;height above "
    "ellipsoid, mm;height above sea level, mm;horizontal accuracy, mm;vertical accuracy, "
    "mm;velocity north, east, down, mm/s;ground speed, mm/s;heading of motion, 1e-5 deg;speed "
    "accuracy, mm/s;heading accuracy, 1e-5 deg;position dilution, 0.01";
template <>
constexpr std::string_view kNames<ubx::NavPvt92> =
    "time of week, ms;year;month;day;hour;minute;second;valid;time accuracy, ns;nanosecond;fix "
    "type;flags;flags 2;satellites used;longitude, 1e-7 deg;latitude, 1e-7 deg;height above "
    "ellipsoid, mm;height above sea level, mm;horizontal accuracy, mm;vertical accuracy, "
    "mm;velocity north, east, down, mm/s;ground speed, mm/s;heading of motion, 1e-5 deg;speed "
    "accuracy, mm/s;heading accuracy, 1e-5 deg;position dilution, 0.01;flags 3;heading of vehicle, "
    "1e-5 deg;declination, 0.01 deg;declination accuracy, 0.01 deg";
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

/// Of a payload, or of a part of it that begins at byte `from` of the frame.
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
