#include "hil/wires/rig_modbus.h"

#include "drivers/pty.h"
#include "drivers/tcp_server.h"
#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/modbus/modbus_server.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

class RigModbusTcp final : public RigModbus {
 public:
  RigModbusTcp(const ModbusLineConfiguration& configuration, boost::asio::io_context& io,
               std::uint64_t seed)
      : listener_(io, listener_settings(configuration)),
        outlet_(listener_, own_statistics()),
        server_(server_settings(configuration, seed), outlet_) {}

  void add_unit(std::uint8_t number, emulators::ModbusUnit& unit) override {
    server_.add_unit(number, unit);
  }

  void start(Executive& executive) override {
    executive.add(*this);
    executive.add(outlet_);
    listener_.start({
        .connected =
            [this, &executive](emulators::ConnectionId connection) {
              server_.connected(executive.arrive(), connection);
            },
        .received =
            [this, &executive](emulators::ConnectionId connection,
                               std::span<const std::uint8_t> bytes) {
              server_.receive(client_arrived(executive), connection, bytes);
            },
        .disconnected =
            [this, &executive](emulators::ConnectionId connection) {
              server_.disconnected(executive.arrive(), connection);
            },
        .half_closed =
            [this, &executive](emulators::ConnectionId connection) {
              server_.half_closed(executive.arrive(), connection);
            },
    });
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return listener_.status(); }
  [[nodiscard]] SimTime next_event() const override { return server_.next_event(); }
  void advance(SimTime now) override { server_.advance(now); }

 private:
  static drivers::TcpServerSettings listener_settings(
      const ModbusLineConfiguration& configuration) {
    drivers::TcpServerSettings settings;
    settings.address = configuration.address;
    settings.port = configuration.port;
    settings.allow_remote = configuration.allow_remote;
    settings.clients_max = configuration.clients_max;
    return settings;
  }

  drivers::TcpServer listener_;
  ServerOutlet outlet_;
  emulators::ModbusServer server_;
};

class RigModbusRtu final : public RigModbus {
 public:
  RigModbusRtu(const ModbusLineConfiguration& configuration, boost::asio::io_context& io,
               std::uint64_t seed)
      : check_baud_(configuration.check_baud),
        pty_(io, configuration.path, configuration.line.timing.baud),
        outlet_(pty_, own_statistics()),
        server_(rtu_settings(configuration, seed), outlet_) {}

  void add_unit(std::uint8_t number, emulators::ModbusUnit& unit) override {
    server_.add_unit(number, unit);
  }

  void start(Executive& executive) override {
    executive.add(*this);
    executive.add(outlet_);
    pty_.on_client([this, &executive](const drivers::LineClient& client) {
      server_.set_client(executive.arrive(), {client.present, seen_baud(check_baud_, client.baud)});
    });
    pty_.start([this, &executive](std::span<const std::uint8_t> bytes) {
      server_.receive(client_arrived(executive), bytes);
    });
  }

  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return pty_.status(); }
  [[nodiscard]] SimTime next_event() const override { return server_.next_event(); }
  void advance(SimTime now) override { server_.advance(now); }

 private:
  BaudCheck check_baud_;
  drivers::Pty pty_;
  StreamOutlet outlet_;
  emulators::ModbusRtuServer server_;
};

}  // namespace

std::unique_ptr<RigModbus> make_rig_modbus(const ModbusLineConfiguration& configuration,
                                           boost::asio::io_context& io, std::uint64_t seed) {
  if (configuration.wire == emulators::ModbusWire::rtu) {
    return std::make_unique<RigModbusRtu>(configuration, io, seed);
  }
  return std::make_unique<RigModbusTcp>(configuration, io, seed);
}

}  // namespace rigwire::hil
