// Drives with their adapters on sockets and nothing else: what the benchmarks measure where no plant file is wanted.
// Usage: enip_local_server ADDRESS [COUNT]     COUNT drives at ADDRESS and the addresses after it, until SIGINT. It
// says "ready" when they have started.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "sim/rig/catalogue.hpp"
#include "sim/rig/live_ethernet_ip.hpp"

namespace {

using namespace vinv;

struct Drive {
  explicit Drive(const rig::Catalogue& catalogue, std::uint32_t address) {
    inverter::InverterConfig config;
    config.model = "FR-A720-1.5K";
    config.motor = rig::default_motor(config.model);
    config.load = rig::default_load(config.motor);
    auto made = catalogue.make_inverter("fr-a700", config);
    if (!made) {
      std::fprintf(stderr, "%s\n", made.error().c_str());
      std::exit(1);
    }
    inverter = std::move(made).value();
    boards::fr_a7ne::CipUnitConfig unit_config;
    unit_config.timing = boards::fr_a7ne::Timing::fast();
    unit_config.ethernet.lease.address = address;
    unit = std::make_unique<boards::fr_a7ne::CipUnit>(inverter->port(), unit_config);
    adapter = std::make_unique<ethernet_ip::Adapter>(*unit, ethernet_ip::AdapterOptions{});
  }
  std::unique_ptr<inverter::Inverter> inverter;
  std::unique_ptr<boards::fr_a7ne::CipUnit> unit;
  std::unique_ptr<ethernet_ip::Adapter> adapter;
  std::unique_ptr<rig::EthernetIpPort> port;
};
}  // namespace

int main(int argc, char** argv) {
  const auto first = argc > 1 ? parse_ipv4(argv[1]) : std::nullopt;
  if (!first) {
    std::fprintf(stderr, "usage: enip_local_server ADDRESS [COUNT]\n");
    return 2;
  }
  const unsigned count = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  const rig::Catalogue catalogue = rig::shipped_catalogue();
  transports::EventLoop loop;
  std::vector<std::unique_ptr<Drive>> drives;
  rig::LiveEthernetIp host(loop);
  for (unsigned i = 0; i < count; ++i) {
    const std::uint32_t address = *first + i;
    drives.push_back(std::make_unique<Drive>(catalogue, address));
    rig::EthernetIpAddress where;
    where.address = address;
    Drive& drive = *drives.back();
    drive.port = std::make_unique<rig::EthernetIpPort>(loop.scheduler(), *drive.adapter);
    if (const auto added = host.add(*drive.port, where); !added) {
      std::fprintf(stderr, "%s\n", added.error().c_str());
      return 1;
    }
    drive.port->start(loop.now(), {address, 0, where.io_port});
    drives.back()->inverter->set_power(true);
    drives.back()->unit->handle_power(loop.now(), true);
  }
  bool announced = false;
  loop.scheduler().schedule_every(loop.scheduler().now() + std::chrono::milliseconds(1), std::chrono::milliseconds(1),
                                  kernel::Priority::kDrive, [&](Instant now) {
                                    for (const auto& d : drives) {
                                      d->inverter->tick(now);
                                      d->unit->handle_drive_tick(now);
                                      d->port->handle_new_data(now);
                                    }
                                    if (announced || !drives.back()->unit->online()) return;
                                    announced = true;
                                    std::printf("ready\n");
                                    std::fflush(stdout);
                                  });
  loop.on_signal([&](int) { loop.stop(); });
  loop.run();
  std::printf("%s\n", loop.lateness().text().c_str());
}
