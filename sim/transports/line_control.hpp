// Speed, parity and raw mode of a tty, through Linux's termios2, which can do any speed. Kept apart because its header
// and <termios.h> exclude each other.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/base/result.hpp"
#include "sim/transports/serial_line.hpp"

namespace vinv::transports {

// Raw 8N1 without echo, at this speed.
bool make_raw(int fd, std::uint32_t baud);
// Raw, with errors marked as ParityMarks reads them. The reason if the device does not take the speed or parity.
Result<void, std::string> configure_line(int fd, const LineSettings& settings);
// What the other end of a pseudo-terminal sends with.
std::optional<std::uint32_t> line_speed(int fd);
// Drops what has arrived and was not read.
void flush_input(int fd);

}  // namespace vinv::transports
