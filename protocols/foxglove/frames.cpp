#include "protocols/foxglove/frames.h"

#include <bit>
#include <concepts>

#include "protocols/bytes.h"

namespace rigwire::protocols::foxglove {
namespace {

enum class ServerOpcode : std::uint8_t {
  message = 0x01,
  time = 0x02,
  service_response = 0x03,
  asset = 0x04,
  playback_state = 0x05,
};
enum class ClientOpcode : std::uint8_t { service_request = 0x02, playback_control = 0x03 };

class Frame {
 public:
  explicit Frame(ServerOpcode opcode, std::size_t room) {
    bytes_.reserve(room + 32);
    put(static_cast<std::uint8_t>(opcode));
  }
  template <std::unsigned_integral Number>
  void put(Number number) {
    std::array<std::uint8_t, sizeof(Number)> bytes{};
    store_little(std::span(bytes), 0, number);
    bytes_.append(bytes.begin(), bytes.end());
  }
  void put(std::string_view text) { bytes_ += text; }
  void put_counted(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put(text);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class FrameReader {
 public:
  explicit FrameReader(std::string_view bytes)
      : bytes_(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), text_(bytes) {}

  /// 0 once the frame has ended early.
  template <std::unsigned_integral Number>
  Number take() {
    if (bytes_.size() - at_ < sizeof(Number)) {
      return fail<Number>();
    }
    const auto number = load_little<Number>(bytes_, at_);
    at_ += sizeof(Number);
    return number;
  }
  std::string_view take_counted() {
    const auto size = take<std::uint32_t>();
    if (size > bytes_.size() - at_) {
      return fail<std::string_view>();
    }
    at_ += size;
    return text_.substr(at_ - size, size);
  }
  std::string_view rest() { return text_.substr(at_); }
  [[nodiscard]] bool ended_early() const { return ended_early_; }
  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  template <class T>
  T fail() {
    ended_early_ = true;
    at_ = bytes_.size();
    return {};
  }

  std::span<const std::uint8_t> bytes_;
  std::string_view text_;
  std::size_t at_ = 0;
  bool ended_early_ = false;
};

}  // namespace

std::string message_frame(std::uint32_t subscription, std::uint64_t time_ns,
                          std::string_view payload) {
  Frame frame(ServerOpcode::message, payload.size());
  frame.put(subscription);
  frame.put(time_ns);
  frame.put(payload);
  return frame.take();
}

std::string time_frame(std::uint64_t time_ns) {
  Frame frame(ServerOpcode::time, 0);
  frame.put(time_ns);
  return frame.take();
}

std::string service_response_frame(std::uint32_t service, std::uint32_t call,
                                   std::string_view encoding, std::string_view payload) {
  Frame frame(ServerOpcode::service_response, encoding.size() + payload.size());
  frame.put(service);
  frame.put(call);
  frame.put_counted(encoding);
  frame.put(payload);
  return frame.take();
}

std::string asset_frame(std::uint32_t request, std::string_view data) {
  Frame frame(ServerOpcode::asset, data.size());
  frame.put(request);
  frame.put(std::uint8_t{0});
  frame.put_counted("");
  frame.put(data);
  return frame.take();
}

std::string asset_error_frame(std::uint32_t request, std::string_view error) {
  Frame frame(ServerOpcode::asset, error.size());
  frame.put(request);
  frame.put(std::uint8_t{1});
  frame.put_counted(error);
  return frame.take();
}

std::string playback_state_frame(PlaybackStatus status, std::uint64_t time_ns, float speed,
                                 bool did_seek, std::string_view request) {
  Frame frame(ServerOpcode::playback_state, request.size());
  frame.put(static_cast<std::uint8_t>(status));
  frame.put(time_ns);
  frame.put(std::bit_cast<std::uint32_t>(speed));
  frame.put(static_cast<std::uint8_t>(did_seek ? 1 : 0));
  frame.put_counted(request);
  return frame.take();
}

Decoded<ClientFrame> decode_client_frame(std::string_view bytes) {
  FrameReader reader(bytes);
  const auto opcode = static_cast<ClientOpcode>(reader.take<std::uint8_t>());
  if (opcode == ClientOpcode::service_request) {
    ServiceRequest request;
    request.service = reader.take<std::uint32_t>();
    request.call = reader.take<std::uint32_t>();
    request.encoding = reader.take_counted();
    request.payload = reader.rest();
    if (!reader.ended_early()) {
      return {request, bytes.size()};
    }
  } else if (opcode == ClientOpcode::playback_control) {
    PlaybackControl control;
    const auto command = reader.take<std::uint8_t>();
    control.plays = command == 0;
    control.speed = std::bit_cast<float>(reader.take<std::uint32_t>());
    const bool seeks = reader.take<std::uint8_t>() != 0;
    const auto time_ns = reader.take<std::uint64_t>();
    if (seeks) {
      control.seek_ns = time_ns;
    }
    control.request = reader.take_counted();
    if (command > 1) {
      return Malformed{"a playback command of 0 or 1", 1};
    }
    if (!reader.ended_early() && !reader.at_end()) {
      return Malformed{"the end of the frame", reader.at()};
    }
    if (!reader.ended_early()) {
      return {control, bytes.size()};
    }
  } else {
    return Malformed{"a service request (2) or playback control (3)", 0};
  }
  return Malformed{"a frame as long as its lengths say", bytes.size()};
}

}  // namespace rigwire::protocols::foxglove
