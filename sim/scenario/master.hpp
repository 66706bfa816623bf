// A master on a wire, as a scenario sees it: a protocol client of ours that talks bytes to the boards in virtual time.
// `via: NAME` sends a step's word through it instead of doing it by hand at the drive.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"
#include "sim/rig/commands.hpp"
#include "sim/scenario/recording.hpp"
#include "sim/transports/udp_port.hpp"

namespace vinv::scenario {

// One thing at a time: begin_ starts it, poll() tells when it is done. Both are called by the runner between ticks;
// what a master does in between is its own business on the plant's scheduler.
class Master {
 public:
  // The answer to an action: a value to show, or why not, as a sentence (the protocol's own code named).
  using Outcome = Result<rig::Json, std::string>;
  virtual ~Master() = default;

  // Words that begin() understands; the loader refuses others. "run", "stop", "reference", "parameter", "reset" ...
  virtual std::vector<std::string_view> words() const = 0;
  virtual void begin(Instant now, std::size_t drive, std::string_view word, const rig::Json& value) = 0;
  // The outcome of what was begun, once.
  virtual std::optional<Outcome> poll(Instant now) = 0;

  // Raw: bytes of a whole frame as the protocol counts them (CAN: identifier big-endian in 4 bytes, then data).
  virtual void send_frame(Instant now, ByteView frame) = 0;
  // Frames that have arrived since the last call, oldest first.
  virtual std::vector<Bytes> take_frames() = 0;

  // Snapshots. Before the plant: the wires that it is on, made anew in a load, so that the plant finds them.
  virtual void archive_wires(Archive& a) = 0;
  // After the plant: all else, with its events.
  virtual void archive_state(Archive& a) = 0;
};

// A UDP port for a master at this address of its own. Refusal: a sentence; another address may do.
using OpenUdp = std::function<Result<std::unique_ptr<transports::UdpPort>, std::string>(const Ipv4Endpoint& own)>;

struct MasterContext {
  rig::Plant& plant;
  std::uint64_t seed = 1;
  std::function<void(WireRecord record)> on_wire;
  OpenUdp open_udp = {};  // empty: on the plant's network in memory
};

// Masters by the name that `via:` uses.
struct MasterKind {
  std::string_view name;
  std::vector<std::string_view> words;
  std::function<Result<std::unique_ptr<Master>, std::string>(const MasterContext&)> make;
  // What is wrong with a word's value, whatever the plant: a sentence without full stop; empty: nothing. Not set: it is
  // told when the word is said.
  std::function<std::string(std::string_view word, const rig::Json& value)> objection = {};
  // Whether the drive is on a wire of the master. Not set: every drive is.
  std::function<bool(const rig::DriveUnit& drive)> reaches = {};
};

}  // namespace vinv::scenario
