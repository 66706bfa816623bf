// What no public EtherNet/IP client does, on real sockets against a live plant: input only, listen only, multicast,
// change of state, a second owner from its own address, Large_Forward_Open, null Forward_Open, refusals with the right
// value, ListIdentity by broadcast. CIP Vol 1, 3-5.5.2 and 3-6.5; Vol 2, 2-4.2 and 3-4.
//
// Usage: eip_scanner_story TARGET OWN OTHER BROADCAST_DEVICES      BROADCAST_DEVICES: addresses, with commas between
#include <arpa/inet.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <thread>

#include "tests/support/eip_scanner.hpp"

namespace {

using namespace vinv::scanner;
using Clock = std::chrono::steady_clock;

constexpr std::uint16_t kO2t = 10, kT2o = 6;  // 21 and 71: four bytes of data
constexpr int kPatienceMs = 10'000;
const Octets kIdle{0x60, 0, 0, 0};
const Octets kRun30Hz{0x61, 0, 0x84, 0x03};  // 900 r/min

[[noreturn]] void fail(int line, const std::string& what) {
  std::fprintf(stderr, "line %d: %s\n", line, what.c_str());
  std::exit(1);
}
#define REQUIRE(condition, what) \
  if (!(condition)) fail(__LINE__, what)

std::uint32_t address(const std::string& text) { return ntohl(inet_addr(text.c_str())); }

std::string words(const std::vector<std::uint16_t>& list) {
  std::string out;
  char text[8];
  for (const std::uint16_t w : list) {
    std::snprintf(text, sizeof text, "%04X ", w);
    out += text;
  }
  return out;
}

OpenOptions owner(std::uint16_t serial) {
  OpenOptions o;
  o.connection_serial = serial;
  o.timeout_multiplier = 3;  // 32 intervals
  o.o2t_size = kO2t;
  o.t2o_size = kT2o;
  o.path = {0x20, 4, 0x24, 1, 0x2c, 21, 0x2c, 71};
  return o;
}
// Heartbeats of a sequence count; the multicast of 71.
OpenOptions listener(std::uint16_t serial, std::uint8_t point) {
  OpenOptions o = owner(serial);
  o.o2t_size = 2;
  o.t2o_multicast = true;
  o.path = {0x20, 4, 0x2c, point, 0x2c, 71};
  return o;
}
constexpr std::uint8_t kInputOnly = 238, kListenOnly = 237;

// A scanner that answers each packet of the drive with its own data, as scanners do that have no clock.
class Running {
 public:
  Running(EipScanner& scanner, const Opened& opened) : scanner_(scanner), connection_(opened) {}

  // Until the newest packet of this connection fits; its data without sequence count.
  template <class Fits>
  Octets until(const Octets& data, bool run, bool modeless, Fits fits, const char* what) {
    const auto end = Clock::now() + std::chrono::milliseconds(kPatienceMs);
    while (Clock::now() < end) {
      const auto packet = scanner_.receive_io(1000);
      if (!packet || packet->connection_id != connection_.t2o_id) continue;
      REQUIRE(packet->data.size() == std::size_t{connection_.asked.t2o_size}, "a packet of another size");
      if (++packets == 1) REQUIRE(packet->sequence > 0, "sequence");
      REQUIRE(last_ == 0 || packet->sequence > last_, "a sequence number that is not later");
      last_ = packet->sequence;
      scanner_.send_io(connection_, data, run, modeless);
      const Octets content(packet->data.begin() + 2, packet->data.end());
      if (fits(content)) return content;
    }
    fail(__LINE__, std::string("not in time: ") + what);
  }
  Octets any(const Octets& data) {
    return until(
        data, true, false, [](const Octets&) { return true; }, "a packet");
  }
  Opened& connection() { return connection_; }
  int packets = 0;

 private:
  EipScanner& scanner_;
  Opened connection_;
  std::uint32_t last_ = 0;
};

unsigned speed_of(const Octets& d) { return d[2] | static_cast<unsigned>(d[3]) << 8; }
bool runs_30_hz(const Octets& d) { return speed_of(d) == 900 && (d[0] & 4) != 0; }
bool stands(const Octets& d) { return speed_of(d) == 0 && (d[0] & 4) == 0; }

void refusals(EipScanner& s) {
  const auto refused = [&](OpenOptions o, const std::string& extended) {
    const Opened opened = s.open(o);
    REQUIRE(!opened.ok && opened.status == 1 && words(opened.extended) == extended,
            "refused with " + words(opened.extended) + "and not " + extended);
  };
  OpenOptions o = owner(1);
  o.o2t_size = 12;
  refused(o, "0127 000A ");
  o = owner(1);
  o.t2o_size = 8;
  refused(o, "0128 0006 ");
  o = owner(1);
  o.t2o_rpi_us = 500;
  refused(o, "0112 0200 2710 0000 03E8 0000 ");
  o = owner(1);
  o.path = {0x20, 4, 0x24, 1, 0x2c, 126, 0x2c, 71};  // not the selected one
  refused(o, "012A ");
  o.path = {0x34, 4, 0xa2, 0, 0, 0, 0, 0, 0, 0, 0x20, 4, 0x24, 1, 0x2c, 21, 0x2c, 71};
  refused(o, "0114 ");
  o = owner(1);
  o.transport = 0x02;
  refused(o, "011C ");
  refused(listener(1, kListenOnly), "0119 ");
}

void owner_and_a_second_one(EipScanner& s, EipScanner& other) {
  Running first(s, s.open(owner(2)));
  REQUIRE(first.connection().ok, words(first.connection().extended));
  REQUIRE(first.connection().t2o_api_us == 10'000, "the interval answered");
  first.any(kIdle);
  const Opened second = other.open(owner(20));
  REQUIRE(!second.ok && words(second.extended) == "0106 ", "a second owner: " + words(second.extended));
  OpenOptions again = owner(2);
  const Opened duplicate = s.open(again);
  REQUIRE(!duplicate.ok && words(duplicate.extended) == "0100 ", "the same triad: " + words(duplicate.extended));
  first.until(kRun30Hz, true, false, runs_30_hz, "30 Hz");
  // Data of another address does not count.
  Opened forged = first.connection();
  forged.sequence += 1000;
  forged.count = static_cast<std::uint16_t>(forged.count + 1000);
  for (int i = 0; i < 5; ++i) other.send_io(forged, kIdle);
  for (int i = 0; i < 20; ++i) REQUIRE(runs_30_hz(first.any(kRun30Hz)), "still 30 Hz");
  first.until(kRun30Hz, false, false, stands, "idle takes the run bit away");
  REQUIRE(s.close(first.connection()).status == 0, "Forward_Close");
  Running mine(other, other.open(owner(3)));
  REQUIRE(mine.connection().ok, "the second one, when the first has closed");
  mine.until(kRun30Hz, true, false, runs_30_hz, "30 Hz by the second");
  mine.until(kIdle, true, false, stands, "its stop");
  REQUIRE(other.close(mine.connection()).status == 0, "Forward_Close");
}

void large_and_null(EipScanner& s) {
  OpenOptions large = owner(4);
  large.large = true;
  Running connection(s, s.open(large));
  REQUIRE(connection.connection().ok, "Large_Forward_Open");
  connection.any(kIdle);
  // Null open of a connection that there is: it stays, and is confirmed.
  OpenOptions null = owner(4);
  null.null = true;
  const Opened same = s.open(null);
  REQUIRE(same.ok && same.o2t_id == connection.connection().o2t_id, "null Forward_Open of the connection");
  for (int i = 0; i < 5; ++i) connection.any(kIdle);
  REQUIRE(s.close(connection.connection()).status == 0, "Forward_Close");
  null.connection_serial = 5;
  REQUIRE(s.open(null).ok, "null Forward_Open asks whether the points are there");
  null.path = {0x20, 4, 0x24, 1, 0x2c, 99, 0x2c, 71};
  REQUIRE(words(s.open(null).extended) == "012A ", "a point that is not there");
  OpenOptions modeless = owner(6);
  modeless.o2t_size = kO2t - 4;
  Running bare(s, s.open(modeless));
  REQUIRE(bare.connection().ok, "without run/idle header");
  bare.until(kRun30Hz, true, true, runs_30_hz, "30 Hz");
  bare.until(kIdle, true, true, stands, "the stop");
  REQUIRE(s.close(bare.connection()).status == 0, "Forward_Close");
}

void multicast(EipScanner& s, EipScanner& other) {
  OpenOptions o = owner(7);
  o.t2o_multicast = true;
  Opened owns = s.open(o);
  REQUIRE(owns.ok && owns.multicast_group >> 24 == 239, "owner of a multicast");
  REQUIRE(s.join(owns.multicast_group) && other.join(owns.multicast_group), "joined");
  const Opened listens = other.open(listener(8, kListenOnly));
  REQUIRE(listens.ok && listens.t2o_id == owns.t2o_id && listens.multicast_group == owns.multicast_group,
          "who listens hears the same production");
  const Opened inputs = other.open(listener(9, kInputOnly));
  REQUIRE(inputs.ok && inputs.t2o_id == owns.t2o_id, "input only joins it");
  Running first(s, owns), hears(other, listens);
  Opened heartbeat = inputs;
  first.until(kRun30Hz, true, false, runs_30_hz, "30 Hz");
  hears.until({}, true, true, runs_30_hz, "30 Hz, heard");
  // Heartbeats of the others; the owner closes: input only keeps the production up, and the listener with it.
  REQUIRE(s.close(first.connection()).status == 0, "Forward_Close");
  for (int i = 0; i < 30; ++i) {
    hears.until(
        {}, true, true, [](const Octets&) { return true; }, "a packet without owner");
    other.send_io(heartbeat, {}, true, true);
  }
  REQUIRE(other.close(heartbeat).status == 0, "Forward_Close of input only");
  while (other.receive_io(300)) {
  }
  const Reply gone = other.close(hears.connection());
  REQUIRE(gone.status == 1 && words(gone.extended) == "0107 ", "the listener ended with the last one that was not");
}

void change_of_state(EipScanner& s) {
  Opened owns = s.open(owner(10));
  REQUIRE(owns.ok, "owner");
  Running first(s, owns);
  first.until(kIdle, true, false, stands, "standstill");
  OpenOptions o = listener(11, kInputOnly);
  o.t2o_multicast = false;
  o.transport = 0x11;
  o.t2o_rpi_us = 500'000;
  Opened quiet = s.open(o);
  REQUIRE(quiet.ok, "change of state: " + words(quiet.extended));
  int cyclic = 0, of_change = 0, fresh = 0;
  std::uint16_t last_count = 0;
  const auto serve = [&](const Octets& data, int milliseconds) {
    const auto end = Clock::now() + std::chrono::milliseconds(milliseconds);
    while (Clock::now() < end) {
      const auto packet = s.receive_io(200);
      if (!packet) continue;
      if (packet->connection_id == owns.t2o_id) {
        ++cyclic;
        s.send_io(first.connection(), data);
        if (cyclic % 8 == 0) s.send_io(quiet, {}, true, true);
      } else if (packet->connection_id == quiet.t2o_id) {
        ++of_change;
        const auto count = static_cast<std::uint16_t>(packet->data[0] | packet->data[1] << 8);
        fresh += count != last_count ? 1 : 0;
        last_count = count;
      }
    }
  };
  serve(kIdle, 300);
  of_change = fresh = cyclic = 0;
  serve(kIdle, 1500);
  REQUIRE(of_change >= 2 && of_change <= 4, "nothing changes: the interval alone, " + std::to_string(of_change));
  REQUIRE(fresh <= 1, "and without a new count");
  REQUIRE(cyclic > 50, "while the cyclic one goes on");
  of_change = fresh = 0;
  serve(kRun30Hz, 800);
  REQUIRE(fresh >= 3, "the ramp is told: " + std::to_string(fresh));
  REQUIRE(s.close(quiet).status == 0, "Forward_Close of input only");
  first.until(kIdle, true, false, stands, "the stop");
  REQUIRE(s.close(first.connection()).status == 0, "Forward_Close");
}

void list_identity(EipScanner& s, const std::string& devices) {
  std::vector<std::uint32_t> wanted;
  std::stringstream list(devices);
  for (std::string one; std::getline(list, one, ',');) wanted.push_back(address(one));
  const auto answers = s.list_identity(address("127.255.255.255"), 500, 1500);
  for (const std::uint32_t device : wanted) {
    // Socket address of the answer: big-endian, behind header, count, item header, version, family and port.
    const bool answered = std::any_of(answers.begin(), answers.end(), [&](const Octets& a) {
      if (a.size() < 44) return false;
      std::uint32_t of = 0;
      for (std::size_t i = 36; i < 40; ++i) of = of << 8 | a[i];
      return of == device;
    });
    REQUIRE(answered, "no answer of one of the devices; " + std::to_string(answers.size()) + " answers");
  }
  const auto one = s.list_identity(wanted[0], 0, 500);
  REQUIRE(one.size() == 1, "one answer to who is asked alone");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  EipScanner scanner(address(argv[2]), address(argv[1])), other(address(argv[3]), address(argv[1]));
  REQUIRE(scanner.connect() && other.connect() && scanner.open_io() && other.open_io(), "connected");
  const auto step = [](const char* name, auto&& run) {
    const auto start = Clock::now();
    run();
    std::printf(
        "%s: %lld ms\n", name,
        static_cast<long long>(std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - start).count()));
    std::fflush(stdout);
  };
  step("refusals", [&] { refusals(scanner); });
  step("owners", [&] { owner_and_a_second_one(scanner, other); });
  step("large, null and modeless", [&] { large_and_null(scanner); });
  step("multicast", [&] { multicast(scanner, other); });
  step("change of state", [&] { change_of_state(scanner); });
  step("ListIdentity", [&] { list_identity(scanner, argv[4]); });
}
