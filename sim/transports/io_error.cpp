#include "sim/transports/io_error.hpp"

#include <cerrno>
#include <system_error>

namespace vinv::transports {

std::string describe_errno(int error) {
  switch (error) {
    case EADDRINUSE: return "address in use";
    case EADDRNOTAVAIL: return "not an address of this machine";
    case EACCES:
    case EPERM: return "not permitted";
    case ENOENT: return "no such file or directory";
    case EMFILE: return "too many open files in this process (see ulimit -n)";
    default: return std::generic_category().message(error);
  }
}

std::string describe_disconnect(int error) {
  switch (error) {
    case 0: return "closed by the peer";
    case EPIPE:
    case ECONNRESET: return "connection reset by the peer";
    case ETIMEDOUT: return "the peer no longer answers";
    default: return describe_errno(error);
  }
}

}  // namespace vinv::transports
