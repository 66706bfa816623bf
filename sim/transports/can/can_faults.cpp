#include "sim/transports/can/can_faults.hpp"

#include <algorithm>

namespace vinv::transports {

CanVerdict CanFaultJudge::judge(Instant now, const CanFrame& frame, std::string_view node) {
  CanVerdict verdict;
  for (std::size_t i = 0; i < plan_.rules.size(); ++i) {
    const CanFaultRule& rule = plan_.rules[i];
    if (((frame.id ^ rule.id) & rule.mask) != 0) continue;
    if (rule.extended && *rule.extended != frame.extended) continue;
    if (!rule.node.empty() && rule.node != node) continue;
    if (std::find(rule.not_nodes.begin(), rule.not_nodes.end(), node) != rule.not_nodes.end()) continue;
    if (!counts_[i].hit(rule.when, now, random_)) continue;
    ++injected_;
    switch (rule.fault) {
      case CanFault::kDrop: verdict.drop = true; break;
      case CanFault::kDelay: verdict.delay += rule.delay; break;
      case CanFault::kDuplicate:
        ++verdict.copies;
        verdict.copies_after = std::max(verdict.copies_after, rule.delay);
        break;
      case CanFault::kCorrupt: verdict.corrupt += rule.times; break;
      case CanFault::kErrorFrame: verdict.error_frames += rule.times; break;
      case CanFault::kBusOff: verdict.bus_off = true; break;
      case CanFault::kReorder: verdict.reorder = rule.delay; break;
      case CanFault::kSilence: verdict.silence = true; break;
      case CanFault::kTwin: verdict.twin = true; break;
    }
  }
  return verdict;
}

}  // namespace vinv::transports
