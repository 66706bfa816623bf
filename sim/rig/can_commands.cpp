#include "sim/rig/can_commands.hpp"

#include <cmath>
#include <utility>

#include "sim/rig/wire_commands.hpp"

namespace vinv::rig {
namespace {

// Two digits after the point are enough for a person.
double rounded(double percent) { return std::round(percent * 100) / 100; }

}  // namespace

Json can_json(Plant& plant, const DriveUnit& drive) {
  const CanLine& line = *plant.can_line_of(drive);
  const transports::CanStatus status = line.controller(*drive.controller).status();
  const transports::CanBusStats stats = line.bus().stats(plant.now());
  return {{"network", line.bus().options().name},
          {"node", drive.can_node()},
          {"bitrate", drive.board->can_channel()->bit_rate()},
          {"state", text(status.state)},
          {"tec", status.counters.tec},
          {"rec", status.counters.rec},
          {"sent", status.sent},
          {"received", status.received},
          {"lost", status.lost},
          {"bus_load_percent", rounded(stats.load.last_second * 100)}};
}

Json buses_json(Plant& plant) {
  Json out = Json::array();
  const auto& networks = plant.file().can;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const CanLine& line = plant.can_line(i);
    Json drives = Json::array();
    for (const auto& d : plant.drives())
      if (plant.can_line_of(*d) == &line)
        drives.push_back({{"name", d->spec.name},
                          {"node", d->can_node()},
                          {"state", text(line.controller(*d->controller).status().state)}});
    if (drives.empty()) continue;
    const transports::CanBusStats stats = line.bus().stats(plant.now());
    Json row{{"name", networks[i].name},
             {"can", text_of(networks[i])},
             {"bitrate", networks[i].bitrate},
             {"load_percent", rounded(stats.load.last_second * 100)},
             {"peak_load_percent", rounded(stats.load.peak_second * 100)},
             {"frames", stats.frames},
             {"error_frames", stats.error_frames},
             {"arbitrations_lost", stats.arbitrations_lost},
             {"nodes", stats.nodes},
             {"faults", faults_json(line)},
             {"faults_injected", stats.faults_injected},
             {"drives", std::move(drives)}};
    if (const transports::CanBridge* bridge = line.bridge()) {
      const transports::CanStatus outside = bridge->outside().status();
      row["outside"] = {{"state", text(outside.state)}, {"lost", bridge->lost() + outside.lost}};
    }
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace vinv::rig
