#include "sim/transports/parity_marks.hpp"

namespace vinv::transports {

bool ParityMarks::decode(ByteView marked, Bytes& out) {
  bool wrong = false;
  for (const std::uint8_t byte : marked) {
    switch (state_) {
      case State::kPlain:
        if (byte == 0xff) {
          state_ = State::kAfterFf;
        } else {
          out.push_back(byte);
        }
        break;
      case State::kAfterFf:
        if (byte == 0x00) {
          state_ = State::kAfterFf00;
          break;
        }
        // Anything but FF here is against the document: keep what came, and say that it is not to be trusted.
        if (byte != 0xff) {
          wrong = true;
          out.push_back(0xff);
        }
        out.push_back(byte);
        state_ = State::kPlain;
        break;
      case State::kAfterFf00:
        wrong = true;
        out.push_back(byte);
        state_ = State::kPlain;
        break;
    }
  }
  return wrong;
}

}  // namespace vinv::transports
