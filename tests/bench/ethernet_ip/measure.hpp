// What the EtherNet/IP benchmarks share: processors, processor time, quantiles, a monotonic clock in nanoseconds.
#pragma once

#include <cstdint>
#include <vector>

namespace vinv::bench {

std::int64_t monotonic_ns();
void sleep_until_ns(std::int64_t at);

// All threads of a process (0: this one) to one processor; false if that is not allowed. cpu < 0: nothing is done.
bool pin(int pid, int cpu);
// User and system time of a process, in seconds; 0 if it cannot be read.
double cpu_seconds(int pid);
// Resident memory of a process, in bytes; 0 if it cannot be read.
std::int64_t resident_bytes(int pid);

// fraction 0 to 1, by sorting what is given; 0 if there is nothing.
double quantile(std::vector<double>& values, double fraction);
double median(std::vector<double> values);

// A child process that runs what it is given, ended with the object.
class Child {
 public:
  template <class Body>
  explicit Child(Body body) : pid_(fork_process()) {
    if (pid_ == 0) {
      body();
      leave();
    }
  }
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  int pid() const { return pid_; }

 private:
  static int fork_process();
  [[noreturn]] static void leave();
  int pid_;
};

}  // namespace vinv::bench
