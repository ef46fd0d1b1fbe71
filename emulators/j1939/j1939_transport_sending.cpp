// The sender's half of the sessions.
#include <algorithm>

#include "emulators/j1939/j1939_transport.h"

namespace rigwire::emulators {

namespace j1939 = protocols::j1939;
using j1939::AbortReason;
using j1939::Identifier;
using j1939::TransportControl;
using j1939::TransportManagement;

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
