#include "sim/transports/memory_link.hpp"

#include "sim/transports/memory_end.hpp"

namespace vinv::transports {

MemoryLink make_memory_link(kernel::Scheduler& scheduler, const MemoryLinkOptions& options) {
  const auto shared = std::make_shared<const MemoryLinkOptions>(options);
  const auto a = std::make_shared<MemoryEnd>(scheduler, 0);
  const auto b = std::make_shared<MemoryEnd>(scheduler, 0);
  return {std::make_unique<MemoryStream>(a, b, shared, options.name_a),
          std::make_unique<MemoryStream>(b, a, shared, options.name_b)};
}

}  // namespace vinv::transports
