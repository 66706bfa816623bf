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
  std::array<std::uint8_t, kEncapsulationHeader> bytes{};
  const auto put = [&bytes](std::size_t at, std::size_t size, std::uint32_t value) {
    for (std::size_t i = 0; i < size; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
  };
  put(0, 2, header.command);
  put(2, 2, header.length);
  put(4, 4, header.session);
  put(8, 4, header.status);
  std::copy(header.context.begin(), header.context.end(), bytes.begin() + 12);
  put(20, 4, header.options);
  out.insert(out.end(), bytes.begin(), bytes.end());
}

}  // namespace vinv::ethernet_ip
