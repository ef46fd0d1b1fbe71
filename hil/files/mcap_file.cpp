#include "hil/files/mcap_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
namespace mcap = protocols::mcap;

void read_pieces(const fs::path& path,
                 const std::function<std::size_t(std::span<const std::uint8_t>)>& take) {
  constexpr std::size_t kPiece = 1024 * 1024;
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw drivers::EndpointError(
        fmt::format("{}: {}", path.string(), std::generic_category().message(errno)));
  }
  std::vector<std::uint8_t> bytes;
  std::size_t at = 0;
  while (true) {
    if (at < bytes.size()) {
      if (const std::size_t taken = take(std::span(bytes).subspan(at)); taken != 0) {
        at += taken;
        continue;
      }
    }
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::exchange(at, 0)));
    const std::size_t had = bytes.size();
    bytes.resize(had + kPiece);
    file.read(reinterpret_cast<char*>(bytes.data()) + had, kPiece);
    bytes.resize(had + static_cast<std::size_t>(file.gcount()));
    if (bytes.size() == had) {
      return;
    }
  }
}

void each_mcap_record(const fs::path& path, const std::function<void(const mcap::Record&)>& use) {
  bool begun = false;
  std::uint64_t read = 0;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument(fmt::format("{}: {}", path.string(), why));
  };
  const auto check = [&](const auto& decoded) {
    if (decoded.malformed()) {
      refuse(fmt::format("{} after byte {}", decoded.fault().reason, read));
    }
  };
  read_pieces(path, [&](std::span<const std::uint8_t> bytes) -> std::size_t {
    if (!begun) {
      if (bytes.size() < mcap::kMagicSize) {
        return 0;
      }
      if (!mcap::begins_with_magic(bytes)) {
        refuse("does not begin as MCAP");
      }
      begun = true;
      read += mcap::kMagicSize;
      return mcap::kMagicSize;
    }
    if (mcap::begins_with_magic(bytes)) {
      return mcap::kMagicSize;  // the end
    }
    const auto record = mcap::next_record(bytes);
    check(record);
    if (!record.ok()) {
      return 0;
    }
    if (record->opcode == mcap::Opcode::chunk) {
      const auto chunk = mcap::read_chunk(record->content);
      check(chunk);
      for (auto rest = *chunk; !rest.empty();) {
        const auto inner = mcap::next_record(rest);
        check(inner);
        if (!inner.ok()) {
          refuse(fmt::format("a chunk that ends in a record, after byte {}", read));
        }
        use(*inner);
        rest = rest.subspan(inner.consumed());
      }
    } else {
      use(*record);
    }
    read += record.consumed();
    return record.consumed();
  });
}

bool is_mcap(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, mcap::kMagicSize> front{};
  file.read(front.data(), front.size());
  return file.good() && mcap::begins_with_magic(
                            {reinterpret_cast<const std::uint8_t*>(front.data()), front.size()});
}

}  // namespace rigwire::hil
