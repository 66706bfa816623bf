#include "option_boards/cip/message.hpp"

#include <array>

namespace vinv::cip {

ParsedRequest parse_request(ByteView message) {
  if (message.empty()) return {0, Unexpected(GeneralStatus::kNotEnoughData)};
  const auto service = static_cast<std::uint8_t>(message[0] & ~kReplyBit);
  if ((message[0] & kReplyBit) != 0) return {service, Unexpected(GeneralStatus::kServiceNotSupported)};
  if (message.size() < 2) return {service, Unexpected(GeneralStatus::kNotEnoughData)};
  const std::size_t path_bytes = 2 * std::size_t{message[1]};
  message = message.subspan(2);
  if (path_bytes > message.size()) return {service, Unexpected(GeneralStatus::kPathSizeInvalid)};
  const auto path = parse_object_path(message.first(path_bytes), PathForm::kPadded);
  if (!path) return {service, Unexpected(path.error())};
  ParsedRequest parsed{service, Request{}};
  parsed.request->service = service;
  parsed.request->path = *path;
  parsed.request->data = message.subspan(path_bytes);
  return parsed;
}

void append_request(Bytes& out, const Request& request) {
  out.push_back(request.service);
  const std::size_t size_at = out.size();
  out.push_back(0);
  append_object_path(out, request.path, PathForm::kPadded);
  out[size_at] = static_cast<std::uint8_t>((out.size() - size_at - 1) / 2);
  out.insert(out.end(), request.data.begin(), request.data.end());
}

void append_reply(Bytes& out, std::uint8_t service, const Reply& reply) {
  const std::array<std::uint8_t, 4> header{static_cast<std::uint8_t>(service | kReplyBit), 0,
                                           static_cast<std::uint8_t>(reply.status.general),
                                           reply.status.extended_count};
  out.insert(out.end(), header.begin(), header.end());
  for (std::size_t i = 0; i < reply.status.extended_count; ++i) append_le16(out, reply.status.extended[i]);
  out.insert(out.end(), reply.data.begin(), reply.data.end());
}

std::optional<ReplyView> parse_reply(ByteView message) {
  constexpr std::size_t kHeader = 4;
  if (message.size() < kHeader || (message[0] & kReplyBit) == 0) return std::nullopt;
  ReplyView reply;
  reply.service = static_cast<std::uint8_t>(message[0] & ~kReplyBit);
  reply.status.general = static_cast<GeneralStatus>(message[2]);
  reply.status.extended_count = message[3];
  message = message.subspan(kHeader);
  const std::size_t count = reply.status.extended_count;
  if (count > Status::kMaxExtended || message.size() < 2 * count) return std::nullopt;
  for (std::size_t i = 0; i < count; ++i) reply.status.extended[i] = read_le16(message, 2 * i);
  reply.data = message.subspan(2 * count);
  return reply;
}

Result<Request, GeneralStatus> request_without_path(std::uint8_t service, std::uint16_t class_id,
                                                    std::uint16_t instance, ByteView data) {
  Request request;
  request.service = service;
  request.path.class_id = class_id;
  request.path.instance = instance;
  if (request.is(Service::kGetAttributeSingle) || request.is(Service::kSetAttributeSingle)) {
    if (data.empty()) return Unexpected(GeneralStatus::kNotEnoughData);
    request.path.attribute = data[0];
    data = data.subspan(1);
  }
  request.data = data;
  return request;
}

}  // namespace vinv::cip
