// libmodbus as a master: a request a line on standard input, its outcome a line on standard output.
// Usage: libmodbus_master tcp HOST:PORT UNIT BAUD TIMEOUT_MS      libmodbus_master rtu PATH UNIT BAUD TIMEOUT_MS
#include <modbus/modbus.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

namespace {

modbus_t* make_context(const std::string& kind, const std::string& target, int baud) {
  if (kind == "rtu") return modbus_new_rtu(target.c_str(), baud, 'N', 8, 1);
  const auto colon = target.rfind(':');
  return modbus_new_tcp(target.substr(0, colon).c_str(), std::atoi(target.substr(colon + 1).c_str()));
}

std::string failure(modbus_t* context) {
  const int reason = errno;
  modbus_flush(context);
  if (reason > MODBUS_ENOBASE && reason < EMBBADCRC) return "exception " + std::to_string(reason - MODBUS_ENOBASE);
  if (reason == ETIMEDOUT) return "silence";
  return std::string("error ") + modbus_strerror(reason);
}

std::string ask(modbus_t* context, const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  int address = 0, value = 0;
  words >> verb >> address >> value;
  if (verb == "write")
    return modbus_write_register(context, address, static_cast<std::uint16_t>(value)) == 1 ? "ok" : failure(context);
  std::vector<std::uint16_t> registers(static_cast<std::size_t>(value));
  const auto call = verb == "read" ? modbus_read_registers : modbus_read_input_registers;
  if (call(context, address, value, registers.data()) != value) return failure(context);
  std::string answer = "ok";
  for (const auto r : registers) answer += " " + std::to_string(r);
  return answer;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  modbus_t* context = make_context(argv[1], argv[2], std::atoi(argv[4]));
  if (context == nullptr || modbus_set_slave(context, std::atoi(argv[3])) != 0 || modbus_connect(context) != 0) {
    std::cout << "error " << modbus_strerror(errno) << std::endl;
    return 1;
  }
  const auto timeout_ms = static_cast<std::uint32_t>(std::atoi(argv[5]));
  modbus_set_response_timeout(context, timeout_ms / 1000, timeout_ms % 1000 * 1000);
  for (std::string line; std::getline(std::cin, line);) std::cout << ask(context, line) << std::endl;
  modbus_close(context);
  modbus_free(context);
}
