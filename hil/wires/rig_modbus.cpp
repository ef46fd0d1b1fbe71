#include "hil/wires/rig_modbus.h"

#include "drivers/pty.h"
#include "drivers/tcp_server.h"
#include "emulators/modbus/modbus_rtu_server.h"
#include "emulators/modbus/modbus_server.h"
#include "hil/wires/outlets.h"

namespace rigwire::hil {
namespace {

/// A line over its endpoint, what waits to leave by it, and the devices' server.
template <class Endpoint, class Exit, class Server>
class RigModbusOf : public RigModbus {
 public:
  void add_unit(std::uint8_t number, emulators::ModbusUnit& unit) override {
    server_.add_unit(number, unit);
  }
  void start(Executive& executive) override {
    executive.add(*this);
    executive.add(outlet_);
    listen(executive);
  }
  [[nodiscard]] std::unique_ptr<FaultPort> fault_port(
      const std::vector<emulators::ModbusFault>& configured) override {
    auto acts = acted_by<emulators::ModbusFault>(server_.faults());
    acts.kinds = emulators::modbus_fault_kinds(Server::kWire);
    return make_fault_port(configured, std::move(acts));
  }
  [[nodiscard]] drivers::EndpointStatus endpoint() const override { return endpoint_.status(); }
  [[nodiscard]] SimTime next_event() const override { return server_.next_event(); }
  void advance(SimTime now) override { server_.advance(now); }

 protected:
  template <class Open, class Settings>
  RigModbusOf(const Open& open, const Settings& settings)
      : endpoint_(open()), outlet_(endpoint_, own_statistics()), server_(settings, outlet_) {}
  virtual void listen(Executive& executive) = 0;

  Endpoint endpoint_;
  Exit outlet_;
  Server server_;
};

class RigModbusTcp final
    : public RigModbusOf<drivers::TcpServer, ServerOutlet, emulators::ModbusServer> {
 public:
  RigModbusTcp(const ModbusLineConfiguration& configuration, boost::asio::io_context& io,
               std::uint64_t seed)
      : RigModbusOf([&] { return drivers::TcpServer(io, listener_settings(configuration)); },
                    server_settings(configuration, seed)) {}

 private:
  void listen(Executive& executive) override {
    outlet_.start({
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

  static drivers::TcpServerSettings listener_settings(
      const ModbusLineConfiguration& configuration) {
    drivers::TcpServerSettings settings;
    settings.address = configuration.address;
    settings.port = configuration.port;
    settings.allow_remote = configuration.allow_remote;
    settings.clients_max = configuration.clients_max;
    return settings;
  }
};

class RigModbusRtu final
    : public RigModbusOf<drivers::Pty, StreamOutlet, emulators::ModbusRtuServer> {
 public:
  RigModbusRtu(const ModbusLineConfiguration& configuration, boost::asio::io_context& io,
               std::uint64_t seed)
      : RigModbusOf(
            [&] { return drivers::Pty(io, configuration.path, configuration.line.timing.baud); },
            rtu_settings(configuration, seed)),
        check_baud_(configuration.check_baud) {}

 private:
  void listen(Executive& executive) override {
    outlet_.on_client([this, &executive](const drivers::LineClient& client) {
      server_.set_client(executive.arrive(), {client.present, seen_baud(check_baud_, client.baud)});
    });
    outlet_.start([this, &executive](std::span<const std::uint8_t> bytes) {
      server_.receive(client_arrived(executive), bytes);
    });
  }

  BaudCheck check_baud_;
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
