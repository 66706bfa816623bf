#include "sim/campaign/isolation.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <vector>

namespace vinv::campaign {
namespace {

bool send_all(int to, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t n = ::send(to, bytes, size, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

bool receive_all(int from, char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t n = ::recv(from, bytes, size, 0);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

// A text is its length and its bytes.
bool send_text(int to, const std::string& text) {
  const std::uint64_t size = text.size();
  return send_all(to, reinterpret_cast<const char*>(&size), sizeof size) && send_all(to, text.data(), text.size());
}

bool receive_text(int from, std::string& text) {
  std::uint64_t size = 0;
  if (!receive_all(from, reinterpret_cast<char*>(&size), sizeof size)) return false;
  text.resize(size);
  return receive_all(from, text.data(), text.size());
}

struct Worker {
  pid_t process = -1;
  int wire = -1;
  std::optional<std::size_t> task;
};

class Pool {
 public:
  explicit Pool(const std::function<std::string(const std::string&)>& work) : work_(work) {}
  ~Pool() {
    for (Worker& w : workers_) {
      if (w.process < 0) continue;
      ::kill(w.process, SIGKILL);
      end(w);
    }
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  void resize(std::size_t n) { workers_.resize(n); }
  std::vector<Worker>& workers() { return workers_; }

  void start(Worker& w) {
    int pair[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
      throw std::runtime_error(std::string("no process can be made: ") + std::strerror(errno) + ".");
    const pid_t parent = ::getpid();
    const pid_t process = ::fork();
    if (process < 0) {
      const int error = errno;
      ::close(pair[0]);
      ::close(pair[1]);
      throw std::runtime_error(std::string("no process can be made: ") + std::strerror(error) + ".");
    }
    if (process == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (::getppid() != parent) ::_exit(0);
      ::close(pair[0]);
      for (const Worker& other : workers_)
        if (other.wire >= 0) ::close(other.wire);
      serve(pair[1]);
    }
    ::close(pair[1]);
    w.process = process;
    w.wire = pair[0];
  }

  // Waits for the process; its status as waitpid gives it.
  static int end(Worker& w) {
    ::close(w.wire);
    int status = 0;
    while (::waitpid(w.process, &status, 0) < 0 && errno == EINTR) {
    }
    w = {};
    return status;
  }

 private:
  [[noreturn]] void serve(int wire) {
    std::string task;
    while (receive_text(wire, task)) {
      std::string answer;
      try {
        answer = work_(task);
      } catch (const std::exception&) {
        ::abort();
      }
      if (!send_text(wire, answer)) break;
    }
    ::_exit(0);
  }

  const std::function<std::string(const std::string&)>& work_;
  std::vector<Worker> workers_;
};

Answer death(int status) {
  Answer out;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    const bool own = signal == SIGSEGV || signal == SIGABRT || signal == SIGBUS || signal == SIGFPE ||
                     signal == SIGILL || signal == SIGSYS;
    out.kind = own ? Answer::Kind::kCrashed : Answer::Kind::kStopped;
    out.text = fmt::format("the process died of signal {} (SIG{}).", signal,
                           ::sigabbrev_np(signal) == nullptr ? "?" : ::sigabbrev_np(signal));
  } else {
    out.kind = Answer::Kind::kCrashed;
    out.text = fmt::format("the process ended with status {}.", WEXITSTATUS(status));
  }
  return out;
}

}  // namespace

void run_isolated(std::size_t processes, const std::function<std::optional<std::string>()>& next,
                  const std::function<std::string(const std::string&)>& work,
                  const std::function<bool(std::size_t, const Answer&)>& done) {
  Pool pool(work);
  pool.resize(processes == 0 ? 1 : processes);
  std::size_t tasks = 0;
  bool more = true;
  std::vector<pollfd> waiting;
  for (;;) {
    for (Worker& w : pool.workers()) {
      if (!more || w.task) continue;
      const auto task = next();
      if (!task) {
        more = false;
        break;
      }
      if (w.process < 0) pool.start(w);
      w.task = tasks++;
      // That it has died meanwhile is seen when its answer is read.
      static_cast<void>(send_text(w.wire, *task));
    }
    waiting.clear();
    for (const Worker& w : pool.workers())
      if (w.task) waiting.push_back({w.wire, POLLIN, 0});
    if (waiting.empty()) break;
    if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR)
      throw std::runtime_error(std::string("waiting for a process failed: ") + std::strerror(errno) + ".");
    for (const pollfd& p : waiting) {
      if (p.revents == 0) continue;
      for (Worker& w : pool.workers()) {
        if (w.wire != p.fd || !w.task) continue;
        const std::size_t task = *w.task;
        Answer answer;
        if (receive_text(w.wire, answer.text))
          w.task.reset();
        else
          answer = death(Pool::end(w));
        if (!done(task, answer)) more = false;
        break;
      }
    }
  }
  for (Worker& w : pool.workers())
    if (w.process >= 0) Pool::end(w);
}

}  // namespace vinv::campaign
