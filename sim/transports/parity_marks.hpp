// Undoes the marks that a tty in PARMRK mode puts into its input (termios(3)): FF FF is the byte FF; FF 00 x is x,
// which came with a parity or framing error; FF 00 00 is also a break.
#pragma once

#include "sim/base/bytes.hpp"

namespace vinv::transports {

class ParityMarks {
 public:
  // Appends the bytes of the line to out. True if one of them was wrong. A mark may be cut in two between calls.
  bool decode(ByteView marked, Bytes& out);

 private:
  enum class State { kPlain, kAfterFf, kAfterFf00 } state_ = State::kPlain;
};

}  // namespace vinv::transports
