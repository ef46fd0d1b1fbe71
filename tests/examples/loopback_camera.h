// An emulated GigE Vision camera on real sockets of this host, living in a thread of its own, in
// real time.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "emulators/gige_camera/gige_camera.h"
#include "emulators/nonvolatile_memory.h"

namespace rigwire::field {

class LoopbackCamera {
 public:
  using Sensor =
      std::function<std::shared_ptr<const Picture>(const CameraCommand&, SimTime exposure_start)>;

  /// At `address`, port 3956. Throws boost::system::system_error when somebody has it.
  LoopbackCamera(const std::string& address, emulators::GigeCameraSettings settings, Sensor sensor)
      : control_(context_, {boost::asio::ip::make_address_v4(address), 3956}),
        stream_(context_, {boost::asio::ip::make_address_v4(address), 0}),
        sensor_(std::move(sensor)) {
    settings.address.address = boost::asio::ip::make_address_v4(address).to_uint();
    camera_ = std::make_unique<emulators::GigeCamera>(settings, memory_, control_, stream_);
    camera_->set_stream_port(stream_.port());
    thread_ = std::thread([this] { live(); });
  }
  ~LoopbackCamera() {
    ended_ = true;
    thread_.join();
  }
  LoopbackCamera(const LoopbackCamera&) = delete;
  LoopbackCamera& operator=(const LoopbackCamera&) = delete;

  /// From now on it exposes nothing, and answers all the same.
  void blind() { blind_ = true; }
  [[nodiscard]] bool controlled() const { return controlled_; }

 private:
  using udp = boost::asio::ip::udp;

  class Socket final : public emulators::DatagramOutput {
   public:
    Socket(boost::asio::io_context& context, const udp::endpoint& at) : socket_(context, at) {
      socket_.non_blocking(true);
    }
    void send(SimTime due, const emulators::UdpEnd& to, std::span<const std::uint8_t> bytes,
              bool /*do_not_fragment*/) override {
      on_way_.push_back(
          {due, {boost::asio::ip::address_v4(to.address), to.port}, {bytes.begin(), bytes.end()}});
    }
    void flush(SimTime now) {
      std::size_t sent = 0;
      for (; sent < on_way_.size() && on_way_[sent].due <= now; ++sent) {
        boost::system::error_code ignored;
        socket_.send_to(boost::asio::buffer(on_way_[sent].bytes), on_way_[sent].to, 0, ignored);
      }
      on_way_.erase(on_way_.begin(), on_way_.begin() + static_cast<std::ptrdiff_t>(sent));
    }
    template <class Take>
    void receive(Take take) {
      std::vector<std::uint8_t> bytes(2000);
      udp::endpoint from;
      boost::system::error_code error;
      for (;;) {
        const std::size_t size = socket_.receive_from(boost::asio::buffer(bytes), from, 0, error);
        if (error == boost::asio::error::would_block) {
          return;
        }
        if (!error) {
          take(emulators::UdpEnd{from.address().to_v4().to_uint(), from.port()},
               std::span(bytes).first(size));
        }
      }
    }
    [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }

   private:
    struct Sent {
      SimTime due;
      udp::endpoint to;
      std::vector<std::uint8_t> bytes;
    };
    udp::socket socket_;
    std::vector<Sent> on_way_;
  };

  void live() {
    const auto started = std::chrono::steady_clock::now();
    SimTime exposed = kStart;
    while (!ended_) {
      const SimTime now = kStart + (std::chrono::steady_clock::now() - started);
      camera_->advance(now);
      control_.receive([&](const emulators::UdpEnd& from, std::span<const std::uint8_t> bytes) {
        camera_->receive(now, from, bytes);
      });
      const SimTime next = camera_->sample_plan().next_after(exposed);
      if (next <= now) {
        // The newest exposure that is due; a sensor that is slow skips some, as real ones do.
        exposed = std::max(next, now - camera_->sample_plan().period);
        if (!blind_) {
          camera_->update({now, exposed, sensor_(camera_->command(), exposed)});
        }
      }
      control_.flush(now);
      stream_.flush(now);
      controlled_ = camera_->controlled();
      std::this_thread::sleep_for(std::chrono::microseconds{500});
    }
  }

  boost::asio::io_context context_;
  emulators::VolatileMemory memory_;
  Socket control_;
  Socket stream_;
  Sensor sensor_;
  std::unique_ptr<emulators::GigeCamera> camera_;
  std::atomic<bool> ended_ = false;
  std::atomic<bool> blind_ = false;
  std::atomic<bool> controlled_ = false;
  std::thread thread_;
};

}  // namespace rigwire::field
