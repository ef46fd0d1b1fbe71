#include "protocols/dbc/dbc_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "protocols/dbc/words.h"

namespace rigwire::protocols::dbc {
namespace {

constexpr std::uint32_t kGreatestBase = 0x7FFU;
constexpr std::uint32_t kGreatestExtended = 0x1FFFFFFFU;
/// The message that collects signals without one, in files of Vector's tools.
constexpr std::uint32_t kIndependentSignals = 0xC0000000U;
constexpr unsigned kMostBits = 64;
constexpr std::size_t kMostFindings = 100;
constexpr std::size_t kMostSignals = 1024;

struct Token {
  enum class Kind : std::uint8_t { word, number, string, mark, end };

  Kind kind = Kind::end;
  std::string_view text;  ///< A string's text has no quotation marks.
  int line = 1;
  int column = 1;
  bool first_on_line = false;
};

bool begins_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token next() {
    skip_space();
    Token token;
    token.line = line_;
    token.column = static_cast<int>(at_ - line_start_) + 1;
    token.first_on_line = std::exchange(last_line_, line_) != line_;
    if (at_ == text_.size()) {
      return token;
    }
    const char c = text_[at_];
    const std::size_t begin = at_;
    if (begins_word(c)) {
      while (at_ < text_.size() && (begins_word(text_[at_]) || is_digit(text_[at_]))) {
        ++at_;
      }
      token.kind = Token::Kind::word;
    } else if (c == '"') {
      return string(token);
    } else if (const std::size_t length = number_length(); length > 0) {
      at_ += length;
      token.kind = Token::Kind::number;
    } else {
      ++at_;
      token.kind = Token::Kind::mark;
    }
    token.text = text_.substr(begin, at_ - begin);
    return token;
  }

 private:
  /// Space and comments, "//" to the end of the line and "/*" to "*/".
  void skip_space() {
    while (at_ < text_.size()) {
      const std::string_view rest = text_.substr(at_);
      std::size_t length = static_cast<unsigned char>(rest[0]) <= ' ' ? 1 : 0;
      if (rest.starts_with("//")) {
        length = std::min(rest.find('\n'), rest.size());
      } else if (rest.starts_with("/*")) {
        const std::size_t end = rest.find("*/", 2);
        length = end == std::string_view::npos ? rest.size() : end + 2;
      }
      if (length == 0) {
        return;
      }
      for (const std::size_t stop = at_ + length; at_ < stop; ++at_) {
        if (text_[at_] == '\n') {
          ++line_;
          line_start_ = at_ + 1;
        }
      }
    }
  }

  /// Returns the length of the number that begins here, with its sign; 0 if there is none, as at
  /// the "+" in "@1+".
  [[nodiscard]] std::size_t number_length() const {
    const std::size_t sign = text_[at_] == '+' || text_[at_] == '-' ? 1 : 0;
    const std::string_view rest = text_.substr(at_ + sign);
    if (rest.empty() || !(is_digit(rest[0]) || rest[0] == '.')) {
      return 0;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    return error == std::errc::invalid_argument
               ? 0
               : sign + static_cast<std::size_t>(end - rest.data());
  }

  Token string(Token token) {
    const std::size_t begin = ++at_;
    while (at_ < text_.size() && text_[at_] != '"') {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) {
        ++at_;
      }
      if (text_[at_] == '\n') {
        ++line_;
        line_start_ = at_ + 1;
      }
      ++at_;
    }
    if (at_ == text_.size()) {
      return token;  // the end where a string is not closed
    }
    token.kind = Token::Kind::string;
    token.text = text_.substr(begin, at_ - begin);
    ++at_;
    return token;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_start_ = 0;
  int line_ = 1;
  int last_line_ = 0;  ///< Line of the token before.
};

/// Converts a string's bytes: unchanged if UTF-8, else every byte is a character of ISO 8859-1.
std::string utf8(std::string_view bytes) {
  std::size_t follow = 0;
  bool valid = true;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (follow > 0) {
      valid = valid && (byte & 0xC0U) == 0x80U;
      --follow;
    } else if (byte >= 0x80U) {
      valid = valid && byte >= 0xC2U && byte <= 0xF4U;
      follow = byte >= 0xF0U ? 3 : byte >= 0xE0U ? 2 : 1;
    }
  }
  if (valid && follow == 0) {
    return std::string(bytes);
  }
  std::string text;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80U) {
      text += c;
    } else {
      text += static_cast<char>(0xC0U | (byte >> 6U));
      text += static_cast<char>(0x80U | (byte & 0x3FU));
    }
  }
  return text;
}

bool says_one_of(std::string_view text, std::span<const std::string_view> words) {
  return std::ranges::any_of(
      words, [text](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

/// An attribute's definition, or a value of it.
struct Attribute {
  std::vector<std::string> names;  ///< Names of an enumeration, by number.
  std::string preset;
};

/// Message or signal that an attribute or comment belongs to.
struct Owner {
  std::uint32_t message = 0;  ///< Identifier in the file, with bit 31.
  std::string signal;

  friend bool operator<(const Owner& a, const Owner& b) {
    return std::tie(a.message, a.signal) < std::tie(b.message, b.signal);
  }
};

/// Statements end with a semicolon, but for these: they end where a further one begins.
constexpr std::array<std::string_view, 6> kOpenStatements{"VERSION", "NS_", "BS_",
                                                          "BU_",     "BO_", "SG_"};
constexpr std::array<std::string_view, 28> kStatements{"CM_",
                                                       "BA_DEF_",
                                                       "BA_",
                                                       "VAL_",
                                                       "CAT_DEF_",
                                                       "CAT_",
                                                       "FILTER",
                                                       "BA_DEF_DEF_",
                                                       "EV_DATA_",
                                                       "ENVVAR_DATA_",
                                                       "SGTYPE_",
                                                       "SGTYPE_VAL_",
                                                       "BA_DEF_SGTYPE_",
                                                       "BA_SGTYPE_",
                                                       "SIG_TYPE_REF_",
                                                       "VAL_TABLE_",
                                                       "SIG_GROUP_",
                                                       "SIG_VALTYPE_",
                                                       "SIGTYPE_VALTYPE_",
                                                       "BO_TX_BU_",
                                                       "BA_DEF_REL_",
                                                       "BA_REL_",
                                                       "BA_DEF_DEF_REL_",
                                                       "BU_SG_REL_",
                                                       "BU_EV_REL_",
                                                       "BU_BO_REL_",
                                                       "SG_MUL_VAL_",
                                                       "EV_"};

bool is_statement(const Token& token) {
  return token.kind == Token::Kind::word &&
         (std::ranges::find(kOpenStatements, token.text) != kOpenStatements.end() ||
          std::ranges::find(kStatements, token.text) != kStatements.end());
}

class Parser {
 public:
  explicit Parser(std::string_view text) : lexer_(text) { take(); }

  Reading run() {
    while (token_.kind != Token::Kind::end && reading_.findings.size() < kMostFindings) {
      statement();
    }
    if (!seen_any_ && reading_.findings.empty()) {
      reading_.findings.push_back({1, 1, "no DBC file", "", "BU_, BO_, SG_ and their like"});
    }
    apply();
    return std::move(reading_);
  }

 private:
  struct Refused {};

  Token take() { return std::exchange(token_, lexer_.next()); }
  [[noreturn]] void refuse(const Token& at, std::string what, std::string allowed) {
    reading_.findings.push_back(
        {at.line, at.column, std::move(what),
         at.kind == Token::Kind::end ? "the end of the file" : utf8(at.text), std::move(allowed)});
    throw Refused{};
  }
  bool at_mark(char mark) const {
    return token_.kind == Token::Kind::mark && token_.text[0] == mark;
  }
  void expect(char mark) {
    if (!at_mark(mark)) {
      refuse(token_, "something else is expected here", std::string("\"") + mark + "\"");
    }
    take();
  }
  std::string word(const char* what) {
    if (token_.kind != Token::Kind::word) {
      refuse(token_, "something else is expected here", what);
    }
    return std::string(take().text);
  }
  std::string string() {
    if (token_.kind != Token::Kind::string) {
      refuse(token_, "something else is expected here", "a text in quotation marks");
    }
    return utf8(take().text);
  }
  /// A number beyond the range of double becomes the largest double: ends of a range may be that.
  double number() {
    const Token at = token_;
    if (at.kind == Token::Kind::number) {
      double value = 0.0;
      const std::string_view digits = at.text[0] == '+' ? at.text.substr(1) : at.text;
      const auto error = std::from_chars(digits.data(), digits.data() + digits.size(), value).ec;
      if (error == std::errc::result_out_of_range) {
        constexpr double kGreatest = std::numeric_limits<double>::max();
        value = digits[0] == '-' ? -kGreatest : kGreatest;
      }
      take();
      return value;
    }
    refuse(at, "no number", "a number");
  }
  std::uint64_t whole(std::uint64_t greatest) {
    const Token at = token_;
    std::uint64_t value = 0;
    if (at.kind == Token::Kind::number) {
      const char* end = at.text.data() + at.text.size();
      const auto [stop, error] = std::from_chars(at.text.data(), end, value);
      if (error == std::errc{} && stop == end && value <= greatest) {
        take();
        return value;
      }
    }
    refuse(at, "no such whole number", "0 .. " + std::to_string(greatest));
  }
  std::uint32_t identifier() { return static_cast<std::uint32_t>(whole(0xFFFFFFFFU)); }

  /// Skips to the next statement, past the semicolon of this one if it has one. Some statements
  /// contain keywords of statements, but not at the beginning of a line; `open`: this one does not.
  void skip(bool open) {
    while (token_.kind != Token::Kind::end && !at_mark(';') &&
           !(is_statement(token_) && (open || token_.first_on_line))) {
      take();
    }
    if (at_mark(';')) {
      take();
    }
  }

  /// Past the semicolon. Files that are in use leave it out where another statement begins.
  void end_of_statement() {
    if (token_.kind != Token::Kind::end && !is_statement(token_)) {
      expect(';');
    }
  }

  void statement() {
    const Token keyword = take();
    if (keyword.kind == Token::Kind::mark && keyword.text == ";") {
      return;
    }
    try {
      if (keyword.kind != Token::Kind::word || !is_statement(keyword)) {
        refuse(keyword, "no statement of a DBC file",
               "BU_, BO_, SG_, CM_, BA_, VAL_ and their like");
      }
      seen_any_ = true;
      if (keyword.text == "VERSION") {
        (void)string();
      } else if (keyword.text == "NS_") {
        new_symbols();
      } else if (keyword.text == "BS_") {
        skip(true);
      } else if (keyword.text == "BU_") {
        nodes();
      } else if (keyword.text == "BO_") {
        message(keyword);
      } else if (keyword.text == "SG_") {
        signal(keyword);
      } else if (keyword.text == "BO_TX_BU_") {
        senders();
      } else if (keyword.text == "CM_") {
        comment();
      } else if (keyword.text == "BA_DEF_") {
        definition();
      } else if (keyword.text == "BA_DEF_DEF_") {
        preset();
      } else if (keyword.text == "BA_") {
        attribute();
      } else if (keyword.text == "VAL_") {
        values();
      } else if (keyword.text == "SIG_VALTYPE_") {
        value_type();
      } else if (keyword.text == "SG_MUL_VAL_") {
        extended_multiplexing();
      } else {
        skip(false);
      }
    } catch (const Refused&) {
      skip(true);
    }
  }

  /// The list of keywords, which mean nothing there. It ends with the bit timing or the nodes.
  void new_symbols() {
    expect(':');
    while (token_.kind == Token::Kind::word && token_.text != "BS_" && token_.text != "BU_" &&
           token_.text != "BO_") {
      take();
    }
  }

  void nodes() {
    expect(':');
    while (token_.kind == Token::Kind::word && !is_statement(token_)) {
      reading_.content.nodes.emplace_back(take().text);
    }
  }

  void message(const Token& keyword) {
    current_ = &nobody_;
    current_id_ = kIndependentSignals;
    FileMessage message;
    message.line = keyword.line;
    const Token at = token_;
    const std::uint32_t id = identifier();
    message.layout.extended = (id & kExtendedFlag) != 0;
    message.layout.id = id & ~kExtendedFlag;
    message.layout.name = word("the message's name");
    expect(':');
    constexpr std::uint64_t kGreatestLength = 1785;  // J1939-21, 5.10.1.1
    message.layout.length = static_cast<std::uint16_t>(whole(kGreatestLength));
    const std::string sender = word("the sending node");
    if (sender != kNobody) {
      message.senders.push_back(sender);
    }
    if (id == kIndependentSignals) {
      return;
    }
    if (message.layout.id > (message.layout.extended ? kGreatestExtended : kGreatestBase)) {
      refuse(at, "no CAN identifier", "0 .. 2047, or 2147483648 and 0 .. 536870911");
    }
    if (!places_.emplace(id, reading_.content.messages.size()).second) {
      refuse(at, "a second message with this identifier", "identifiers of their own");
    }
    reading_.content.messages.push_back(std::move(message));
    current_id_ = id;
    current_ = &reading_.content.messages.back();
  }

  void signal(const Token& keyword) {
    can::OwnedSignal layout;
    if (current_ == nullptr) {
      refuse(keyword, "a signal without a message", "SG_ after its BO_");
    }
    layout.name = word("the signal's name");
    const bool multiplexor = multiplexing(layout);
    expect(':');
    constexpr std::uint64_t kGreatestBit = 8 * 1785 - 1;
    const Token start_at = token_;
    layout.bit = static_cast<std::uint16_t>(whole(kGreatestBit));
    expect('|');
    layout.width = static_cast<std::uint16_t>(whole(kGreatestBit + 1));
    if (layout.width == 0) {
      refuse(start_at, "a signal without bits", "1 bit and more");
    }
    expect('@');
    layout.order = whole(1) == 0 ? can::ByteOrder::big_endian : can::ByteOrder::little_endian;
    if (!at_mark('+') && !at_mark('-')) {
      refuse(token_, "something else is expected here", "\"+\" or \"-\"");
    }
    layout.is_signed = take().text == "-";
    expect('(');
    const Token scale_at = token_;
    layout.scale = number();
    if (layout.scale == 0.0) {
      refuse(scale_at, "a factor of 0", "any other");
    }
    expect(',');
    layout.offset = number();
    expect(')');
    expect('[');
    layout.lower = number();
    expect('|');
    layout.upper = number();
    expect(']');
    layout.unit = string();
    while (token_.kind == Token::Kind::word && !is_statement(token_)) {
      take();  // receivers
      if (at_mark(',')) {
        take();
      }
    }
    if (current_->signals.size() == kMostSignals) {
      refuse(keyword, "too many signals in a message", "at most " + std::to_string(kMostSignals));
    }
    if (multiplexor) {
      multiplexors_.insert(Owner{current_id_, layout.name});
    }
    current_->signals.push_back({std::nullopt, keyword.line});
    current_->layout.signals.push_back(std::move(layout));
  }

  /// "M", "m12", "m12M". Whether others depend on the signal.
  bool multiplexing(can::OwnedSignal& layout) {
    if (token_.kind != Token::Kind::word) {
      return false;
    }
    const Token at = take();
    std::string_view text = at.text;
    const bool multiplexor = text.ends_with('M');
    text.remove_suffix(multiplexor ? 1 : 0);
    if (text.empty()) {
      return multiplexor;
    }
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + 1, end, value);
    if (text[0] != 'm' || error != std::errc{} || stop != end) {
      refuse(at, "no multiplexing", "M, or m and a number");
    }
    layout.present_at = {{value, value}};
    return multiplexor;
  }

  FileMessage* find(std::uint32_t id) {
    const auto place = places_.find(id);
    return place == places_.end() ? nullptr : &reading_.content.messages[place->second];
  }

  void senders() {
    FileMessage* const message = find(identifier());
    expect(':');
    while (token_.kind == Token::Kind::word && !is_statement(token_)) {
      const std::string node(take().text);
      if (message != nullptr && node != kNobody &&
          std::ranges::find(message->senders, node) == message->senders.end()) {
        message->senders.push_back(node);
      }
      if (at_mark(',')) {
        take();
      }
    }
    end_of_statement();
  }

  void comment() {
    std::optional<Owner> owner;
    if (token_.kind == Token::Kind::word && (token_.text == "BO_" || token_.text == "SG_")) {
      owner = read_owner().first;
    } else if (token_.kind == Token::Kind::word) {
      take();
      (void)word("the name of a node or an environment variable");
    }
    const std::string text = string();
    if (owner) {
      comments_[*owner] = text;
    }
    end_of_statement();
  }

  /// "BO_ 12" or "SG_ 12 Name".
  std::pair<Owner, bool> read_owner() {
    const bool is_message = take().text == "BO_";
    Owner owner;
    owner.message = identifier();
    if (!is_message) {
      owner.signal = word("the signal's name");
    }
    return {owner, is_message};
  }

  void definition() {
    if (token_.kind == Token::Kind::word) {
      take();  // whose: BU_, BO_, SG_, EV_
    }
    Attribute& attribute = attributes_[string()];
    if (token_.kind == Token::Kind::word && token_.text == "ENUM") {
      take();
      while (token_.kind == Token::Kind::string) {
        attribute.names.push_back(string());
        if (at_mark(',')) {
          take();
        }
      }
    }
    skip(false);
  }

  void preset() {
    Attribute& attribute = attributes_[string()];
    attribute.preset = attribute_value();
    end_of_statement();
  }

  std::string attribute_value() {
    if (token_.kind != Token::Kind::string && token_.kind != Token::Kind::number) {
      refuse(token_, "something else is expected here", "a number or a text");
    }
    return utf8(take().text);
  }

  void attribute() {
    const std::string name = string();
    if (token_.kind == Token::Kind::word && (token_.text == "BO_" || token_.text == "SG_")) {
      const Owner owner = read_owner().first;
      given_[{name, owner}] = attribute_value();
      end_of_statement();
    } else {
      if (token_.kind == Token::Kind::word) {
        take();  // BU_ or EV_, and its name
        (void)word("the name of a node or an environment variable");
      }
      (void)attribute_value();  // of it, or of the network
      end_of_statement();
    }
  }

  void values() {
    can::OwnedSignal* signal = nullptr;
    if (token_.kind == Token::Kind::number) {
      const std::uint32_t id = identifier();
      signal = find_signal(id, word("the signal's name"));
    } else {
      (void)word("a message's identifier, or the name of an environment variable");
    }
    while (token_.kind == Token::Kind::number) {
      const double raw = number();
      const std::string text = string();
      if (signal != nullptr) {
        constexpr double kFarthest = 9.2e18;
        signal->values.push_back(
            {static_cast<std::int64_t>(std::clamp(raw, -kFarthest, kFarthest)), text});
      }
    }
    end_of_statement();
  }

  can::OwnedSignal* find_signal(std::uint32_t id, std::string_view name) {
    FileMessage* const message = find(id);
    if (message == nullptr) {
      return nullptr;
    }
    auto& signals = message->layout.signals;
    const auto found = std::ranges::find(signals, name, &can::OwnedSignal::name);
    return found == signals.end() ? nullptr : &*found;
  }

  void value_type() {
    const std::uint32_t id = identifier();
    const std::string name = word("the signal's name");
    if (at_mark(':')) {
      take();
    }
    const std::uint64_t type = whole(3);
    if (can::OwnedSignal* const signal = find_signal(id, name); signal != nullptr) {
      signal->is_float = type == 1 || type == 2;
    }
    end_of_statement();
  }

  void extended_multiplexing() {
    const std::uint32_t id = identifier();
    const std::string name = word("the signal's name");
    const std::string multiplexor = word("the multiplexor's name");
    std::vector<can::RawRange> ranges;
    while (token_.kind == Token::Kind::number) {
      const std::uint64_t first = whole(std::numeric_limits<std::uint64_t>::max());
      // "3-5": the second number is read with the dash as its sign.
      ranges.push_back({first, static_cast<std::uint64_t>(std::clamp(-number(), 0.0, 1.8e19))});
      if (at_mark(',')) {
        take();
      }
    }
    if (can::OwnedSignal* const signal = find_signal(id, name); signal != nullptr) {
      signal->present_at = ranges;
      named_multiplexors_[Owner{id, name}] = multiplexor;
    }
    end_of_statement();
  }

  /// The attribute of that owner, by its name in an enumeration; nothing where neither it nor a
  /// default is given.
  [[nodiscard]] std::optional<std::string> value_of(const std::string& name,
                                                    const Owner& owner) const {
    const auto definition = attributes_.find(name);
    const auto given = given_.find({name, owner});
    if (given == given_.end()) {
      return definition == attributes_.end() || definition->second.preset.empty()
                 ? std::nullopt
                 : std::optional(definition->second.preset);
    }
    const std::string& value = given->second;
    std::size_t index = 0;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, index);
    if (definition != attributes_.end() && error == std::errc{} && stop == end &&
        index < definition->second.names.size()) {
      return definition->second.names[index];
    }
    return value;
  }
  [[nodiscard]] std::optional<double> number_of(const std::string& name, const Owner& owner) const {
    const auto value = value_of(name, owner);
    double number = 0.0;
    if (value &&
        std::from_chars(value->data(), value->data() + value->size(), number).ec == std::errc{} &&
        std::isfinite(number)) {
      return number;
    }
    return std::nullopt;
  }

  void apply() {
    for (const auto& [id, place] : places_) {
      FileMessage& message = reading_.content.messages[place];
      can::OwnedMessage& layout = message.layout;
      const Owner owner{id, {}};
      message.period_ms = std::max(number_of("GenMsgCycleTime", owner).value_or(0.0), 0.0);
      message.send_type = value_of("GenMsgSendType", owner).value_or("");
      message.least_distance_ms = number_of("GenMsgDelayTime", owner).value_or(0.0);
      message.start_delay_ms = number_of("GenMsgStartDelayTime", owner).value_or(0.0);
      layout.j1939 =
          layout.extended && value_of("VFrameFormat", owner).value_or("").starts_with("J1939");
      layout.fill = layout.j1939 ? 0xFF : 0x00;
      layout.sender = message.senders.empty() ? "" : message.senders.front();
      layout.text = comment_of(owner);
      find_multiplexors(layout, id);
      for (std::size_t i = 0; i < message.signals.size(); ++i) {
        can::OwnedSignal& signal = layout.signals[i];
        const Owner of{id, signal.name};
        // Only what is given: a default of 0 says nothing of this signal.
        if (given_.contains({"GenSigStartValue", of})) {
          message.signals[i].start_value = number_of("GenSigStartValue", of);
        }
        constexpr double kGreatestSpn = 524287.0;
        signal.spn = static_cast<std::uint32_t>(
            std::clamp(number_of("SPN", of).value_or(0.0), 0.0, kGreatestSpn));
        signal.text = comment_of(of);
        if (layout.j1939 && !signal.is_signed && !signal.is_float && signal.width > 1) {
          signal.reserved = can::Reserved::j1939;
        }
        if (signal.lower >= signal.upper && signal.width <= kMostBits) {
          signal = can::unlimited(std::move(signal));
        }
      }
      take_long_names(layout, id);
    }
  }

  [[nodiscard]] std::string comment_of(const Owner& owner) const {
    const auto text = comments_.find(owner);
    return text == comments_.end() ? std::string() : text->second;
  }

  /// Each signal's, by name where it is given, else the message's only one. A signal whose
  /// multiplexor is not there depends on itself (can::is_lost).
  void find_multiplexors(can::OwnedMessage& layout, std::uint32_t id) const {
    for (std::size_t i = 0; i < layout.signals.size(); ++i) {
      can::OwnedSignal& signal = layout.signals[i];
      if (signal.present_at.empty()) {
        continue;
      }
      const auto named = named_multiplexors_.find(Owner{id, signal.name});
      std::size_t found = i;
      for (std::size_t other = 0; other < layout.signals.size(); ++other) {
        const std::string& name = layout.signals[other].name;
        const bool is_it = named != named_multiplexors_.end()
                               ? name == named->second
                               : multiplexors_.contains(Owner{id, name});
        found = is_it && found == i ? other : found;
      }
      signal.multiplexor = static_cast<std::uint16_t>(found);
    }
  }

  /// Names of more than 32 characters are in an attribute.
  void take_long_names(can::OwnedMessage& layout, std::uint32_t id) const {
    const auto take_name = [&](const char* attribute, const Owner& owner, std::string& name) {
      if (const auto given = given_.find({attribute, owner}); given != given_.end()) {
        name = given->second;
      }
    };
    take_name("SystemMessageLongSymbol", Owner{id, {}}, layout.name);
    for (can::OwnedSignal& signal : layout.signals) {
      take_name("SystemSignalLongSymbol", Owner{id, signal.name}, signal.name);
    }
  }

  Lexer lexer_;
  Token token_;
  Reading reading_;
  bool seen_any_ = false;
  FileMessage* current_ = nullptr;
  std::uint32_t current_id_ = kIndependentSignals;  ///< In the file.
  FileMessage nobody_;  ///< Takes the signals that belong to no message.
  /// Index of each message, by identifier in the file.
  std::map<std::uint32_t, std::size_t> places_;
  std::map<std::string, Attribute> attributes_;
  std::map<std::pair<std::string, Owner>, std::string> given_;
  std::map<Owner, std::string> comments_;
  std::set<Owner> multiplexors_;                     ///< Signals that others depend on.
  std::map<Owner, std::string> named_multiplexors_;  ///< By the signal that depends on them.
};

/// Whether they share a bit of a message of `bytes` bytes.
bool share_bits(const can::Coding& a, const can::Coding& b, std::size_t bytes) {
  for (std::size_t byte = 0; byte < bytes; ++byte) {
    if ((can::bits_in(a, byte) & can::bits_in(b, byte)) != 0) {
      return true;
    }
  }
  return false;
}

}  // namespace

SendType send_type(std::string_view word) {
  // Parts of the words of Vector ("cyclicIfActive", "spontanX", "OnWriteWithRepetition"), Ford
  // ("FixedPeriodic", "EventPeriodic"), GM and others; "acyclic" and "aperiodic" are their
  // opposites.
  constexpr std::array<std::string_view, 4> kByTime{"cyclic", "cycle", "periodic", "fixed"};
  constexpr std::array<std::string_view, 5> kNotByTime{"acyclic", "aperiodic", "noncyclic",
                                                       "non-cyclic", "nonperiodic"};
  constexpr std::array<std::string_view, 5> kOnChange{"change", "spontan", "event", "write",
                                                      "trigger"};
  constexpr std::array<std::string_view, 3> kOnRequest{"request", "poll", "query"};
  std::string text;
  for (const char c : word) {
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  SendType type;
  type.by_time = says_one_of(text, kByTime) && !says_one_of(text, kNotByTime);
  type.on_change = says_one_of(text, kOnChange) || says_one_of(text, kNotByTime);
  type.on_request = says_one_of(text, kOnRequest);
  return type;
}

const FileMessage* FileContent::find(std::string_view message) const {
  const auto found = std::ranges::find_if(
      messages, [message](const FileMessage& one) { return one.layout.name == message; });
  return found == messages.end() ? nullptr : &*found;
}

Reading read(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) {
    text.remove_prefix(kByteOrderMark.size());
  }
  return Parser(text).run();
}

// Checks the signals in `used`: each has a valid layout, a multiplexor where it needs one, a unique
// name, and no bits in common with a signal that can be present at the same time.
std::vector<Finding> faults_of(const FileMessage& message, std::span<const std::string_view> used) {
  std::vector<Finding> findings;
  const auto report = [&](int line, std::string what, std::string found, std::string allowed) {
    findings.push_back({line, 1, std::move(what), std::move(found), std::move(allowed)});
  };
  const can::OwnedMessage& layout = message.layout;
  constexpr unsigned kFrameBytes = 8;
  if (layout.length > kFrameBytes && !layout.j1939) {
    report(message.line, layout.name + " is longer than a CAN frame",
           std::to_string(layout.length) + " bytes", "0 .. 8 bytes, or VFrameFormat J1939PG");
  }
  std::vector<std::size_t> before;
  for (std::size_t i = 0; i < layout.signals.size(); ++i) {
    const can::OwnedSignal& signal = layout.signals[i];
    const int line = message.signals[i].line;
    if (std::ranges::find(used, signal.name) == used.end()) {
      continue;
    }
    if (const auto defect = can::defect(signal, layout.length); !defect.empty()) {
      report(line, signal.name + ": " + std::string(defect), "",
             "1 .. 64 bits in " + std::to_string(layout.length) + " bytes");
      continue;
    }
    if (can::is_lost(layout, i)) {
      report(line, signal.name + " has no multiplexor", "", "a signal M");
      continue;
    }
    for (const std::size_t other : before) {
      const can::OwnedSignal& earlier = layout.signals[other];
      if (earlier.name == signal.name) {
        report(line, layout.name + " has two signals " + signal.name, "", "one");
      } else if (share_bits(signal, earlier, layout.length) &&
                 !can::exclude_each_other(layout, i, other)) {
        report(line, signal.name + " lies on " + earlier.name, "", "bits of their own");
      }
    }
    before.push_back(i);
  }
  return findings;
}

}  // namespace rigwire::protocols::dbc
