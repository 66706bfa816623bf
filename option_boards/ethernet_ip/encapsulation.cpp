#include "option_boards/ethernet_ip/encapsulation.hpp"

#include <algorithm>

namespace vinv::ethernet_ip {

std::optional<EncapsulationHeader> parse_header(ByteView bytes) {
  if (bytes.size() < kEncapsulationHeader) return std::nullopt;
  EncapsulationHeader header;
  header.command = read_le16(bytes, 0);
  header.length = read_le16(bytes, 2);
  header.session = read_le32(bytes, 4);
  header.status = read_le32(bytes, 8);
  std::copy_n(bytes.begin() + 12, header.context.size(), header.context.begin());
  header.options = read_le32(bytes, 20);
  return header;
}

void append_header(Bytes& out, const EncapsulationHeader& header) {
  append_le16(out, header.command);
  append_le16(out, header.length);
  append_le32(out, header.session);
  append_le32(out, header.status);
  out.insert(out.end(), header.context.begin(), header.context.end());
  append_le32(out, header.options);
}

}  // namespace vinv::ethernet_ip
