#include "hil/files/capture_file.h"

#include <fmt/format.h>

#include <array>
#include <stdexcept>
#include <utility>
#include <variant>

#include "drivers/endpoints.h"

namespace rigwire::hil {
namespace {

namespace pcapng = protocols::pcapng;

constexpr std::array<std::uint8_t, 4> kSection{0x0A, 0x0D, 0x0D, 0x0A};

bool begins_as_pcapng(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= kSection.size() &&
         std::equal(kSection.begin(), kSection.end(), bytes.begin());
}

OutsideFile open_capture(const std::filesystem::path& path, FileLimit limit) {
  try {
    return {path, limit};
  } catch (const FileRefused& refused) {
    throw drivers::EndpointError(fmt::format("the capture {}", refused.what()));
  }
}

}  // namespace

CaptureFile::CaptureFile(const std::filesystem::path& path, FileLimit limit)
    : file_(open_capture(path, limit)) {
  (void)read_more();
  if (pcapng::PcapReader::begins(bytes_)) {
    const auto head = pcap_.emplace().head(bytes_);
    if (head.malformed()) {
      refuse(head.fault());
    }
    truncated_ = !head.ok();
    packet_.interface = head.ok() ? *head : pcapng::Interface{};
    at_ = head.consumed();
  } else if (!begins_as_pcapng(bytes_)) {
    throw std::invalid_argument(
        fmt::format("the capture {}: neither pcap nor pcapng, found {} bytes that begin otherwise",
                    file_.path().string(), bytes_.empty() ? "no" : "some"));
  }
}

bool CaptureFile::is_one(const std::filesystem::path& path) {
  try {
    OutsideFile file(path, kRecordingFile);
    std::array<std::uint8_t, 4> begin{};
    return file.read(begin) == begin.size() &&
           (begins_as_pcapng(begin) || pcapng::PcapReader::begins(begin));
  } catch (const FileRefused&) {
    return false;
  }
}

bool CaptureFile::read_more() {
  constexpr std::size_t kPiece = 256 * 1024;
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
  offset_ += std::exchange(at_, 0);
  const std::size_t had = bytes_.size();
  bytes_.resize(had + kPiece);
  bytes_.resize(had + file_.read(std::span(bytes_).subspan(had)));
  return bytes_.size() > had;
}

void CaptureFile::refuse(const protocols::Malformed& fault) const {
  throw std::invalid_argument(fmt::format("the capture {}: {} at byte {}", file_.path().string(),
                                          fault.reason, offset_ + at_ + fault.offset));
}

void CaptureFile::pass_over(const pcapng::Block& block) {
  if (const auto* const section = std::get_if<pcapng::Section>(&block)) {
    application_ = section->application;
  } else if (const auto* const other = std::get_if<pcapng::OtherBlock>(&block)) {
    without_time_ += other->type == pcapng::kSimplePacketBlock ? 1 : 0;
  }
}

const CapturedPacket* CaptureFile::next() {
  while (true) {
    const auto rest = std::span<const std::uint8_t>(bytes_).subspan(at_);
    bool found = false;
    std::size_t taken = 0;
    if (pcap_) {
      const auto packet = pcap_->next(rest);
      if (packet.malformed()) {
        refuse(packet.fault());
      }
      found = packet.ok();
      taken = packet.consumed();
      if (found) {
        packet_.packet = *packet;
      }
    } else {
      const auto block = pcapng_.next(rest);
      if (block.malformed()) {
        refuse(block.fault());
      }
      taken = block.consumed();
      const auto* packet = block.ok() ? std::get_if<pcapng::Packet>(&*block) : nullptr;
      found = packet != nullptr;
      if (found) {
        packet_ = {*packet, pcapng_.interfaces()[packet->interface]};
      } else if (block.ok()) {
        pass_over(*block);
      }
    }
    if (taken == 0) {
      if (read_more()) {
        continue;
      }
      truncated_ = truncated_ || at_ < bytes_.size();
      return nullptr;
    }
    at_ += taken;
    if (found) {
      return &packet_;
    }
  }
}

}  // namespace rigwire::hil
