// Requests to a caster from arbitrary bytes: what is read lies within them, and the caster lives on
// whatever clients and base stations send.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/ntrip/caster.h"
#include "protocols/ntrip/message.h"

namespace {

namespace ntrip = rigwire::protocols::ntrip;
using namespace std::chrono_literals;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

struct Output final : rigwire::emulators::StreamOutput {
  void send(rigwire::emulators::ConnectionId connection, rigwire::SimTime due,
            std::span<const std::uint8_t> bytes) override {
    require(connection == 1 && due >= last && !bytes.empty() && !closed);
    last = due;
  }
  void close(rigwire::emulators::ConnectionId connection, rigwire::SimTime due) override {
    require(connection == 1 && due >= last && !closed);
    closed = true;
  }
  rigwire::SimTime last{};
  bool closed = false;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> all(data, size);
  const auto request = ntrip::decode_request(all);
  require(!request.ok() ||
          (request.consumed() <= size && request.consumed() <= ntrip::kGreatestHead));
  require(!request.incomplete() || size < ntrip::kGreatestHead);

  Output output;
  rigwire::emulators::NtripCasterSettings settings;
  settings.user = size % 2 == 0 ? "" : "u";
  rigwire::emulators::NtripCaster caster(settings, rigwire::Calendar({}), output);
  const std::size_t mount = caster.add({});
  caster.connected(rigwire::kStart, 1);
  const std::size_t half = size / 2;
  caster.receive(rigwire::kStart + 1s, 1, all.first(half));
  caster.receive(rigwire::kStart + 2s, 1, all.subspan(half));
  caster.hear(rigwire::kStart + 3s, mount, all);
  caster.advance(rigwire::kStart + 20s);
  require(caster.next_event() == rigwire::kNever);
  caster.disconnected(rigwire::kStart + 21s, 1);
  return 0;
}
