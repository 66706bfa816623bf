#include "sim/rig/node_plan.hpp"

#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>

namespace vinv::rig {
namespace {

struct Address {
  unsigned node = 0;  // 0: not given yet
  Position at;
  std::string_view parameter;  // that gives it; empty: the switches
};

std::string_view number_of(std::string_view parameter) {
  return parameter.starts_with("Pr.") ? parameter.substr(3) : parameter;
}

bool has_node(const DriveSpec& d) { return d.board && !d.board->ethernet; }

// The drive has a board with a node.
Address address_of(const DriveSpec& d) {
  const BoardSpec& board = *d.board;
  const std::string_view parameter = node_parameter(board.type.value);
  if (!parameter.empty())
    for (const auto& [name, value] : d.parameters)
      if (number_of(name.value) == number_of(parameter))
        if (const unsigned node = node_of_parameter(board.type.value, value.value); node != 0)
          return {node, value.at, parameter};
  return {board.node.value, board.node.at, {}};
}

}  // namespace

void assign_nodes(PlantFile& file, Problems& problems) {
  std::set<unsigned> used;
  for (const DriveSpec& d : file.drives)
    if (has_node(d)) used.insert({d.board->node.value, address_of(d).node});
  unsigned next = 1;
  for (DriveSpec& d : file.drives) {
    if (!has_node(d) || d.board->node.value != 0) continue;
    while (used.count(next) > 0) ++next;
    d.board->node.value = next;
    used.insert(next);
  }

  enum class Wire { kSerial, kTcp, kCan };
  std::map<std::tuple<Wire, std::size_t, unsigned>, const DriveSpec*> taken;
  for (const DriveSpec& d : file.drives) {
    if (!has_node(d)) continue;
    const Address address = address_of(d);
    const std::array<std::tuple<Wire, std::optional<std::size_t>, const char*>, 3> wires{{
        {Wire::kSerial, d.board->serial, "serial line"},
        {Wire::kTcp, d.board->tcp, "Modbus/TCP port"},
        {Wire::kCan, d.board->can, "CAN bus"},
    }};
    bool told = false;
    for (const auto& [wire, index, name] : wires) {
      if (!index) continue;
      const auto [first, fresh] = taken.emplace(std::tuple(wire, *index, address.node), &d);
      if (fresh || told) continue;
      told = true;
      problems.add(address.at, "node " + std::to_string(address.node) + " of " + d.name +
                                   (address.parameter.empty() ? "" : " (" + std::string(address.parameter) + ")") +
                                   " is taken by " + first->second->name + " on the same " + name +
                                   "; allowed: another node, or a wire of its own.");
    }
  }
}

}  // namespace vinv::rig
