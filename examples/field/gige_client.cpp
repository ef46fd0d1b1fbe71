#include "field/gige_client.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "protocols/bytes.h"
#include "protocols/gige_vision/bootstrap.h"

namespace rigwire::field {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;

namespace {

constexpr std::uint32_t kUrlBytes = 512;
constexpr std::uint32_t kMemoryAtOnce = 512;
/// Beats within the time after which the camera would be free.
constexpr int kBeats = 3;
/// After these a packet passes every network.
constexpr std::uint32_t kEthernetPacket = 1500;
constexpr std::uint32_t kSmallestPacket = 576;

std::string status_text(gev::Status status) {
  switch (status) {
    case gev::Status::not_implemented:
      return "not implemented";
    case gev::Status::invalid_parameter:
      return "invalid parameter";
    case gev::Status::invalid_address:
      return "invalid address";
    case gev::Status::write_protect:
      return "write protected";
    case gev::Status::bad_alignment:
      return "bad alignment";
    case gev::Status::access_denied:
      return "access denied";
    case gev::Status::busy:
      return "busy";
    default: {
      std::array<char, 16> text{};
      (void)std::snprintf(text.data(), text.size(), "status 0x%04X", static_cast<unsigned>(status));
      return text.data();
    }
  }
}

std::string text_of(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), std::ranges::find(bytes, std::uint8_t{0})};
}

std::string address_text(std::uint32_t address) {
  std::string text;
  for (unsigned shift = 32; shift > 0; shift -= 8) {
    text += (text.empty() ? "" : ".") + std::to_string((address >> (shift - 8)) & 0xFFU);
  }
  return text;
}

GigeStreamCounters sum(const GigeStreamCounters& a, const GigeStreamCounters& b) {
  return {a.packets + b.packets, a.refused + b.refused, a.duplicates + b.duplicates,
          a.asked + b.asked,     a.blocks + b.blocks,   a.dropped + b.dropped};
}

}  // namespace

GigeClient::GigeClient(GigeClientSettings settings, const Local& local, Handlers handlers)
    : settings_(std::move(settings)), local_(local), handlers_(std::move(handlers)) {}

void GigeClient::start(Instant now) {
  now_ = now;
  search();
}

std::optional<double> GigeClient::reading(std::string_view feature) const {
  const auto found = readings_.find(feature);
  return found == readings_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<double> GigeClient::chunk(const GigeBlock& block, std::string_view name) const {
  if (!description_ || !description_->has(name)) {
    return std::nullopt;
  }
  try {
    const GigeFeature feature = description_->find(name);
    for (const gev::Chunk& chunk : block.chunks) {
      if (feature.chunk == chunk.id && feature.kind != GigeFeature::Kind::text &&
          feature.address <= chunk.bytes.size() &&
          feature.length <= chunk.bytes.size() - feature.address) {
        return feature.decode(chunk.bytes.data() + feature.address);
      }
    }
  } catch (const DescriptionError&) {
    return std::nullopt;  // it is there in a form that is not read
  }
  return std::nullopt;
}

GigeStreamCounters GigeClient::stream_counters() const {
  return stream_ ? sum(before_, stream_->counters()) : before_;
}

// --- Commands and their answers. -------------------------------------------------------------

void GigeClient::ask(Request request) {
  requests_.push_back(std::move(request));
  if (!pending_) {
    next_request();
  }
}

void GigeClient::next_request() {
  request_ = request_ == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(request_ + 1);
  tries_ = 0;
  pending_ = true;
  transmit();
}

void GigeClient::transmit() {
  ++tries_;
  answer_by_ = now_ + kAnswerTimeout;
  handlers_.send(requests_.front().make(request_).view());
}

void GigeClient::receive_control(Instant now, std::span<const std::uint8_t> datagram) {
  now_ = now;
  const auto acknowledge = gev::decode_acknowledge(datagram);
  if (!acknowledge.ok() || !pending_ || acknowledge->request != request_) {
    ++counters_.refused;
    return;
  }
  if (acknowledge->acknowledge == gev::kPendingAcknowledge) {
    const auto milliseconds = gev::decode_count(*acknowledge);
    if (milliseconds.ok()) {
      answer_by_ = now + std::chrono::milliseconds{*milliseconds};
    }
    return;
  }
  answered(*acknowledge);
}

void GigeClient::answered(const Acknowledge& acknowledge) {
  const Request request = std::move(requests_.front());
  requests_.pop_front();
  pending_ = false;
  wake_ = now_ + settings_.heartbeat / kBeats;
  if (is_error(acknowledge.status) && !request.refusable) {
    return fail(request.what + " is refused: " + status_text(acknowledge.status));
  }
  request.then(acknowledge);
  if (!pending_ && !requests_.empty()) {
    next_request();
  }
}

void GigeClient::read_bytes(std::uint32_t address, std::uint32_t count, const std::string& what,
                            bool refusable,
                            std::function<void(std::optional<std::vector<std::uint8_t>>)> then) {
  const auto rounded = static_cast<std::uint16_t>((count + 3) / 4 * 4);
  ask({[address, rounded](std::uint16_t request) {
         return gev::encode_read_memory(request, address, rounded);
       },
       what,
       [this, address, rounded, what, then = std::move(then)](const Acknowledge& acknowledge) {
         if (is_error(acknowledge.status)) {
           return then(std::nullopt);
         }
         const auto content = gev::decode_memory(acknowledge);
         if (!content.ok() || content->address != address || content->bytes.size() != rounded) {
           return fail(what + " is answered with something else");
         }
         then(std::vector<std::uint8_t>(content->bytes.begin(), content->bytes.end()));
       },
       refusable});
}

void GigeClient::read_word(std::uint32_t address, const std::string& what, bool refusable,
                           std::function<void(std::optional<std::uint32_t>)> then) {
  ask({[address](std::uint16_t request) {
         return gev::encode_read_registers(request, std::span(&address, 1));
       },
       what,
       [this, what, then = std::move(then)](const Acknowledge& acknowledge) {
         if (is_error(acknowledge.status)) {
           return then(std::nullopt);
         }
         const auto values = gev::decode_register_values(acknowledge);
         if (!values.ok() || values->size() != 1) {
           return fail(what + " is answered with something else");
         }
         then((*values)[0]);
       },
       refusable});
}

void GigeClient::write_word(std::uint32_t address, std::uint32_t value, const std::string& what,
                            bool refusable, std::function<void(bool)> then) {
  ask({[address, value](std::uint16_t request) {
         const gev::RegisterValue pair{address, value};
         return gev::encode_write_registers(request, std::span(&pair, 1));
       },
       what,
       [then = std::move(then)](const Acknowledge& acknowledge) {
         then(!is_error(acknowledge.status));
       },
       refusable});
}

void GigeClient::write_bytes(std::uint32_t address, std::vector<std::uint8_t> bytes,
                             const std::string& what, bool refusable,
                             std::function<void(bool)> then) {
  if (bytes.size() == 4) {  // every camera knows this command, not all the other one
    return write_word(address, protocols::load_big<std::uint32_t>(bytes, 0), what, refusable,
                      std::move(then));
  }
  ask({[address, bytes = std::move(bytes)](std::uint16_t request) {
         return gev::encode_write_memory(request, address, bytes);
       },
       what,
       [then = std::move(then)](const Acknowledge& acknowledge) {
         then(!is_error(acknowledge.status));
       },
       refusable});
}

void GigeClient::write_feature(const GigeFeature& feature, double value, bool refusable,
                               std::function<void(bool)> then) {
  if (feature.constant || feature.chunk || feature.length % 4 != 0) {
    if (refusable) {
      return then(false);
    }
    return fail(feature.name + " cannot be written");
  }
  const auto put = [this, feature, value, refusable, then](std::vector<std::uint8_t> bytes) {
    feature.encode(value, bytes.data());
    write_bytes(feature.address, std::move(bytes), feature.name, refusable, then);
  };
  if (!feature.partial()) {
    return put(std::vector<std::uint8_t>(feature.length));
  }
  read_bytes(feature.address, feature.length, feature.name, refusable,
             [put, then](std::optional<std::vector<std::uint8_t>> bytes) {
               bytes ? put(std::move(*bytes)) : then(false);
             });
}

void GigeClient::read_feature(const GigeFeature& feature, bool refusable,
                              std::function<void(std::optional<double>)> then) {
  if (feature.constant) {
    return then(feature.constant);
  }
  if (feature.chunk || feature.kind == GigeFeature::Kind::text) {
    if (refusable) {
      return then(std::nullopt);
    }
    return fail(feature.name + " is no number of the camera's");
  }
  if (feature.length == 4) {
    return read_word(feature.address, feature.name, refusable,
                     [feature, then](std::optional<std::uint32_t> word) {
                       if (!word) {
                         return then(std::nullopt);
                       }
                       std::array<std::uint8_t, 4> bytes{};
                       protocols::store_big(std::span<std::uint8_t>(bytes), 0, *word);
                       then(feature.decode(bytes.data()));
                     });
  }
  read_bytes(feature.address, feature.length, feature.name, refusable,
             [feature, then](const std::optional<std::vector<std::uint8_t>>& bytes) {
               then(bytes ? std::optional(feature.decode(bytes->data())) : std::nullopt);
             });
}

// --- A session. ------------------------------------------------------------------------------

void GigeClient::search() {
  state_ = State::searching;
  ask({[](std::uint16_t request) { return gev::encode_discovery(request); }, "DISCOVERY",
       [this](const Acknowledge& acknowledge) { identify(acknowledge); }});
}

void GigeClient::identify(const Acknowledge& acknowledge) {
  if (acknowledge.payload.size() < gev::kDiscoverySize) {
    return fail("DISCOVERY is answered with something else");
  }
  const auto text = [&](std::uint32_t address, std::size_t length) {
    return text_of(acknowledge.payload.subspan(address, length));
  };
  identity_ = {text(boot::kManufacturerName, 32), text(boot::kModelName, 32),
               text(boot::kSerialNumber, 16), text(boot::kUserDefinedName, 16)};
  state_ = State::opening;
  read_bytes(boot::kFirstUrl, kUrlBytes, "the description's place", false,
             [this](const std::optional<std::vector<std::uint8_t>>& url) {
               try {
                 read_description(read_gige_url(text_of(*url)));
               } catch (const DescriptionError& error) {
                 fail(error.what());
               }
             });
}

void GigeClient::read_description(GigeUrl url) {
  const auto done = static_cast<std::uint32_t>(description_bytes_.size());
  const std::uint32_t count = std::min(url.size - done, kMemoryAtOnce);
  read_bytes(
      url.address + done, count, "the description", false,
      [this, url, count](const std::optional<std::vector<std::uint8_t>>& bytes) {
        description_bytes_.insert(description_bytes_.end(), bytes->begin(), bytes->begin() + count);
        if (description_bytes_.size() < url.size) {
          return read_description(url);
        }
        try {
          description_.emplace(std::string_view(
              reinterpret_cast<const char*>(description_bytes_.data()), description_bytes_.size()));
        } catch (const DescriptionError& error) {
          return fail(error.what());
        }
        take_control();
      });
}

void GigeClient::take_control() {
  write_word(boot::kControlPrivilege, gev::Privilege::kControl, "control", true, [this](bool ok) {
    if (!ok) {
      return tell_who_controls();
    }
    controls_ = true;
    write_word(boot::kHeartbeatTimeout, static_cast<std::uint32_t>(settings_.heartbeat.count()),
               "the heartbeat's time", false, [this](bool) {
                 read_word(boot::kCapability, "the camera's capability", true,
                           [this](std::optional<std::uint32_t> bits) {
                             can_resend_ = (bits.value_or(0) & gev::Capability::kPacketResend) != 0;
                             ask_for_parts();
                           });
               });
  });
}

void GigeClient::tell_who_controls() {
  read_word(boot::kPrimaryAddress, "who has control", true,
            [this](std::optional<std::uint32_t> address) {
              fail("another application has control" +
                   (address.value_or(0) != 0 ? " (" + address_text(*address) + ")" : ""));
            });
}

void GigeClient::ask_for_parts() {
  if (!settings_.multipart) {
    return set(0);
  }
  read_word(boot::kStreamChannelCapability, "the stream channel's capability", true,
            [this](std::optional<std::uint32_t> bits) {
              if ((bits.value_or(0) & gev::StreamChannel::kMultipart) == 0) {
                return set(0);
              }
              write_word(boot::kStreamChannelConfiguration, gev::StreamChannel::kMultipart,
                         "multi-part", true, [this](bool) { set(0); });
            });
}

std::optional<GigeFeature> GigeClient::feature(std::string_view name, bool may_be_missing) {
  try {
    return description_->find(name);
  } catch (const DescriptionError& error) {
    if (!may_be_missing) {
      fail(error.what());
    }
    return std::nullopt;
  }
}

void GigeClient::set(std::size_t index) {
  if (index == settings_.settings.size()) {
    return read(0);
  }
  const GigeSetting& setting = settings_.settings[index];
  auto target = feature(setting.feature, setting.optional);
  auto selector = target && !setting.selector.empty() ? feature(setting.selector, setting.optional)
                                                      : std::nullopt;
  if (!target || (!setting.selector.empty() && !selector)) {
    return setting.optional ? set(index + 1) : void();
  }
  try {
    const double value = target->value_of(setting.value);
    const auto write = [this, index, value, optional = setting.optional](const GigeFeature& at) {
      write_feature(at, value, optional, [this, index](bool) { set(index + 1); });
    };
    if (!selector) {
      return write(*target);
    }
    const double selected = selector->value_of(setting.selected);
    target->address += target->stride * static_cast<std::uint32_t>(selected);
    write_feature(
        *selector, selected, setting.optional,
        [this, index, write, target = *target](bool ok) { ok ? write(target) : set(index + 1); });
  } catch (const DescriptionError& error) {
    setting.optional ? set(index + 1) : fail(error.what());
  }
}

void GigeClient::read(std::size_t index) {
  if (index == settings_.readings.size()) {
    return open_stream();
  }
  const GigeReading& reading = settings_.readings[index];
  const auto source = feature(reading.feature, reading.optional);
  if (!source) {
    return reading.optional ? read(index + 1) : void();
  }
  read_feature(*source, reading.optional,
               [this, index, name = reading.feature](std::optional<double> value) {
                 if (value) {
                   readings_[name] = *value;
                 }
                 read(index + 1);
               });
}

void GigeClient::open_stream() {
  read_bytes(boot::kTickFrequencyHigh, 8, "the tick frequency", true,
             [this](const std::optional<std::vector<std::uint8_t>>& bytes) {
               tick_frequency_hz_ =
                   bytes ? static_cast<double>(protocols::load_big<std::uint64_t>(*bytes, 0)) : 0.0;
             });
  write_word(boot::kStreamDestination, local_.address, "the stream's destination", false,
             [](bool) {});
  write_word(boot::kStreamPort, local_.stream_port, "the stream's port", false, [this](bool) {
    sizes_ = {kSmallestPacket};
    for (const std::uint32_t size : {kEthernetPacket, settings_.packet_size}) {
      if (size > sizes_.back()) {
        sizes_.push_back(size);
      }
    }
    test_packets();
  });
}

void GigeClient::test_packets() {
  if (sizes_.empty()) {
    // No camera has to send test packets: what every Ethernet carries is tried without.
    return write_word(boot::kStreamPacketSize, kEthernetPacket, "the packet size", false,
                      [this](bool) { tested(kEthernetPacket); });
  }
  const std::uint32_t size = sizes_.back();
  sizes_.pop_back();
  test_packet_.reset();
  const std::uint32_t fire = size | gev::PacketSize::kFireTest | gev::PacketSize::kDoNotFragment;
  write_word(boot::kStreamPacketSize, fire, "the packet size", true, [this](bool ok) {
    if (!ok) {
      return test_packets();
    }
    // The camera may have taken a size near it.
    read_word(boot::kStreamPacketSize, "the packet size", false,
              [this](std::optional<std::uint32_t> word) {
                test_size_ = *word & gev::PacketSize::kSize;
                test_until_ = now_ + kTestPacketTimeout;
              });
  });
}

void GigeClient::tested(std::uint32_t size) {
  test_until_.reset();
  packet_size_ = size;
  const auto payload = feature("PayloadSize", false);
  if (!payload) {
    return;
  }
  read_feature(*payload, false, [this](std::optional<double> bytes) {
    if (*bytes < 1 || *bytes > kLongestPayload) {
      return fail("PayloadSize is " + std::to_string(*bytes) + ", allowed 1.." +
                  std::to_string(kLongestPayload));
    }
    begin_stream(static_cast<std::uint32_t>(*bytes));
  });
}

void GigeClient::begin_stream(std::uint32_t payload_bytes) {
  if (packet_size_ < kSmallestPacket) {
    return fail("the packet size is " + std::to_string(packet_size_) + ", allowed " +
                std::to_string(kSmallestPacket) + " or more");
  }
  const auto begin = feature("AcquisitionStart", false);
  if (!begin) {
    return;
  }
  before_ = stream_counters();
  stream_.emplace(
      GigeStreamSettings{packet_size_, payload_bytes, can_resend_},
      [this](const gev::PacketResend& resend) {
        // Packets are its answer: it needs no number of its own.
        handlers_.send(gev::encode_packet_resend(request_ == 0 ? 1 : request_, resend).view());
      },
      [this](const GigeBlock& block) { handlers_.block(block); });
  // Notifies the reader before the first picture can come.
  if (handlers_.streaming) {
    handlers_.streaming();
  }
  write_feature(*begin, static_cast<double>(begin->command_value), false, [this](bool) {
    ++counters_.sessions;
    state_ = State::streaming;
    trouble_.clear();
  });
}

void GigeClient::beat() {
  read_word(boot::kControlPrivilege, "the heartbeat", false,
            [this](std::optional<std::uint32_t> privilege) {
              if ((*privilege & (gev::Privilege::kControl | gev::Privilege::kExclusive)) == 0) {
                controls_ = false;
                fail("control was lost");
              }
            });
}

void GigeClient::leave_stream() {
  if (!controls_) {
    return;
  }
  controls_ = false;
  const auto tell = [this](std::uint32_t address, std::uint32_t value) {
    request_ = request_ == 0xFFFF ? std::uint16_t{1} : static_cast<std::uint16_t>(request_ + 1);
    const gev::RegisterValue pair{address, value};
    handlers_.send(gev::encode_write_registers(request_, std::span(&pair, 1)).view());
  };
  if (description_ && description_->has("AcquisitionStop")) {
    try {
      const GigeFeature end = description_->find("AcquisitionStop");
      if (!end.constant && end.length == 4) {
        std::array<std::uint8_t, 4> bytes{};
        end.encode(static_cast<double>(end.command_value), bytes.data());
        tell(end.address, protocols::load_big<std::uint32_t>(bytes, 0));
      }
    } catch (const DescriptionError&) {
      // The end of control ends the acquisition as well.
    }
  }
  tell(boot::kStreamPort, 0);
  tell(boot::kControlPrivilege, 0);
}

void GigeClient::fail(const std::string& why) {
  counters_.losses += state_ == State::streaming ? 1U : 0U;
  trouble_ = why;
  leave_stream();
  requests_.clear();
  pending_ = false;
  test_until_.reset();
  before_ = stream_counters();
  stream_.reset();
  description_.reset();
  description_bytes_.clear();
  readings_.clear();
  state_ = State::waiting;
  wake_ = now_ + kPause;
  if (handlers_.ended) {
    handlers_.ended();
  }
}

void GigeClient::stop() {
  leave_stream();
  requests_.clear();
  pending_ = false;
  before_ = stream_counters();
  stream_.reset();
  state_ = State::waiting;
  wake_ = Instant::max();
}

void GigeClient::receive_stream(Instant now, std::span<const std::uint8_t> datagram) {
  now_ = now;
  if (stream_) {
    stream_->receive(now, datagram);
  } else {
    test_packet_ = datagram.size() + gev::kIpUdpHeaders;
  }
}

void GigeClient::advance(Instant now) {
  now_ = now;
  if (stream_) {
    stream_->advance(now);
  }
  if (test_until_) {
    if (test_packet_ == test_size_) {
      tested(test_size_);
    } else if (*test_until_ <= now) {
      test_until_.reset();
      test_packets();
    }
  }
  if (pending_) {
    if (answer_by_ <= now) {
      if (tries_ >= kTries) {
        return fail("it does not answer");
      }
      ++counters_.repeated;
      transmit();
    }
  } else if (wake_ <= now && !test_until_) {
    if (state_ == State::waiting) {
      search();
    } else {
      beat();
    }
  }
}

GigeClient::Instant GigeClient::next_event() const {
  Instant at = pending_ ? answer_by_ : wake_;
  if (test_until_) {
    at = test_packet_ == test_size_ ? now_ : std::min(at, *test_until_);
  }
  if (stream_) {
    at = std::min(at, stream_->next_event().value_or(at));
  }
  return at;
}

}  // namespace rigwire::field
