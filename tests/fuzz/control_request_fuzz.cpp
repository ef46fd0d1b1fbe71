// Requests to the control surface, as text of whoever may post: each is a command whose keys keep
// their rules, or refused with what is wrong. None reads a file.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <type_traits>
#include <variant>

#include "fields/check.h"
#include "hil/control/commands.h"

namespace {

using namespace rigwire;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

/// What a command holds as text is read once more, when it is carried out.
void read_inner(const std::string& text) {
  hil::Problems problems;
  const hil::Value keys = hil::parse_request(text, "keys", problems);
  if (problems.empty()) {
    require(!hil::json_text(keys).empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  hil::Problems problems;
  auto request = hil::read_request(text, "the request", problems);
  require(request.has_value() == problems.empty());
  if (!request) {
    require(!problems.sorted().front().what.empty());
    return 0;
  }
  fields::check(*request);
  std::visit(
      []<class What>(What& command) {
        fields::check(command);
        if constexpr (std::is_same_v<What, hil::FaultAddCommand>) {
          read_inner(command.fault);
        } else if constexpr (std::is_same_v<What, hil::SetCommand>) {
          read_inner(command.set);
        }
      },
      request->command);
  return 0;
}
