// An EtherNet/IP scanner on plain blocking sockets, which shares no code with the adapter: what no public client does
// (listen only, input only, multicast, change of state, a second owner from its own address). Every wait ends after a
// time-out, as an empty result.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace vinv::scanner {

using Octets = std::vector<std::uint8_t>;

struct OpenOptions {
  std::uint16_t connection_serial = 1;
  std::uint16_t vendor = 0x0511;
  std::uint32_t originator_serial = 0x0badcafe;
  std::uint8_t timeout_multiplier = 1;
  std::uint32_t o2t_rpi_us = 10'000, t2o_rpi_us = 10'000;
  std::uint16_t o2t_size = 10, t2o_size = 6;  // with sequence count and header, as they go into the request
  bool t2o_multicast = false;
  std::uint8_t transport = 0x01;  // 0x11 change of state, 0x21 application, 0xA3 class 3
  Octets path;                    // whole connection path
  bool large = false;
  bool null = false;  // no connection: both types null
};

// A connection as it was answered; not opened: status and its extended words.
struct Opened {
  bool ok = false;
  std::uint8_t status = 0xff;
  std::vector<std::uint16_t> extended;
  std::uint32_t o2t_id = 0, t2o_id = 0;
  std::uint32_t o2t_api_us = 0, t2o_api_us = 0;
  std::uint32_t multicast_group = 0;  // host order; 0: none
  OpenOptions asked;
  std::uint32_t sequence = 0;  // of what was sent
  std::uint16_t count = 0;
};

struct IoPacket {
  std::uint32_t from = 0;  // host order, as all addresses here
  std::uint32_t to = 0;
  std::uint32_t connection_id = 0;
  std::uint32_t sequence = 0;
  Octets data;  // of the data item
};

struct Reply {
  bool answered = false;
  std::uint8_t service = 0;
  std::uint8_t status = 0xff;
  std::vector<std::uint16_t> extended;
  Octets data;
};

class EipScanner {
 public:
  // Uses own for its TCP connection and, once open_io is called, UDP 2222.
  EipScanner(std::uint32_t own, std::uint32_t target, std::uint16_t port = 44818, std::uint16_t io_port = 2222)
      : own_(own), target_(target), port_(port), io_port_(io_port) {}
  ~EipScanner();
  EipScanner(const EipScanner&) = delete;
  EipScanner& operator=(const EipScanner&) = delete;

  bool connect();  // and register a session
  void disconnect();
  bool open_io();
  // Listens to a group on the interface of own.
  bool join(std::uint32_t group);

  // Unconnected: service, words of path, path, data.
  Reply request(const Octets& message);
  Reply get_attribute(std::uint16_t class_id, std::uint16_t instance, std::uint8_t attribute);
  Opened open(const OpenOptions& options);
  Reply close(const Opened& connection);
  Reply connected_request(Opened& class3, const Octets& message);

  // Class 1; header of 4 bytes with run or idle in front unless modeless.
  void send_io(Opened& connection, const Octets& data, bool run = true, bool modeless = false);
  std::optional<IoPacket> receive_io(int timeout_ms);

  // Whole encapsulation answers to a ListIdentity sent to an address, for so long.
  std::vector<Octets> list_identity(std::uint32_t to, std::uint16_t max_delay_ms, int listen_ms);
  // The whole message that get_attribute sends, for whoever does without its waiting.
  Octets get_attribute_message(std::uint16_t class_id, std::uint16_t instance, std::uint8_t attribute) const;
  // The sockets, for whoever waits on many; -1: not open. They stay the scanner's.
  int tcp() const { return tcp_; }
  int udp() const { return udp_; }
  // Sends these bytes as they are over the TCP connection.
  bool send_raw(const Octets& bytes);
  // The next whole encapsulation message; empty after the time-out or if the connection has ended.
  Octets receive_message(int timeout_ms);

 private:
  Octets exchange(std::uint16_t command, const Octets& data);
  Octets encapsulate(std::uint16_t command, const Octets& data) const;
  int new_udp(std::uint32_t address, std::uint16_t port, bool shared) const;

  std::uint32_t own_, target_;
  std::uint16_t port_, io_port_;  // of the target
  int tcp_ = -1, udp_ = -1;
  std::vector<int> groups_;
  std::uint32_t session_ = 0;
  std::uint16_t class3_count_ = 0;
};

}  // namespace vinv::scanner
