#include "hil/files/mcap_file.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/endpoints.h"

namespace rigwire::hil {

namespace fs = std::filesystem;
namespace mcap = protocols::mcap;

void read_pieces(const fs::path& path, FileLimit limit,
                 const std::function<std::size_t(std::span<const std::uint8_t>)>& take) {
  constexpr std::size_t kPiece = 1024 * 1024;
  std::optional<OutsideFile> opened;
  try {
    opened.emplace(path, limit);
  } catch (const FileRefused& refused) {
    throw drivers::EndpointError(refused.what());
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
    if (had > kMaxUnitBytes) {
      throw FileRefused(path, 0, "a record is too large", fmt::format("more than {} bytes", had),
                        "at most " + size_text(kMaxUnitBytes));
    }
    bytes.resize(had + kPiece);
    bytes.resize(had + opened->read(std::span(bytes).subspan(had)));
    if (bytes.size() == had) {
      return;
    }
  }
}

void each_mcap_record(const fs::path& path, FileLimit limit,
                      const std::function<void(const mcap::Record&)>& use) {
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
  read_pieces(path, limit, [&](std::span<const std::uint8_t> bytes) -> std::size_t {
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
  try {
    OutsideFile file(path, kRecordingFile);
    std::array<std::uint8_t, mcap::kMagicSize> front{};
    return file.read(front) == front.size() && mcap::begins_with_magic(front);
  } catch (const FileRefused&) {
    return false;
  }
}

}  // namespace rigwire::hil
