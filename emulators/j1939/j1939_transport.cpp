#include "emulators/j1939/j1939_transport.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
using j1939::AbortReason;
using j1939::Identifier;
using j1939::TransportControl;
using j1939::TransportManagement;

namespace {

void in_range(std::string_view key, Duration value, Duration lower, Duration upper) {
  if (value < lower || value > upper) {
    std::ostringstream text;
    text << "J1939 transport: " << key << " is " << to_seconds(value) << " s, allowed is "
         << to_seconds(lower) << " .. " << to_seconds(upper) << " s";
    throw std::invalid_argument(text.str());
  }
}

}  // namespace

void validate(const J1939TransportSettings& settings) {
  using namespace std::chrono_literals;
  in_range("answer_delay", settings.answer_delay, 0s, 100ms);
  in_range("broadcast_gap", settings.broadcast_gap, 50ms, 200ms);
  in_range("packet_gap", settings.packet_gap, 0s, 200ms);
  if (settings.packets_per_portion == 0) {
    throw std::invalid_argument("J1939 transport: packets_per_portion is 0, allowed is 1 .. 255");
  }
}

J1939Transport::J1939Transport(const J1939TransportSettings& settings, J1939TransportSink& sink,
                               FrameOutput& output)
    : settings_(checked(settings)), sink_(sink), output_(output) {}

void J1939Transport::send_frame(SimTime now, const protocols::can::Frame& frame) {
  output_.send(now + settings_.answer_delay, frame);
}

void J1939Transport::send_abort(SimTime now, std::uint8_t source, std::uint8_t destination,
                                AbortReason reason, std::uint32_t pgn) {
  TransportManagement management;
  management.control = TransportControl::abort;
  management.reason = reason;
  management.pgn = pgn;
  send_frame(now, j1939::make_transport_management(source, destination, management));
}

J1939Transport::Receiving* J1939Transport::receiving_from(std::uint8_t source,
                                                          std::uint8_t destination) {
  for (Receiving& session : receiving_) {
    if (session.open && session.identifier.source == source &&
        session.identifier.destination == destination) {
      return &session;
    }
  }
  return nullptr;
}

void J1939Transport::close(Receiving& session, bool done) {
  session.open = false;
  session.due = kNever;
  ++(done ? counters_.received : counters_.abandoned);
}

void J1939Transport::abort(SimTime now, Receiving& session, AbortReason reason) {
  if (!session.broadcast()) {
    send_abort(now, session.identifier.destination, session.identifier.source, reason,
               session.identifier.pgn);
  }
  close(session, false);
}

void J1939Transport::grant(SimTime now, Receiving& session) {
  const int missing = session.packets() - session.next + 1;
  TransportManagement management;
  management.control = TransportControl::clear_to_send;
  management.packets = static_cast<std::uint8_t>(std::min<int>(session.portion, missing));
  management.next = static_cast<std::uint8_t>(session.next);
  management.pgn = session.identifier.pgn;
  session.last = static_cast<std::uint16_t>(session.next + management.packets - 1);
  session.due = now + kT2;
  send_frame(now, j1939::make_transport_management(session.identifier.destination,
                                                   session.identifier.source, management));
}

void J1939Transport::advance(SimTime now) {
  while (next_ <= now) {
    const SimTime instant = next_;
    for (Sending& session : sending_) {
      if (session.due == instant) {
        expire(instant, session);
      }
    }
    for (Receiving& session : receiving_) {
      if (session.due == instant) {
        abort(instant, session, AbortReason::timeout);
      }
    }
    refresh();
  }
}

void J1939Transport::refresh() {
  next_ = std::min(std::ranges::min(sending_, {}, &Sending::due).due,
                   std::ranges::min(receiving_, {}, &Receiving::due).due);
}

void J1939Transport::reset() {
  for (Sending& session : sending_) {
    if (session.phase != Phase::free) {
      close(session, false);
    }
  }
  for (Receiving& session : receiving_) {
    if (session.open) {
      close(session, false);
    }
  }
  refresh();
}

J1939Reception J1939Transport::receive(SimTime now, const Identifier& identifier,
                                       std::span<const std::uint8_t> payload,
                                       std::uint8_t own_address) {
  if (identifier.source >= j1939::kNullAddress || identifier.source == own_address) {
    return J1939Reception::ignored;  // no node that a session can be with
  }
  J1939Reception reception = J1939Reception::malformed;
  if (identifier.pgn == j1939::kTransportDataPgn) {
    if (const auto data = j1939::decode_transport_data(payload); data.ok()) {
      reception = on_data(now, identifier, *data);
    }
  } else if (const auto management = j1939::decode_transport_management(payload); management.ok()) {
    const bool to_everybody = identifier.destination == j1939::kGlobalAddress;
    const bool is_broadcast = management->control == TransportControl::broadcast;
    if (to_everybody != is_broadcast) {
      return J1939Reception::malformed;  // a broadcast to one, or a dialogue with everybody
    }
    switch (management->control) {
      case TransportControl::request_to_send:
      case TransportControl::broadcast:
        reception = on_announcement(now, identifier, *management);
        break;
      case TransportControl::clear_to_send:
        reception = on_clear(now, identifier.source, *management);
        break;
      case TransportControl::end_of_message:
        reception = on_end(identifier.source, *management);
        break;
      case TransportControl::abort:
        reception = on_abort(identifier.source, management->pgn);
        break;
    }
  }
  refresh();
  return reception;
}

J1939Reception J1939Transport::on_announcement(SimTime now, const Identifier& identifier,
                                               const TransportManagement& management) {
  const bool broadcast = management.control == TransportControl::broadcast;
  const auto refuse = [&](AbortReason reason) {
    if (!broadcast) {
      send_abort(now, identifier.destination, identifier.source, reason, management.pgn);
    }
    return J1939Reception::ignored;
  };
  if (management.size > j1939::kGreatestTransported) {
    return refuse(AbortReason::too_long);
  }
  if (!announces_message(management)) {
    return J1939Reception::malformed;
  }
  Receiving* session = receiving_from(identifier.source, identifier.destination);
  if (session != nullptr) {
    if (!broadcast && session->identifier.pgn != management.pgn) {
      return refuse(AbortReason::busy);
    }
    close(*session, false);
  } else {
    session = std::ranges::find(receiving_, false, &Receiving::open);
    if (session == receiving_.end()) {
      return refuse(AbortReason::no_resources);
    }
  }
  session->open = true;
  session->identifier = identifier;
  session->identifier.pgn = management.pgn;
  session->size = management.size;
  session->next = 1;
  session->repetitions = 0;
  if (broadcast) {
    session->last = session->packets();
    session->due = now + kT1;
  } else {
    session->portion =
        std::max<std::uint8_t>(1, std::min(settings_.packets_per_portion, management.limit));
    grant(now, *session);
  }
  return J1939Reception::accepted;
}

J1939Reception J1939Transport::on_abort(std::uint8_t source, std::uint32_t pgn) {
  J1939Reception reception = J1939Reception::ignored;
  if (Sending* session = sending_to(source); session != nullptr && session->identifier.pgn == pgn) {
    close(*session, false);
    reception = J1939Reception::accepted;
  }
  for (Receiving& session : receiving_) {
    if (session.open && !session.broadcast() && session.identifier.source == source &&
        session.identifier.pgn == pgn) {
      close(session, false);
      reception = J1939Reception::accepted;
    }
  }
  return reception;
}

J1939Reception J1939Transport::on_data(SimTime now, const Identifier& identifier,
                                       const j1939::TransportData& data) {
  Receiving* session = receiving_from(identifier.source, identifier.destination);
  if (session == nullptr) {
    return J1939Reception::ignored;
  }
  if (data.number == 0 || data.number > session->last) {
    abort(now, *session, AbortReason::bad_sequence);
    return J1939Reception::accepted;
  }
  if (data.number < session->next) {
    return J1939Reception::accepted;  // was there already
  }
  if (data.number > session->next) {
    if (session->broadcast()) {
      abort(now, *session, AbortReason::bad_sequence);
    } else if (data.number < session->last) {
      session->due = now + kT1;  // the rest of the portion comes first
    } else if (++session->repetitions > kGreatestRepetitions) {
      abort(now, *session, AbortReason::too_many_repetitions);
    } else {
      grant(now, *session);
    }
    return J1939Reception::accepted;
  }
  const std::size_t begin = (session->next - 1U) * j1939::kPacketBytes;
  std::copy_n(data.bytes.begin(), std::min(j1939::kPacketBytes, session->size - begin),
              session->bytes.begin() + static_cast<std::ptrdiff_t>(begin));
  ++session->next;
  session->due = now + kT1;
  if (session->next > session->packets()) {
    if (!session->broadcast()) {
      TransportManagement end;
      end.control = TransportControl::end_of_message;
      end.size = session->size;
      end.packets = session->packets();
      end.pgn = session->identifier.pgn;
      send_frame(now,
                 j1939::make_transport_management(identifier.destination, identifier.source, end));
    }
    close(*session, true);
    sink_.transported(now, {session->identifier, std::span(session->bytes).first(session->size)});
  } else if (session->next > session->last) {
    grant(now, *session);
  }
  return J1939Reception::accepted;
}

// The sender's half of the sessions.

bool J1939Transport::is_sending(std::uint8_t destination) const {
  return std::ranges::any_of(sending_, [destination](const Sending& session) {
    return session.phase != Phase::free && session.identifier.destination == destination;
  });
}

J1939Transport::Sending* J1939Transport::sending_to(std::uint8_t destination) {
  for (Sending& session : sending_) {
    if (session.phase != Phase::free && session.identifier.destination == destination) {
      return &session;
    }
  }
  return nullptr;
}

bool J1939Transport::send(SimTime now, const Identifier& identifier,
                          std::span<const std::uint8_t> payload) {
  if (payload.size() < j1939::kLeastTransported || payload.size() > j1939::kGreatestTransported ||
      is_sending(identifier.destination)) {
    return false;
  }
  const bool broadcast = identifier.destination == j1939::kGlobalAddress;
  const auto sessions = broadcast ? std::span(sending_).first(1) : std::span(sending_).subspan(1);
  const auto free = std::ranges::find(sessions, Phase::free, &Sending::phase);
  if (free == sessions.end()) {
    return false;
  }
  Sending& session = *free;
  session.identifier = identifier;
  session.size = static_cast<std::uint16_t>(payload.size());
  session.next = 1;
  session.last = broadcast ? session.packets() : 0;
  session.sent = 0;
  session.repetitions = 0;
  session.phase = broadcast ? Phase::sending : Phase::waiting;
  session.due = now + (broadcast ? settings_.broadcast_gap : kT3);
  std::ranges::copy(payload, session.bytes.begin());
  TransportManagement management;
  management.control = broadcast ? TransportControl::broadcast : TransportControl::request_to_send;
  management.size = session.size;
  management.packets = session.packets();
  management.pgn = identifier.pgn;
  send_frame(
      now, j1939::make_transport_management(identifier.source, identifier.destination, management));
  refresh();
  return true;
}

void J1939Transport::send_packet(SimTime now, Sending& session) {
  const Identifier& identifier = session.identifier;
  send_frame(now, j1939::make_transport_data(identifier.source, identifier.destination,
                                             std::span(session.bytes).first(session.size),
                                             static_cast<std::uint8_t>(session.next)));
  session.sent = std::max(session.sent, session.next);
  ++session.next;
  if (session.next <= session.last) {
    session.due = now + (session.broadcast() ? settings_.broadcast_gap : settings_.packet_gap);
  } else if (session.broadcast()) {
    close(session, true);
  } else {
    session.phase = Phase::waiting;
    session.due = now + kT3;
  }
}

void J1939Transport::close(Sending& session, bool done) {
  session.phase = Phase::free;
  session.due = kNever;
  ++(done ? counters_.sent : counters_.abandoned);
}

void J1939Transport::abort(SimTime now, Sending& session, AbortReason reason) {
  send_abort(now, session.identifier.source, session.identifier.destination, reason,
             session.identifier.pgn);
  close(session, false);
}

void J1939Transport::expire(SimTime now, Sending& session) {
  if (session.phase == Phase::sending) {
    send_packet(now, session);
  } else {
    abort(now, session, AbortReason::timeout);
  }
}

J1939Reception J1939Transport::on_clear(SimTime now, std::uint8_t source,
                                        const TransportManagement& management) {
  Sending* session = sending_to(source);
  if (session == nullptr || session->identifier.pgn != management.pgn) {
    return J1939Reception::ignored;
  }
  if (session->phase == Phase::sending) {
    abort(now, *session, AbortReason::clear_while_sending);
    return J1939Reception::accepted;
  }
  if (management.packets == 0) {
    session->phase = Phase::held;
    session->due = now + kT4;
    return J1939Reception::accepted;
  }
  if (management.next == 0 || management.next > session->packets() ||
      management.next > session->sent + 1) {
    abort(now, *session, AbortReason::bad_sequence);
    return J1939Reception::accepted;
  }
  if (management.next <= session->sent && ++session->repetitions > kGreatestRepetitions) {
    abort(now, *session, AbortReason::too_many_repetitions);
    return J1939Reception::accepted;
  }
  session->next = management.next;
  session->last = static_cast<std::uint16_t>(
      std::min<int>(management.next + management.packets - 1, session->packets()));
  session->phase = Phase::sending;
  session->due = now + settings_.packet_gap;
  if (settings_.packet_gap == Duration{0}) {
    while (session->phase == Phase::sending) {
      send_packet(now, *session);
    }
  }
  return J1939Reception::accepted;
}

J1939Reception J1939Transport::on_end(std::uint8_t source, const TransportManagement& management) {
  Sending* session = sending_to(source);
  if (session == nullptr || session->identifier.pgn != management.pgn) {
    return J1939Reception::ignored;
  }
  close(*session, session->sent == session->packets());
  return J1939Reception::accepted;
}

}  // namespace rigwire::emulators
