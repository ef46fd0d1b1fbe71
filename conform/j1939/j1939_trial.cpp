#include "conform/j1939/j1939_trial.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace rigwire::conform {

using protocols::can::Frame;

namespace {

bool addressed(std::uint32_t pgn) {
  return (pgn >> 8U & 0xFFU) < 240U;
}

std::optional<J1939Heard> take_apart(const Frame& frame) {
  if (!frame.extended || frame.remote) {
    return std::nullopt;
  }
  J1939Heard heard;
  heard.priority = static_cast<std::uint8_t>(frame.id >> 26U & 7U);
  heard.pgn = frame.id >> 8U & 0x3FFFFU;
  heard.source = static_cast<std::uint8_t>(frame.id);
  if (addressed(heard.pgn)) {
    heard.destination = static_cast<std::uint8_t>(heard.pgn);
    heard.pgn &= 0x3FF00U;
  }
  const auto payload = frame.payload();
  heard.data = {payload.begin(), payload.end()};
  heard.frame = frame;
  return heard;
}

}  // namespace

std::string pgn_text(std::uint32_t pgn) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%u (%04X)", pgn, pgn);
  return text.data();
}

void open_line(J1939Device& device) {
  device.line = bounded(device.open(), device.bounds);
  J1939Trial trial({}, device);
  // Function 129 (off-board diagnostic-service tool) of the global group.
  static_cast<void>(trial.send(J1939Trial::kClaim, J1939Trial::kEverybody,
                               {0x01, 0x00, 0xE0, 0xFF, 0x00, 129, 0x00, 0x00}, "a claim"));
  static_cast<void>(trial.listen(std::chrono::milliseconds(300)));
}

J1939Trial::J1939Trial(CaseIdentity identity, J1939Device& device)
    : Trial(std::move(identity), [&device] { return device.line->now(); }), device_(&device) {
  drain();
}

void J1939Trial::drain() {
  const auto end = now() + kDrain;
  while (now() < end && device_->line->receive(now())) {
  }
}

bool J1939Trial::send(const Frame& frame, const std::string& words) {
  sent(step_bytes(frame), frame_text(frame) + ": " + words);
  return expect(device_->line->send(frame), "the bus takes a frame", "it does not");
}

bool J1939Trial::send(std::uint32_t pgn, std::uint8_t destination,
                      const std::vector<std::uint8_t>& data, const std::string& words,
                      std::uint8_t source) {
  Frame frame;
  frame.extended = true;
  frame.id = 6U << 26U | (pgn | (addressed(pgn) ? destination : 0U)) << 8U | source;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, frame.data.begin());
  return send(frame, words);
}

bool J1939Trial::request(std::uint32_t pgn, std::uint8_t destination) {
  return send(kRequest, destination,
              {static_cast<std::uint8_t>(pgn), static_cast<std::uint8_t>(pgn >> 8U),
               static_cast<std::uint8_t>(pgn >> 16U)},
              "request of " + pgn_text(pgn));
}

std::optional<J1939Heard> J1939Trial::hear(std::initializer_list<std::uint32_t> pgns,
                                           std::chrono::nanoseconds within,
                                           std::optional<std::uint8_t> destination) {
  const auto deadline = now() + within;
  while (auto heard = hear_anybody(deadline)) {
    if (heard->source == claims().address && std::ranges::find(pgns, heard->pgn) != pgns.end() &&
        (destination ? heard->destination == *destination
                     : heard->destination == kEverybody || heard->destination == kOwnAddress)) {
      show(*heard);
      return heard;
    }
  }
  return std::nullopt;
}

std::optional<J1939Heard> J1939Trial::hear_anybody(CanLine::Clock::time_point deadline) {
  while (const auto frame = device_->line->receive(deadline)) {
    if (auto heard = take_apart(*frame)) {
      return heard;
    }
  }
  return std::nullopt;
}

std::vector<J1939Heard> J1939Trial::listen(std::chrono::nanoseconds span) {
  std::vector<J1939Heard> all;
  drain();
  const auto begin = now();
  while (auto heard = hear_anybody(begin + span)) {
    if (heard->source == claims().address) {
      heard->at = now() - begin;
      all.push_back(std::move(*heard));
    }
  }
  return all;
}

void J1939Trial::show(const J1939Heard& heard) {
  received(step_bytes(heard.frame), frame_text(heard.frame) + ": group " + pgn_text(heard.pgn) +
                                        " to " + std::to_string(heard.destination));
}

std::optional<J1939Heard> J1939Trial::claim() {
  auto found = hear({kClaim}, claims().patience);
  if (!expect(found.has_value(), "a claim of address " + std::to_string(claims().address),
              "none") ||
      !demand(found->data.size() == 8, "a NAME of eight bytes", hex_text(found->data))) {
    return std::nullopt;
  }
  return found;
}

std::optional<std::vector<std::uint8_t>> J1939Trial::name() {
  drain();
  const auto found = request(kClaim) ? claim() : std::nullopt;
  return found ? std::optional(found->data) : std::nullopt;
}

void J1939Trial::lost(const std::string& reason) {
  note(reason);
  device_->lost = reason;
}

bool J1939Trial::silent(std::initializer_list<std::uint32_t> pgns, const std::string& about) {
  const auto found = hear(pgns, std::chrono::milliseconds(300));
  return expect(!found.has_value(), "no answer to " + about, found ? frame_text(found->frame) : "");
}

bool J1939Trial::control(std::vector<std::uint8_t> bytes, std::uint32_t pgn,
                         const std::string& words) {
  bytes.resize(5, 0xFF);
  for (int i = 0; i < 3; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(pgn >> (8 * i)));
  }
  return send(kTransport, claims().address, bytes, words);
}

}  // namespace rigwire::conform
