// An adapter of Lawicel's kind (CAN232, CANUSB) on the far end of a stream: the client opens its channel and is then a
// node on the bus. Also in virtual time.
//
// Answers are CR, or text and CR, or BEL for what is wrong or not possible now; a frame that was taken is answered z or
// Z. Commands: Sn sXXYY (bit rate), O, L (listen only), C, t T r R, F (status flags), V v N, Zn (time stamps), X1, and
// M and m with the values that let everything pass. Until a bit rate is set the channel has that of the bus; with
// another rate the client is a node that disturbs, as in life. Unspecified: an empty line is answered CR; slcand sends
// such lines to get into step.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim/transports/byte_stream.hpp"
#include "sim/transports/can/can_bus.hpp"
#include "sim/transports/can/slcan_text.hpp"

namespace vinv::transports {

class SlcanAdapter {
 public:
  static constexpr std::size_t kMaxQueuedFrames = 512;  // of the client, waiting for the bus; beyond it BEL

  // The bus outlives the adapter. on_end is called once, when the stream has ended, and may destroy the adapter.
  SlcanAdapter(CanBus& bus, std::unique_ptr<ByteStream> stream, std::function<void()> on_end);
  ~SlcanAdapter();
  SlcanAdapter(const SlcanAdapter&) = delete;
  SlcanAdapter& operator=(const SlcanAdapter&) = delete;

  bool is_open() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace vinv::transports
