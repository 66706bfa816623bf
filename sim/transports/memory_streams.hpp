// The lines in memory of a plant (memory_link.hpp), so that a snapshot holds them: bytes under way, what waits for
// handlers, farewells, half-closed connections (docs/decisions/0005-snapshots.md).
//
// In a snapshot: the scheduler; the net; then everybody who owns a stream, with archive_end(), which on loading hands
// the stream out anew, without handlers: the owner sets them as it had them. At the end archive_owners(). The streams
// that owners had before a load are dead from the moment the net is loaded: closing or destroying them is harmless and
// tells nobody.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sim/base/archive.hpp"
#include "sim/kernel/scheduler.hpp"
#include "sim/transports/byte_stream.hpp"
#include "sim/transports/memory_link.hpp"

namespace vinv::transports {

class MemoryEnd;

class MemoryStreams {
 public:
  // The scheduler outlives the net; streams may outlive it.
  explicit MemoryStreams(kernel::Scheduler& scheduler) : scheduler_(scheduler) {}

  // As make_memory_link(), of streams that have an end_number().
  MemoryLink connect(const MemoryLinkOptions& options = {});

  friend void archive(Archive& a, MemoryStreams& net) { net.archive_links(a); }
  // stream is one of this net, perhaps with others around it that hand on end_number(), or none. Loading sets it to the
  // bare one: the owner puts around it what was around it.
  void archive_end(Archive& a, std::unique_ptr<ByteStream>& stream);
  // After all owners: a load is refused if a stream has not been asked for.
  void archive_owners(Archive& a) const;

 private:
  struct Link {
    std::uint32_t number = 0;  // its ends: 2 * number, 2 * number + 1
    std::shared_ptr<const MemoryLinkOptions> options;
    std::shared_ptr<MemoryEnd> a;
    std::shared_ptr<MemoryEnd> b;
    bool a_awaited = false;  // a load has found an owner in the snapshot who has not come yet
    bool b_awaited = false;
  };

  void archive_links(Archive& a);
  void forget_unheld();

  kernel::Scheduler& scheduler_;
  std::uint32_t next_number_ = 1;
  std::vector<Link> links_;  // in the order of their numbers
};

}  // namespace vinv::transports
