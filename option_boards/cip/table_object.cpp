#include "option_boards/cip/table_object.hpp"

namespace vinv::cip {

Handled TableObject::handle(Instant now, const Request& request, Reply& reply) {
  const ObjectPath& path = request.path;
  if (!table_.has_instance(path.class_id, path.instance)) {
    reply.refuse(GeneralStatus::kObjectDoesNotExist);
    return Handled::kAnswered;
  }
  const ServiceRow* const service = table_.find_service(path.class_id, path.instance, request.service);
  if (service == nullptr) {
    reply.refuse(GeneralStatus::kServiceNotSupported);
    return Handled::kAnswered;
  }
  switch (service->binding) {
    case kServeGetSingle: get_single(request, reply); return Handled::kAnswered;
    case kServeGetAll: get_all(request, reply); return Handled::kAnswered;
    case kServeSetSingle: return set_single(now, request, reply);
    default: return serve(now, static_cast<std::uint8_t>(service->binding - kFirstOwnService), request, reply);
  }
}

GeneralStatus TableObject::append_value(const Attribute& attribute, Bytes& out) const {
  const AttributeRow& row = attribute.row;
  if (row.binding == 0) {
    out.insert(out.end(), row.value.begin(), row.value.end());
    return GeneralStatus::kSuccess;
  }
  const auto type = row.type.integer();
  if (!type) return get_bytes(attribute, out);
  const Got value = get_number(attribute);
  if (!value) return value.error();
  append_integer(out, *type, *value);
  return GeneralStatus::kSuccess;
}

void TableObject::get_single(const Request& request, Reply& reply) const {
  const ObjectPath& path = request.path;
  // Unspecified: a request without the attribute names none that is supported.
  const AttributeRow* const row = path.attribute ? table_.find(path.class_id, path.instance, *path.attribute) : nullptr;
  // Unspecified: how an attribute answers that can only be set; kAttributeNotGettable is younger than the manuals here.
  if (row == nullptr || !row->gettable) return reply.refuse(GeneralStatus::kAttributeNotSupported);
  if (path.member) return reply.refuse(GeneralStatus::kInvalidMemberId);
  if (!request.data.empty()) return reply.refuse(GeneralStatus::kTooMuchData);
  if (const auto status = append_value({*row, *path.attribute}, reply.data); status != GeneralStatus::kSuccess) {
    reply.refuse(status);
  }
}

// CIP Vol 1, 4-9: the values in order of their numbers, without numbers.
void TableObject::get_all(const Request& request, Reply& reply) const {
  if (!request.data.empty()) return reply.refuse(GeneralStatus::kTooMuchData);
  for (const AttributeRow& row : table_.instance(request.path.class_id, request.path.instance)) {
    for (unsigned number = row.first; row.gettable && number <= row.last; ++number) {
      const auto status = append_value({row, static_cast<std::uint16_t>(number)}, reply.data);
      if (status != GeneralStatus::kSuccess) return reply.refuse(status);
    }
  }
}

Handled TableObject::set_single(Instant now, const Request& request, Reply& reply) {
  const ObjectPath& path = request.path;
  const auto refuse = [&](Status why) {
    reply.refuse(why);
    return Handled::kAnswered;
  };
  const AttributeRow* const row = path.attribute ? table_.find(path.class_id, path.instance, *path.attribute) : nullptr;
  if (row == nullptr) return refuse(GeneralStatus::kAttributeNotSupported);
  if (!row->settable) return refuse(GeneralStatus::kAttributeNotSettable);
  if (path.member) return refuse(GeneralStatus::kMemberNotSettable);
  if (const auto fit = row->type.check(request.data); fit != GeneralStatus::kSuccess) return refuse(fit);
  SetRequest set_request{now, {*row, *path.attribute}, 0, request.data, request.ticket};
  if (const auto type = row->type.integer()) {
    set_request.number = read_integer(*type, request.data);
    if (set_request.number < row->min || set_request.number > row->max) {
      return refuse(GeneralStatus::kInvalidAttributeValue);
    }
  }
  const SetResult result = set(set_request);
  return result ? *result : refuse(result.error());
}

}  // namespace vinv::cip
