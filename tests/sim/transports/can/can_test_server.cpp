// A bus for foreign clients to try: serves socketcand, slcan on TCP and slcan on a pseudo-terminal, prints where, and
// runs until its standard input ends. A node on it answers data frames of identifier 0x100 to 0x6ff with the same data,
// and remote frames with a data frame of their length, at the identifier before; a frame 0x7f0 makes it send as many
// frames as its two bytes say, at once. With an argument it also joins that multicast group, on this
// machine only.
#include <asio/io_context.hpp>
#include <asio/posix/stream_descriptor.hpp>
#include <iostream>

#include "sim/transports/can/can_bridge.hpp"
#include "sim/transports/can/can_recorder.hpp"
#include "sim/transports/can/can_servers.hpp"
#include "sim/transports/can/udp_multicast_port.hpp"

using namespace vinv;
using namespace vinv::transports;

int main(int argc, char** argv) {
  EventLoop loop;
  CanBusOptions options;
  options.bitrate = 125'000;
  CanBus bus(loop.scheduler(), options);
  CanNodeOptions node_options;
  node_options.name = "answers";
  node_options.queue_frames = 2000;
  const auto node = bus.attach(loop.now(), node_options);
  node->set_handlers({[&](Instant now, const CanFrame& frame) {
                        if (frame.id == 0x7f0) {
                          const int count = frame.data[0] << 8 | frame.data[1];
                          for (int i = 0; i < count; ++i) {
                            node->send(now, CanFrame::standard(0x7f1, {static_cast<std::uint8_t>(i >> 8),
                                                                       static_cast<std::uint8_t>(i)}));
                          }
                        }
                        if (frame.id < 0x100 || frame.id >= 0x700) return;
                        CanFrame answer = frame;
                        --answer.id;
                        answer.remote = false;
                        node->send(now, answer);
                      },
                      {},
                      {}});
  const auto socketcand = SocketcandServer::open(loop, {}, {{{"line_can", &bus}}, 1'700'000'000'000'000'000});
  const auto slcan = SlcanServer::open(loop, {}, bus);
  const auto pty = SlcanPty::open(loop, "", bus);
  if (!socketcand || !slcan || !pty) return 1;
  std::unique_ptr<CanBridge> multicast;
  if (argc > 1) {
    auto port = UdpMulticastPort::open(loop, {argv[1], 43113, 0});
    if (!port) {
      std::cerr << port.error() << '\n';
      return 1;
    }
    multicast = std::make_unique<CanBridge>(loop.now(), bus, std::move(*port));
  }
  std::cout << (*socketcand)->port() << ' ' << (*slcan)->port() << ' ' << (*pty)->path() << std::endl;

  asio::posix::stream_descriptor input(loop.io(), ::dup(0));
  char byte = 0;
  std::function<void()> wait = [&] {
    input.async_read_some(asio::buffer(&byte, 1), [&](const asio::error_code& error, std::size_t) {
      if (error)
        loop.stop();
      else
        wait();
    });
  };
  wait();
  loop.run();
  return 0;
}
