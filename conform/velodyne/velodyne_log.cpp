#include "conform/velodyne/velodyne_log.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

namespace rigwire::conform {

namespace velodyne = protocols::velodyne;
using velodyne::ReturnMode;

namespace {

constexpr std::int64_t kHour_us = 3'600'000'000;

/// The value that most packets have.
template <class Value>
Value most_frequent(const std::vector<VelodyneData>& packets, Value (VelodyneData::*of)() const) {
  std::map<Value, std::size_t> counts;
  for (const VelodyneData& packet : packets) {
    ++counts[(packet.*of)()];
  }
  const auto most =
      std::ranges::max_element(counts, {}, [](const auto& each) { return each.second; });
  return most == counts.end() ? Value{} : most->first;
}

bool has_flag(const std::vector<VelodyneData>& packets, unsigned flag) {
  for (const VelodyneData& packet : packets) {
    for (std::size_t block = 0; block < velodyne::kBlocksPerPacket; ++block) {
      if (packet.flag(block) == flag) {
        return true;
      }
    }
  }
  return false;
}

/// Whether blocks 0 and 2 mostly share one azimuth: the two returns of an HDL-64E.
bool pairs_of_banks(const std::vector<VelodyneData>& packets) {
  std::size_t equal = 0;
  for (const VelodyneData& packet : packets) {
    equal += packet.azimuth(0) == packet.azimuth(2) ? 1U : 0U;
  }
  return equal * 2 > packets.size();
}

}  // namespace

int azimuth_step(int from_counts, int to_counts) {
  constexpr int kTurn = 36'000;
  const int step = ((to_counts - from_counts) % kTurn + kTurn) % kTurn;
  return step >= kTurn / 2 ? step - kTurn : step;
}

std::int64_t timestamp_step_us(std::uint32_t from_us, std::uint32_t to_us) {
  const std::int64_t step = ((std::int64_t{to_us} - from_us) % kHour_us + kHour_us) % kHour_us;
  return step >= kHour_us / 2 ? step - kHour_us : step;
}

std::string VelodynePosition::sentence() const {
  const auto begin = datagram_->bytes.begin() + 206;
  return {begin, std::find(begin, datagram_->bytes.end(), 0)};
}

void VelodyneLog::add_data(VelodyneDatagram datagram) {
  data_.push_back(std::move(datagram));
}

void VelodyneLog::add_position(VelodyneDatagram datagram) {
  positions_.push_back(std::move(datagram));
  data_before_.push_back(data_.size());
}

void VelodyneLog::close(std::chrono::nanoseconds span, std::uint64_t lost_here,
                        const VelodyneClaims& claims) {
  span_ = span;
  lost_here_ = lost_here;
  std::vector<std::size_t> packets_before{0};  // Right ones among so many datagrams.
  for (const VelodyneDatagram& datagram : data_) {
    if (datagram.bytes.size() == velodyne::kDataPacketSize) {
      packets_.emplace_back(datagram);
    }
    packets_before.push_back(packets_.size());
  }
  std::string before;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (positions_[i].bytes.size() != velodyne::kPositionPacketSize) {
      continue;
    }
    position_packets_.emplace_back(positions_[i], packets_before[data_before_[i]]);
    std::string sentence = position_packets_.back().sentence();
    if (!sentence.empty() && sentence != before) {
      if (!sentence.ends_with('\n')) {
        sentence += '\n';  // So that the missing CR is reported, too.
      }
      sentences_.add(positions_[i].at,
                     {reinterpret_cast<const std::uint8_t*>(sentence.data()), sentence.size()});
      before = position_packets_.back().sentence();
    }
  }
  sentences_.close();
  for (std::size_t i = 1; i < packets_.size(); ++i) {
    steps_us_.push_back(
        timestamp_step_us(packets_[i - 1].timestamp_us(), packets_[i].timestamp_us()));
  }
  find_model(claims);
  find_firings();
}

// Chooses among the models with the claimed name (else the packets' product id, or a status channel
// if blocks are marked as those of a second bank) the one whose packet period is nearest to the
// median timestamp step.
void VelodyneLog::find_model(const VelodyneClaims& claims) {
  const std::uint8_t product = most_frequent(packets_, &VelodyneData::product);
  const std::uint8_t mode = most_frequent(packets_, &VelodyneData::return_mode);
  const bool four_banks = has_flag(packets_, velodyne::kFlagLasers96To127);
  const bool two_banks = !four_banks && has_flag(packets_, velodyne::kFlagLasers32To63);
  std::vector<const velodyne::Model*> candidates;
  for (const velodyne::Model& each : velodyne::models()) {
    const bool told =
        two_banks ? each.status_channel : !each.status_channel && each.product_id == product;
    if (claims.model.empty() ? told : each.name == claims.model) {
      candidates.push_back(&each);
    }
  }
  const auto mode_of = [&](const velodyne::Model& of) {
    if (of.status_channel) {
      return pairs_of_banks(packets_) ? ReturnMode::dual : ReturnMode::strongest;
    }
    return mode == 0x38   ? ReturnMode::last
           : mode == 0x39 ? ReturnMode::dual
                          : ReturnMode::strongest;
  };
  std::vector<std::int64_t> steps = steps_us_;
  std::ranges::sort(steps);
  const double median = steps.empty() ? 0.0 : static_cast<double>(steps[steps.size() / 2]);
  double least = 0.0;
  for (const velodyne::Model* each : candidates) {
    const ReturnMode of = mode_of(*each);
    if (of == ReturnMode::dual && !each->dual_return) {
      continue;
    }
    const double off = std::abs(median - velodyne::packet_period_ns(*each, of) / 1000.0);
    if (model_ == nullptr || off < least) {
      model_ = each;
      mode_ = of;
      least = off;
    }
  }
}

double VelodyneLog::packet_period_us() const {
  return velodyne::packet_period_ns(*model_, mode_) / 1000.0;
}

void VelodyneLog::find_firings() {
  if (model_ == nullptr) {
    return;
  }
  std::int64_t packet_us = 0;
  for (std::size_t p = 0; p < packets_.size(); ++p) {
    packet_us += p > 0 ? steps_us_[p - 1] : 0;
    std::optional<std::size_t> before;
    for (std::size_t block = 0; block < velodyne::kBlocksPerPacket; ++block) {
      const velodyne::BlockPlace place = velodyne::block_place(*model_, mode_, block);
      if (place.echo == velodyne::BlockEcho::none || before == place.first_firing) {
        continue;
      }
      before = place.first_firing;
      firings_.push_back({p,
                          packet_us * 1000 + static_cast<std::int64_t>(place.first_firing) *
                                                 model_->firing_period_ns,
                          static_cast<int>(packets_[p].azimuth(block))});
    }
  }
}

std::optional<double> VelodyneLog::rotor_rpm() const {
  double counts = 0.0;
  std::int64_t time_ns = 0;
  for (std::size_t i = 1; i < firings_.size(); ++i) {
    const std::int64_t step_ns = firings_[i].time_ns - firings_[i - 1].time_ns;
    if (std::abs(step_ns) <= kLongestRotorGap_ns) {
      counts += azimuth_step(firings_[i - 1].azimuth_counts, firings_[i].azimuth_counts);
      time_ns += step_ns;
    }
  }
  return time_ns > 0
             ? std::optional(counts / 36'000.0 / (static_cast<double>(time_ns) * 1e-9) * 60.0)
             : std::nullopt;
}

}  // namespace rigwire::conform
