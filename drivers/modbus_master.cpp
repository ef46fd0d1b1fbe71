#include "drivers/modbus_master.h"

#include <modbus.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>
#include <string_view>

#include "protocols/modbus/mbap.h"

namespace rigwire::drivers {

using protocols::modbus::ExceptionCode;

namespace {

struct Release {
  void operator()(modbus_t* context) const {
    modbus_close(context);
    modbus_free(context);
  }
};

void check_timeout(const char* setting, std::chrono::milliseconds value) {
  if (value.count() < 1 || value > std::chrono::minutes(1)) {
    throw std::invalid_argument(std::string("modbus master ") + setting + ": found " +
                                std::to_string(value.count()) + " ms, allowed 1 .. 60000 ms");
  }
}

void set_timeout(modbus_t* context, std::chrono::milliseconds value) {
  const auto total = static_cast<std::uint32_t>(value.count());
  modbus_set_response_timeout(context, total / 1000, total % 1000 * 1000);
}

modbus_t* new_rtu(const ModbusSerialPort& port) {
  using protocols::modbus::SerialCharacter;
  const SerialCharacter character = port.timing.character;
  const char parity = character == SerialCharacter::even_8e1  ? 'E'
                      : character == SerialCharacter::odd_8o1 ? 'O'
                                                              : 'N';
  return modbus_new_rtu(port.path.c_str(), static_cast<int>(port.timing.baud), parity, 8,
                        character == SerialCharacter::none_8n2 ? 2 : 1);
}

}  // namespace

struct ModbusMaster::Connection {
  ModbusMasterSettings settings;
  std::unique_ptr<modbus_t, Release> context;
  bool open = false;

  std::string where() const {
    if (settings.serial) {
      return "rtu " + settings.serial->path + " unit " + std::to_string(settings.unit);
    }
    return "tcp " + settings.host + ":" + std::to_string(settings.port) + " unit " +
           std::to_string(settings.unit);
  }

  /// Judges libmodbus's return value; `expected` is how many items it should have moved.
  ModbusOutcome judge(const char* what, int moved, int expected) {
    if (moved == expected) {
      return {};
    }
    const int reason = moved < 0 ? errno : EIO;
    ModbusOutcome outcome{std::string(what) + ", " + where() + ": " + modbus_strerror(reason), {}};
    if (reason > MODBUS_ENOBASE && reason < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX) {
      outcome.exception = static_cast<ExceptionCode>(reason - MODBUS_ENOBASE);
    } else if (reason != EMBMDATA && reason != EINVAL) {  // those two never reached the wire
      close();
    }
    return outcome;
  }

  ModbusOutcome not_connected(const char* what) const {
    return {std::string(what) + ", " + where() + ": not connected", {}};
  }

  /// Calls libmodbus when connected; `expected` is what it returns when all went well.
  template <class Call>
  ModbusOutcome ask(const char* what, int expected, const Call& call) {
    return open ? judge(what, call(context.get()), expected) : not_connected(what);
  }

  /// The PDU of the data unit that `stream` begins with; nothing as long as that is not complete.
  std::optional<std::span<const std::uint8_t>> take(std::span<const std::uint8_t> stream,
                                                    std::string_view& fault) const {
    if (settings.serial) {
      const auto frame = protocols::modbus::decode_rtu(stream);
      return frame.ok() ? std::optional(frame->pdu) : std::nullopt;
    }
    const auto adu = protocols::modbus::decode_adu(stream);
    fault = adu.malformed() ? adu.fault().reason : std::string_view();
    return adu.ok() ? std::optional(adu->pdu) : std::nullopt;
  }

  /// One data unit by the length field, on a serial line by its check: libmodbus guesses lengths
  /// from the function code, and knows only some of them.
  ModbusOutcome receive(const char* what, std::span<std::uint8_t> answer, std::size_t& size) {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + settings.response_timeout;
    std::array<std::uint8_t, 2 * protocols::modbus::kTcpAduMaximum> stream{};
    std::size_t had = 0;
    const auto fail = [&](std::string_view reason) {
      close();
      return ModbusOutcome{std::string(what) + ", " + where() + ": " + std::string(reason), {}};
    };
    for (;;) {
      std::string_view fault;
      const auto pdu = take(std::span(stream).first(had), fault);
      if (!fault.empty() || had == stream.size()) {
        return fail(fault.empty() ? "answer without an end" : fault);
      }
      if (pdu) {
        if (pdu->size() > answer.size()) {
          return fail("answer larger than its buffer");
        }
        std::ranges::copy(*pdu, answer.begin());
        size = pdu->size();
        return {};
      }
      const auto left =
          std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      pollfd waiting{modbus_get_socket(context.get()), POLLIN, 0};
      if (left <= 0 || ::poll(&waiting, 1, static_cast<int>(left)) == 0) {
        return fail("no answer in time");
      }
      const auto got = ::read(waiting.fd, &stream[had], stream.size() - had);
      if (got <= 0) {
        return fail(got == 0 ? "connection closed by the device" : modbus_strerror(errno));
      }
      had += static_cast<std::size_t>(got);
    }
  }

  void close() {
    modbus_close(context.get());
    open = false;
  }
};

ModbusMaster::ModbusMaster(const ModbusMasterSettings& settings)
    : connection_(std::make_unique<Connection>()) {
  check_timeout("connect_timeout", settings.connect_timeout);
  check_timeout("response_timeout", settings.response_timeout);
  connection_->settings = settings;
  connection_->context.reset(settings.serial
                                 ? new_rtu(*settings.serial)
                                 : modbus_new_tcp(settings.host.c_str(), settings.port));
  if (!connection_->context || modbus_set_slave(connection_->context.get(), settings.unit) != 0) {
    throw std::invalid_argument("modbus master " + connection_->where() + ": " +
                                modbus_strerror(errno));
  }
}

ModbusMaster::~ModbusMaster() = default;
ModbusMaster::ModbusMaster(ModbusMaster&&) noexcept = default;
ModbusMaster& ModbusMaster::operator=(ModbusMaster&&) noexcept = default;

ModbusOutcome ModbusMaster::connect() {
  Connection& c = *connection_;
  c.close();
  set_timeout(c.context.get(), c.settings.connect_timeout);  // libmodbus connects by this one
  errno = 0;
  if (modbus_connect(c.context.get()) != 0) {
    const int reason = errno != 0 ? errno : ETIMEDOUT;
    c.close();
    return {"connect, " + c.where() + ": " + modbus_strerror(reason), {}};
  }
  set_timeout(c.context.get(), c.settings.response_timeout);
  c.open = true;
  return {};
}

void ModbusMaster::close() {
  connection_->close();
}

bool ModbusMaster::connected() const {
  return connection_->open;
}

ModbusOutcome ModbusMaster::read_input_registers(std::uint16_t address,
                                                 std::span<std::uint16_t> values) {
  const int count = static_cast<int>(values.size());
  return connection_->ask("read input registers", count, [&](modbus_t* context) {
    return modbus_read_input_registers(context, address, count, values.data());
  });
}

ModbusOutcome ModbusMaster::read_holding_registers(std::uint16_t address,
                                                   std::span<std::uint16_t> values) {
  const int count = static_cast<int>(values.size());
  return connection_->ask("read holding registers", count, [&](modbus_t* context) {
    return modbus_read_registers(context, address, count, values.data());
  });
}

ModbusOutcome ModbusMaster::write_register(std::uint16_t address, std::uint16_t value) {
  return connection_->ask("write register", 1, [&](modbus_t* context) {
    return modbus_write_register(context, address, value);
  });
}

ModbusOutcome ModbusMaster::write_registers(std::uint16_t address,
                                            std::span<const std::uint16_t> values) {
  const int count = static_cast<int>(values.size());
  return connection_->ask("write registers", count, [&](modbus_t* context) {
    return modbus_write_registers(context, address, count, values.data());
  });
}

ModbusOutcome ModbusMaster::read_write_registers(std::uint16_t write_address,
                                                 std::span<const std::uint16_t> written,
                                                 std::uint16_t read_address,
                                                 std::span<std::uint16_t> read) {
  const int count = static_cast<int>(read.size());
  return connection_->ask("read and write registers", count, [&](modbus_t* context) {
    return modbus_write_and_read_registers(context, write_address, static_cast<int>(written.size()),
                                           written.data(), read_address, count, read.data());
  });
}

ModbusOutcome ModbusMaster::transact(std::span<const std::uint8_t> pdu,
                                     std::span<std::uint8_t> answer, std::size_t& size) {
  Connection& c = *connection_;
  constexpr const char* kWhat = "transact";
  size = 0;
  if (!c.open) {
    return c.not_connected(kWhat);
  }
  std::array<std::uint8_t, 1 + protocols::modbus::kPduMaximum> request{};
  if (pdu.empty() || pdu.size() > protocols::modbus::kPduMaximum) {
    return {"transact: a PDU has 1 .. 253 bytes, found " + std::to_string(pdu.size()), {}};
  }
  request[0] = c.settings.unit;
  std::ranges::copy(pdu, request.begin() + 1);
  const int length = static_cast<int>(1 + pdu.size());
  if (modbus_send_raw_request(c.context.get(), request.data(), length) < 0) {
    return c.judge(kWhat, -1, 0);
  }
  return c.receive(kWhat, answer, size);
}

}  // namespace rigwire::drivers
