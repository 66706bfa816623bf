#include "sim/transports/line_control.hpp"

#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>

#include "sim/transports/io_error.hpp"

namespace vinv::transports {
namespace {

struct StandardSpeed {
  std::uint32_t baud;
  tcflag_t code;
};
constexpr StandardSpeed kStandardSpeeds[] = {
    {50, B50},     {75, B75},       {110, B110},     {134, B134},     {150, B150},       {200, B200},
    {300, B300},   {600, B600},     {1200, B1200},   {1800, B1800},   {2400, B2400},     {4800, B4800},
    {9600, B9600}, {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}, {230400, B230400}};

// Programs that read the speed through the older interface know the standard codes only.
tcflag_t speed_code(std::uint32_t baud) {
  for (const StandardSpeed& s : kStandardSpeeds) {
    if (s.baud == baud) return s.code;
  }
  return BOTHER;
}

void set_raw(termios2& t, std::uint32_t baud) {
  t.c_iflag &= ~static_cast<tcflag_t>(IGNBRK | BRKINT | IGNPAR | PARMRK | INPCK | ISTRIP | INLCR | IGNCR | ICRNL |
                                      IXON | IXOFF | IXANY);
  t.c_oflag &= ~static_cast<tcflag_t>(OPOST);
  t.c_lflag &= ~static_cast<tcflag_t>(ECHO | ECHONL | ICANON | ISIG | IEXTEN);
  t.c_cflag &= ~static_cast<tcflag_t>(CSIZE | PARENB | PARODD | CMSPAR | CSTOPB | CRTSCTS | CBAUD | CIBAUD);
  t.c_cflag |= CS8 | CREAD | CLOCAL | speed_code(baud);
  t.c_ispeed = t.c_ospeed = baud;
  t.c_cc[VMIN] = 1;
  t.c_cc[VTIME] = 0;
}

}  // namespace

std::string text(const LineSettings& settings) {
  const char* framing = settings.parity == LineSettings::Parity::kNone   ? " 8N1"
                        : settings.parity == LineSettings::Parity::kEven ? " 8E1"
                                                                         : " 8O1";
  return std::to_string(settings.baud) + framing;
}

bool make_raw(int fd, std::uint32_t baud) {
  termios2 t{};
  if (::ioctl(fd, TCGETS2, &t) != 0) return false;
  set_raw(t, baud);
  return ::ioctl(fd, TCSETS2, &t) == 0;
}

Result<void, std::string> configure_line(int fd, const LineSettings& settings) {
  termios2 t{};
  if (::ioctl(fd, TCGETS2, &t) != 0) {
    return Unexpected(errno == ENOTTY ? std::string("not a serial device") : describe_errno(errno));
  }
  set_raw(t, settings.baud);
  // Without parity too: framing errors are marked the same way.
  t.c_iflag |= PARMRK | INPCK;
  if (settings.parity != LineSettings::Parity::kNone) t.c_cflag |= PARENB;
  if (settings.parity == LineSettings::Parity::kOdd) t.c_cflag |= PARODD;
  const tcflag_t parity = t.c_cflag & (PARENB | PARODD);
  if (::ioctl(fd, TCSETS2, &t) != 0) return Unexpected(text(settings) + ": " + describe_errno(errno));
  // A driver takes what it can and says nothing: read back what became of it.
  termios2 now{};
  if (::ioctl(fd, TCGETS2, &now) != 0) return Unexpected(describe_errno(errno));
  const std::int64_t error = static_cast<std::int64_t>(now.c_ospeed) - static_cast<std::int64_t>(settings.baud);
  if ((error < 0 ? -error : error) * 50 > settings.baud) {  // 2 % is what an asynchronous receiver bears
    return Unexpected("the device does not do " + std::to_string(settings.baud) + " baud");
  }
  if ((now.c_cflag & (PARENB | PARODD)) != parity) {
    return Unexpected("the device does not do the parity of " + text(settings));
  }
  return {};
}

std::optional<std::uint32_t> line_speed(int fd) {
  termios2 t{};
  if (::ioctl(fd, TCGETS2, &t) != 0) return std::nullopt;
  return t.c_ospeed;
}

void flush_input(int fd) { ::ioctl(fd, TCFLSH, TCIFLUSH); }

}  // namespace vinv::transports
