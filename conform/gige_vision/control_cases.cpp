// What a camera answers to any application, without control: discovery, registers, memory, its
// description, and how it refuses.
#include <algorithm>
#include <array>
#include <charconv>

#include "conform/gige_vision/gige_vision_trial.h"

namespace rigwire::conform {

namespace gev = protocols::gige_vision;
namespace boot = protocols::gige_vision::bootstrap;

namespace {

using T = GigeVisionTrial;
using Bytes = GigeBytes;

constexpr std::uint32_t kNowhere = 0xFFFF'FFF0;
constexpr unsigned kMemoryMaximum = 536;

// --- discovery ---

std::optional<Bytes> discovery(T& trial) {
  const auto found = trial.ask(Gvcp::kDiscovery, {});
  if (!found || !trial.demand(found->good(), "success", gige_status_text(found->status)) ||
      !trial.demand(found->payload.size() == gev::kDiscoverySize, "248 bytes",
                    std::to_string(found->payload.size()))) {
    return std::nullopt;
  }
  return found->payload;
}
std::optional<std::uint32_t> told(T& trial, std::uint32_t address) {
  const auto bytes = discovery(trial);
  T::Answer words;
  if (!bytes) {
    return std::nullopt;
  }
  words.payload = *bytes;
  return words.word(address / 4);
}

void answered(T& trial) {
  static_cast<void>(discovery(trial));
}

void not_asked(T& trial) {
  if (trial.send(T::framed(Gvcp::kDiscovery, {}, trial.next_request(), 0),
                 "DISCOVERY without acknowledge")) {
    trial.silent("a command that wants no acknowledge");
  }
}

void same_as_registers(T& trial) {
  const auto one = discovery(trial);
  const auto two = one ? trial.read_memory(0, gev::kDiscoverySize) : std::nullopt;
  if (two) {
    const auto differs = std::ranges::mismatch(*one, *two);
    trial.expect(differs.in1 == one->end(), "the registers from 0 on",
                 "another byte at " +
                     gige_address_text(static_cast<std::uint32_t>(differs.in1 - one->begin())));
  }
}

void version(T& trial) {
  if (const auto value = told(trial, boot::kVersion)) {
    const unsigned major = *value >> 16U;
    trial.expect(major == 1 || major == 2, "version 1 or 2 of the protocol",
                 std::to_string(major) + "." + std::to_string(*value & 0xFFFFU));
  }
}

void big_endian(T& trial) {
  if (const auto value = told(trial, boot::kDeviceMode)) {
    trial.expect((*value & 0x8000'0000U) != 0, "big-endian in the device mode",
                 gige_address_text(*value));
  }
}

void character_set(T& trial) {
  if (const auto value = told(trial, boot::kDeviceMode)) {
    trial.expect((*value & 0xFFU) == 1, "character set 1 (UTF-8) in the device mode",
                 std::to_string(*value & 0xFFU));
  }
}

void hardware_address(T& trial) {
  const auto bytes = discovery(trial);
  if (bytes) {
    const Bytes address(bytes->begin() + 10, bytes->begin() + 16);
    trial.expect(std::ranges::any_of(address, [](std::uint8_t byte) { return byte != 0; }) &&
                     (address[0] & 1U) == 0,
                 "a MAC address of one device", hex_text(address));
  }
}

void own_address(T& trial) {
  if (const auto value = told(trial, boot::kCurrentAddress)) {
    std::string text;
    for (const unsigned shift : std::array{24U, 16U, 8U, 0U}) {
      text += (text.empty() ? "" : ".") + std::to_string(*value >> shift & 0xFFU);
    }
    trial.expect(text == trial.device().camera.address, trial.device().camera.address, text);
  }
}

void mask(T& trial) {
  if (const auto value = told(trial, boot::kCurrentMask)) {
    const std::uint32_t zeros = ~*value;
    trial.expect((zeros & (zeros + 1U)) == 0, "ones, then zeros in the mask",
                 gige_address_text(*value));
  }
}

void texts(T& trial) {
  const auto bytes = discovery(trial);
  for (const gev::RegisterRow& row : gev::kBootstrapRegisters) {
    if (!bytes || row.length <= 4 || row.address + row.length > bytes->size()) {
      continue;
    }
    const auto begin = bytes->begin() + static_cast<std::ptrdiff_t>(row.address);
    const auto end = begin + static_cast<std::ptrdiff_t>(row.length);
    const auto zero = std::find(begin, end, std::uint8_t{0});
    trial.expect(std::none_of(begin, zero, [](std::uint8_t c) { return c < 0x20 || c == 0x7F; }),
                 "no control characters in " + std::string(row.name), hex_text({begin, zero}));
    trial.expect(std::all_of(zero, end, [](std::uint8_t c) { return c == 0; }),
                 "zeros behind the text of " + std::string(row.name), hex_text({begin, end}));
  }
}

void names(T& trial) {
  for (const std::uint32_t address : std::array{boot::kManufacturerName, boot::kModelName}) {
    if (const auto text = trial.read_text(address, 32)) {
      trial.expect(!text->empty(), "a maker's and a model's name", "none");
    }
  }
}

// --- registers ---

struct Mandatory {
  std::uint32_t address;
  std::uint32_t least;
  std::uint32_t greatest;
};
constexpr std::uint32_t kAny = 0xFFFF'FFFF;
// Mandatory registers of a camera with a stream, and the allowed values.
constexpr std::array<Mandatory, 20> kMandatory{{
    {boot::kVersion, 0x0001'0000, 0x0002'FFFF},
    {boot::kDeviceMode, 0x8000'0000, kAny},
    {boot::kMacHigh, 0, 0xFFFF},
    {boot::kMacLow, 0, kAny},
    {boot::kIpCapability, 4, kAny},  // LLA is everybody's.
    {boot::kIpConfiguration, 4, kAny},
    {boot::kCurrentAddress, 1, kAny},
    {boot::kCurrentMask, 0, kAny},
    {boot::kCurrentGateway, 0, kAny},
    {boot::kInterfaceCount, 1, 4},
    {boot::kMessageChannelCount, 0, 1},
    {boot::kStreamChannelCount, 1, 512},
    {boot::kCapability, 0, kAny},
    {boot::kHeartbeatTimeout, 500, kAny},
    {boot::kTickFrequencyHigh, 0, kAny},
    {boot::kTickFrequencyLow, 0, kAny},
    {boot::kControlPrivilege, 0, 3},
    {boot::kStreamPort, 0, kAny},
    {boot::kStreamPacketSize, 0, kAny},
    {boot::kStreamDestination, 0, kAny},
}};

template <std::size_t index>
void mandatory(T& trial) {
  const Mandatory& row = kMandatory[index];
  if (const auto value = trial.read(row.address)) {
    trial.expect(*value >= row.least && *value <= row.greatest,
                 gige_address_text(row.least) + " to " + gige_address_text(row.greatest),
                 gige_address_text(*value));
  }
}

void as_memory(T& trial) {
  const auto one = trial.read(boot::kCurrentAddress);
  const auto two = one ? trial.read_memory(boot::kCurrentAddress, 4) : std::nullopt;
  if (two) {
    trial.expect(gige_word(*one) == *two, "the same value by READMEM", hex_text(*two));
  }
}

void several(T& trial, std::size_t count) {
  Bytes payload;
  for (std::size_t i = 0; i < count; ++i) {
    payload = std::move(payload) + gige_word(i % 2 == 0 ? boot::kVersion : boot::kCurrentAddress);
  }
  const auto version = trial.read(boot::kVersion);
  const auto address = version ? trial.read(boot::kCurrentAddress) : std::nullopt;
  const auto found = address ? trial.ask(Gvcp::kReadRegisters, payload) : std::nullopt;
  if (!found || !trial.expect(found->good() && found->words() == count,
                              std::to_string(count) + " values", gige_status_text(found->status))) {
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    trial.expect(found->word(i) == (i % 2 == 0 ? *version : *address),
                 "values in the order of their addresses", "another at " + std::to_string(i));
  }
}

void nobody(T& trial) {
  if (const auto value = trial.read(boot::kControlPrivilege)) {
    trial.expect(*value == 0, "no controlling application", gige_address_text(*value));
  }
}

// --- memory ---

template <unsigned count>
void reads(T& trial) {
  static_cast<void>(trial.read_memory(boot::kFirstUrl, count));
}

void in_pieces(T& trial) {
  const auto whole = trial.read_memory(boot::kFirstUrl, 64);
  const auto first = whole ? trial.read_memory(boot::kFirstUrl, 32) : std::nullopt;
  const auto second = first ? trial.read_memory(boot::kFirstUrl + 32, 32) : std::nullopt;
  if (second) {
    trial.expect(*first + *second == *whole, "in two pieces the same bytes", hex_text(*second));
  }
}

template <std::uint32_t address, unsigned count, GigeStatus right>
void memory_refused(T& trial) {
  trial.refused(Gvcp::kReadMemory, gige_word(address) + gige_word(count), right);
}

void short_memory(T& trial) {
  trial.refused(Gvcp::kReadMemory, gige_word(0), GigeStatus::invalid_header);
}

// --- description ---

struct Url {
  std::string name;
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};

/// "Local:NAME;ADDRESS;SIZE", the numbers in hexadecimal.
std::optional<Url> local_url(const std::string& text) {
  std::string scheme = text.substr(0, 6);
  std::ranges::transform(scheme, scheme.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::size_t first = text.find(';');
  const std::size_t second = first == std::string::npos ? first : text.find(';', first + 1);
  if (scheme != "local:" || second == std::string::npos) {
    return std::nullopt;
  }
  Url url;
  url.name = text.substr(6, first - 6);
  while (url.name.starts_with('/')) {
    url.name.erase(0, 1);
  }
  const std::size_t end = std::min(text.size(), text.find('?', second));
  const auto [after, wrong] =
      std::from_chars(text.data() + first + 1, text.data() + second, url.address, 16);
  const auto [behind, false_size] =
      std::from_chars(text.data() + second + 1, text.data() + end, url.size, 16);
  const bool read = wrong == std::errc() && after == text.data() + second &&
                    false_size == std::errc() && behind == text.data() + end;
  return read ? std::optional(url) : std::nullopt;
}

std::optional<Url> first_url(T& trial) {
  const auto text = trial.read_text(boot::kFirstUrl, 512);
  if (!text) {
    return std::nullopt;
  }
  if (text->starts_with("http:") || text->starts_with("file:")) {
    trial.not_applicable("its description is elsewhere: " + *text);
    return std::nullopt;
  }
  auto url = local_url(*text);
  trial.expect(url.has_value(), "Local:NAME;ADDRESS;SIZE", *text);
  return url;
}

bool is_zip(const Url& url) {
  return url.name.size() > 4 && (url.name.ends_with(".zip") || url.name.ends_with(".ZIP"));
}

void url_form(T& trial) {
  if (const auto url = first_url(trial)) {
    trial.expect(url->size > 0, "a size above 0", "0");
  }
}

void url_extension(T& trial) {
  if (const auto url = first_url(trial)) {
    trial.expect(is_zip(*url) || url->name.ends_with(".xml") || url->name.ends_with(".XML"),
                 "a name that ends with .xml or .zip", url->name);
  }
}

void url_alignment(T& trial) {
  if (const auto url = first_url(trial)) {
    trial.expect(url->address % 4 == 0, "an address of whole words",
                 gige_address_text(url->address));
  }
}

void second_url(T& trial) {
  if (const auto text = trial.read_text(boot::kSecondUrl, 512)) {
    trial.expect(text->empty() || local_url(*text) || text->starts_with("http:") ||
                     text->starts_with("file:"),
                 "nothing, or another URL", *text);
  }
}

void readable(T& trial) {
  if (const auto bytes = gige_description(trial)) {
    trial.observe(std::to_string(bytes->size()) + " bytes");
  }
}

void whole(T& trial) {
  const auto bytes = gige_description(trial);
  if (!bytes) {
    return;
  }
  std::string text(bytes->begin(), bytes->end());
  if (text.starts_with("PK")) {
    trial.expect(text.find("PK\x05\x06") != std::string::npos, "the end of a zip archive", "none");
    return;
  }
  text.erase(text.find_last_not_of(std::string_view("\0 \r\n\t", 5)) + 1);
  trial.expect(text.find('<') != std::string::npos && text.find('<') <= 3 &&
                   text.find("<RegisterDescription") != std::string::npos,
               "a description of registers in XML", text.substr(0, 32));
  trial.expect(text.ends_with("</RegisterDescription>"), "its end",
               text.substr(text.size() - std::min<std::size_t>(32, text.size())));
}

void kind(T& trial) {
  const auto url = first_url(trial);
  const auto bytes = url ? gige_description(trial) : std::nullopt;
  if (bytes) {
    const bool archive = bytes->size() > 1 && (*bytes)[0] == 'P' && (*bytes)[1] == 'K';
    trial.expect(archive == is_zip(*url), is_zip(*url) ? "a zip archive" : "no zip archive",
                 archive ? "one" : "none");
  }
}

void same_again(T& trial) {
  const auto one = gige_description(trial);
  const auto two = one ? gige_description(trial) : std::nullopt;
  if (two) {
    trial.expect(*one == *two, "the same bytes again", "others");
  }
}

void schema(T& trial) {
  const auto bytes = gige_description(trial);
  if (bytes) {
    const std::string text(bytes->begin(), bytes->end());
    const auto value = [&](const std::string& name) {
      const std::size_t at = text.find(name + "=\"");
      const std::size_t begin = at == std::string::npos ? at : at + name.size() + 2;
      return at == std::string::npos ? std::string("?")
                                     : text.substr(begin, text.find('"', begin) - begin);
    };
    trial.observe("schema " + value("SchemaMajorVersion") + "." + value("SchemaMinorVersion") +
                  "." + value("SchemaSubMinorVersion"));
  }
}

// --- refusals and identifiers ---

template <std::uint32_t address, GigeStatus right>
void register_refused(T& trial) {
  trial.refused(Gvcp::kReadRegisters, gige_word(address), right);
}

void no_registers(T& trial) {
  trial.refused(Gvcp::kReadRegisters, {}, GigeStatus::invalid_header);
}
void half_an_address(T& trial) {
  trial.refused(Gvcp::kReadRegisters, {0, 0, 0}, GigeStatus::invalid_header);
}
void unknown_command(T& trial) {
  trial.refused(0x00FE, {}, GigeStatus::not_implemented);
}

void unwritten(T& trial, std::uint16_t command, std::uint32_t address) {
  // Writes the present value, so that nothing changes if it is not refused.
  if (const auto value = trial.read(address)) {
    trial.refused(command, gige_word(address) + gige_word(*value), GigeStatus::access_denied);
  }
}

template <std::uint16_t request>
void identified(T& trial) {
  if (trial.send(T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), request),
                 "READREG, request " + std::to_string(request))) {
    static_cast<void>(trial.answer(Gvcp::kReadRegisters, request));
  }
}

void request_zero(T& trial) {
  if (!trial.send(T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), 0),
                  "READREG, request 0")) {
    return;
  }
  trial.wait(std::chrono::milliseconds(200));
  auto& waiting = trial.device().arrived[T::kOwn];
  const bool good =
      !waiting.empty() && !waiting.front().bytes.empty() && (waiting.front().bytes[0] & 0x80U) == 0;
  trial.expect(!good, "no success for the request 0, which there is not", "success");
}

void repeated(T& trial) {
  const std::uint16_t request = trial.next_request();
  for (int i = 0; i < 2; ++i) {
    if (!trial.send(T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), request),
                    "READREG, the same request") ||
        !trial.answer(Gvcp::kReadRegisters, request)) {
      return;
    }
  }
}

void in_a_row(T& trial) {
  std::vector<std::uint16_t> requests;
  for (int i = 0; i < 10; ++i) {
    requests.push_back(trial.next_request());
    if (!trial.send(T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), requests.back()),
                    "READREG without waiting")) {
      return;
    }
  }
  for (const std::uint16_t request : requests) {
    if (!trial.answer(Gvcp::kReadRegisters, request)) {
      return;
    }
  }
}

void of_two(T& trial) {
  for (const std::size_t port : {T::kOther, T::kOwn}) {
    if (!trial.read(boot::kVersion, port)) {
      return;
    }
  }
}

void read_without_acknowledge(T& trial) {
  if (trial.send(
          T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), trial.next_request(), 0),
          "READREG without acknowledge")) {
    trial.silent("a command that wants no acknowledge");
  }
}

void wrong_key(T& trial) {
  Bytes bytes = T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), trial.next_request());
  bytes[0] = 0x43;
  if (trial.send(bytes, "no key of a command")) {
    trial.silent("what is no command");
  }
}

void short_header(T& trial) {
  if (trial.send({0x42, 1, 0, 0x80}, "half a header")) {
    trial.silent("half a header");
  }
}

/// Refused, or no answer: anything but success.
void no_success(T& trial, const Bytes& bytes, const std::string& about) {
  if (trial.send(bytes, about)) {
    trial.wait(std::chrono::milliseconds(200));
    const auto& waiting = trial.device().arrived[T::kOwn];
    const bool good = !waiting.empty() && !waiting.front().bytes.empty() &&
                      (waiting.front().bytes[0] & 0x80U) == 0;
    trial.expect(!good, "no success", "success");
  }
}

void longer_than_it_is(T& trial) {
  Bytes bytes = T::framed(Gvcp::kReadRegisters, gige_word(boot::kVersion), trial.next_request());
  bytes[5] = 8;
  no_success(trial, bytes, "a length of 8 before 4 bytes");
}

void latency(T& trial) {
  std::vector<std::chrono::nanoseconds> took;
  for (int i = 0; i < 200 && trial.fine(); ++i) {
    const auto begin = trial.now();
    if (!trial.read(boot::kVersion)) {
      return;
    }
    took.push_back(trial.now() - begin);
  }
  std::ranges::sort(took);
  const auto slow = std::chrono::duration_cast<std::chrono::microseconds>(took[took.size() - 3]);
  trial.expect(
      slow <= trial.claims().answer_within,
      "99 of 100 answers within " + std::to_string(trial.claims().answer_within.count()) + " ms",
      std::to_string(slow.count()) + " us");
}

template <std::size_t... index>
std::vector<GigeVisionRow> mandatory_rows(std::index_sequence<index...>) {
  return {{"registers", "", kMust, mandatory<index>}...};
}

constexpr std::array kRows{
    GigeVisionRow{"discovery", "DISCOVERY is answered with 248 bytes", kMust, answered},
    GigeVisionRow{"discovery", "It is not answered where no acknowledge is wanted", kShould,
                  not_asked},
    GigeVisionRow{"discovery", "The answer is the registers from 0 on", kMust, same_as_registers},
    GigeVisionRow{"discovery", "The version is one that there is", kMust, version},
    GigeVisionRow{"discovery", "The device is big-endian", kMust, big_endian},
    GigeVisionRow{"discovery", "Texts are UTF-8", kShould, character_set},
    GigeVisionRow{"discovery", "The MAC address is a device's", kMust, hardware_address},
    GigeVisionRow{"discovery", "It reports its own address", kMust, own_address},
    GigeVisionRow{"discovery", "The mask is one", kMust, mask},
    GigeVisionRow{"discovery", "Texts end with zeros", kMust, texts},
    GigeVisionRow{"discovery", "Maker and model have names", kMust, names},
    GigeVisionRow{"reading", "READREG and READMEM say the same", kMust, as_memory},
    GigeVisionRow{"reading", "Two registers at once", kMust, [](T& t) { several(t, 2); },
                  Danger::none, gev::Capability::kConcatenation},
    GigeVisionRow{"reading", "A packet full of registers at once", kMust,
                  [](T& t) { several(t, 135); }, Danger::none, gev::Capability::kConcatenation},
    GigeVisionRow{"reading", "Nobody is in control", kShould, nobody},
    GigeVisionRow{"reading", "An address between words is refused", kShould,
                  register_refused<2, GigeStatus::bad_alignment>},
    GigeVisionRow{"reading", "An address that there is not is refused", kShould,
                  register_refused<kNowhere, GigeStatus::invalid_address>},
    GigeVisionRow{"reading", "No address is refused", kShould, no_registers},
    GigeVisionRow{"reading", "Part of an address is refused", kShould, half_an_address},
    GigeVisionRow{"memory", "Four bytes", kMust, reads<4>},
    GigeVisionRow{"memory", "512 bytes", kMust, reads<512>},
    GigeVisionRow{"memory", "In pieces the same bytes", kMust, in_pieces},
    GigeVisionRow{"memory", "An address between words is refused", kShould,
                  memory_refused<2, 4, GigeStatus::bad_alignment>},
    GigeVisionRow{"memory", "A count of no whole words is refused", kShould,
                  memory_refused<0, 3, GigeStatus::bad_alignment>},
    GigeVisionRow{
        "memory", "More than a packet holds is refused", kShould,
        memory_refused<boot::kFirstUrl, kMemoryMaximum + 4, GigeStatus::invalid_parameter>},
    GigeVisionRow{"memory", "An address that there is not is refused", kShould,
                  memory_refused<kNowhere, 4, GigeStatus::invalid_address>},
    GigeVisionRow{"memory", "A command without a count is refused", kShould, short_memory},
    GigeVisionRow{"description", "The first URL has its form", kMust, url_form},
    GigeVisionRow{"description", "The first URL is of an xml or a zip", kMust, url_extension},
    GigeVisionRow{"description", "The description begins with a word", kShould, url_alignment},
    GigeVisionRow{"description", "The second URL has its form, or is empty", kMust, second_url},
    GigeVisionRow{"description", "It can be read as far as the URL says", kMust, readable},
    GigeVisionRow{"description", "It is whole", kMust, whole},
    GigeVisionRow{"description", "It is what its name says", kMust, kind},
    GigeVisionRow{"description", "It is the same when it is read again", kMust, same_again},
    GigeVisionRow{"description", "Its schema", kObserved, schema},
    GigeVisionRow{"acknowledge", "An unknown command is refused as not implemented", kShould,
                  unknown_command},
    GigeVisionRow{"acknowledge", "WRITEREG without control is refused", kMust,
                  [](T& t) { unwritten(t, Gvcp::kWriteRegisters, boot::kHeartbeatTimeout); }},
    GigeVisionRow{"acknowledge", "WRITEMEM without control is refused", kMust,
                  [](T& t) { unwritten(t, Gvcp::kWriteMemory, boot::kHeartbeatTimeout); },
                  Danger::none, gev::Capability::kWriteMemory},
    GigeVisionRow{"acknowledge", "Request 1 is answered as such", kMust, identified<1>},
    GigeVisionRow{"acknowledge", "Request 32768 is answered as such", kMust, identified<32'768>},
    GigeVisionRow{"acknowledge", "Request 65535 is answered as such", kMust, identified<65'535>},
    GigeVisionRow{"acknowledge", "Request 0 has no success", kShould, request_zero},
    GigeVisionRow{"acknowledge", "A repeated request is answered again", kMust, repeated},
    GigeVisionRow{"acknowledge", "Ten requests in a row are answered in turn", kMust, in_a_row},
    GigeVisionRow{"acknowledge", "Each application has its answers", kMust, of_two},
    GigeVisionRow{"acknowledge", "READREG is not answered where no acknowledge is wanted", kShould,
                  read_without_acknowledge},
    GigeVisionRow{"acknowledge", "What has another key is not answered", kMust, wrong_key},
    GigeVisionRow{"acknowledge", "Half a header is not answered", kMust, short_header},
    GigeVisionRow{"acknowledge", "A length beyond the datagram has no success", kShould,
                  longer_than_it_is},
    GigeVisionRow{"timing", "Answers come within the claim", kShould, latency},
};

}  // namespace

std::optional<GigeBytes> gige_description(GigeVisionTrial& trial) {
  const auto url = first_url(trial);
  constexpr std::uint32_t kMost = 16U << 20U;
  if (!url || !trial.expect(url->size <= kMost, "a description of at most 16 MiB",
                            std::to_string(url->size) + " bytes")) {
    return std::nullopt;
  }
  GigeBytes all;
  while (all.size() < url->size) {
    constexpr std::size_t kPiece = 512;
    const std::size_t left = (url->size - all.size() + 3) / 4 * 4;
    const auto piece = trial.read_memory(url->address + static_cast<std::uint32_t>(all.size()),
                                         static_cast<unsigned>(std::min(kPiece, left)));
    if (!piece) {
      return std::nullopt;
    }
    all = std::move(all) + *piece;
  }
  all.resize(url->size);
  return all;
}

std::vector<GigeVisionCase> gige_control_cases() {
  std::vector<GigeVisionCase> all = gige_cases_of(kRows);
  auto registers = mandatory_rows(std::make_index_sequence<kMandatory.size()>());
  std::vector<GigeVisionCase> each = gige_cases_of(registers);
  for (std::size_t i = 0; i < each.size(); ++i) {
    const auto* const row = std::ranges::find(gev::kBootstrapRegisters, kMandatory[i].address,
                                              &gev::RegisterRow::address);
    each[i].identity.title =
        "Register " + gige_address_text(row->address) + " can be: " + std::string(row->name);
  }
  std::ranges::move(each, std::back_inserter(all));
  return all;
}

}  // namespace rigwire::conform
