#include "sim/transports/memory_streams.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "sim/base/check.hpp"
#include "sim/transports/memory_end.hpp"

namespace vinv::transports {

static void archive(Archive& a, MemoryLinkOptions& options) {
  VINV_MEMBERS(options, delay, name_a, name_b, character);
  VINV_FIELDS(a, MemoryLinkOptions, delay, name_a, name_b, character);
  a.require(delay >= Duration{} && character >= Duration{}, "a line is faster than time");
}

void MemoryStreams::forget_unheld() {
  std::erase_if(links_, [](const Link& l) { return !l.a->held() && !l.b->held(); });
}

MemoryLink MemoryStreams::connect(const MemoryLinkOptions& options) {
  forget_unheld();
  const std::uint32_t number = next_number_++;
  Link& l = links_.emplace_back();
  l.number = number;
  l.options = std::make_shared<const MemoryLinkOptions>(options);
  l.a = std::make_shared<MemoryEnd>(scheduler_, 2 * number);
  l.b = std::make_shared<MemoryEnd>(scheduler_, 2 * number + 1);
  return {std::make_unique<MemoryStream>(l.a, l.b, l.options, options.name_a),
          std::make_unique<MemoryStream>(l.b, l.a, l.options, options.name_b)};
}

void MemoryStreams::archive_links(Archive& a) {
  // How long a link without owners stays listed is no state.
  forget_unheld();
  VINV_FIELDS(a, MemoryStreams, next_number_);
  const std::size_t count = a.count(links_.size());
  if (a.loads()) {
    for (const Link& l : links_) {
      l.a->retire();
      l.b->retire();
    }
    links_.clear();
  }
  for (std::size_t i = 0; i < count && !a.failed(); ++i) {
    Link l;
    if (!a.loads()) l = links_[i];
    MemoryLinkOptions options = a.loads() ? MemoryLinkOptions{} : *l.options;
    VINV_FIELDS(a, Link, l.number, options);
    if (a.loads()) {
      a.require(l.number > (links_.empty() ? 0 : links_.back().number) && l.number < next_number_,
                "a line in memory has a number that was not given");
      l.options = std::make_shared<const MemoryLinkOptions>(std::move(options));
      l.a = std::make_shared<MemoryEnd>(scheduler_, 2 * l.number);
      l.b = std::make_shared<MemoryEnd>(scheduler_, 2 * l.number + 1);
    }
    a.io(*l.a);
    a.io(*l.b);
    if (!a.loads()) continue;
    l.a_awaited = l.a->held();
    l.b_awaited = l.b->held();
    links_.push_back(std::move(l));
  }
}

void MemoryStreams::archive_end(Archive& a, std::unique_ptr<ByteStream>& stream) {
  std::uint32_t number = stream == nullptr ? 0 : stream->end_number();
  VINV_CHECK(a.loads() || stream == nullptr || number != 0);
  a.io(number);
  if (!a.loads() || a.failed()) return;
  stream.reset();
  if (number == 0) return;
  const auto at = std::find_if(links_.begin(), links_.end(), [&](const Link& l) { return l.number == number / 2; });
  const bool is_b = number % 2 == 1;
  const bool awaited = at != links_.end() && (is_b ? at->b_awaited : at->a_awaited);
  a.require(awaited, "a stream is of no line in memory, or of two owners");
  if (a.failed()) return;
  (is_b ? at->b_awaited : at->a_awaited) = false;
  stream = is_b ? std::make_unique<MemoryStream>(at->b, at->a, at->options, at->options->name_b)
                : std::make_unique<MemoryStream>(at->a, at->b, at->options, at->options->name_a);
}

void MemoryStreams::archive_owners(Archive& a) const {
  for (const Link& l : links_) a.require(!l.a_awaited && !l.b_awaited, "a line in memory has lost its owner");
}

}  // namespace vinv::transports
