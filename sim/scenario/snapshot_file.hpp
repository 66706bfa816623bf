// A saved run as a file: a few lines for people, then the snapshot's bytes.
//
//   vinverter snapshot
//   build: 0.1.0 (4f2a91c)
//   scenario: scenarios/fr-e500/master_modbus.yaml
//   at: 4.3 s
//
//   ...
#pragma once

#include <string>

#include "sim/base/bytes.hpp"
#include "sim/base/result.hpp"
#include "sim/base/time.hpp"

namespace vinv::scenario {

struct SnapshotFile {
  std::string build;     // of the program: snapshots serve the build that wrote them
  std::string scenario;  // path, for people
  Duration at{};         // time of the scenario, for people
  Bytes bytes;
};

// All of it or nothing: a file that is there stays as it is if this fails. The error is a sentence.
Result<void, std::string> write_snapshot_file(const std::string& path, const SnapshotFile& file);
// Refuses a file of another build, and one that is damaged as far as that is seen without a plant.
Result<SnapshotFile, std::string> read_snapshot_file(const std::string& path, const std::string& build);

}  // namespace vinv::scenario
