#include "sim/rig/control_session.hpp"

#include <algorithm>
#include <utility>

namespace vinv::rig {
namespace {

Json error_response(const Json& id, CommandCode code, const std::string& message) {
  return {{"jsonrpc", "2.0"}, {"id", id}, {"error", {{"code", static_cast<int>(code)}, {"message", message}}}};
}

// Foreign bytes in messages must not make the answer unprintable: invalid UTF-8 is replaced.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }
std::string line_of(const Json& json) { return text_of(json) + "\n"; }

}  // namespace

void ControlSession::end_with(const std::string& message) {
  broken_ = true;
  farewell_ = line_of(error_response({}, CommandCode::kInvalidRequest, message));
}

void ControlSession::take_bytes(ByteView bytes) {
  for (const std::uint8_t byte : bytes) {
    if (broken_) return;
    if (byte != '\n') {
      pending_.push_back(static_cast<char>(byte));
      if (pending_.size() > kMaxLineBytes)
        end_with("a line is longer than " + std::to_string(kMaxLineBytes) + " bytes.");
      continue;
    }
    std::string line = std::exchange(pending_, {});
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    waiting_bytes_ += line.size();
    lines_.push_back(std::move(line));
    if (waiting_bytes_ > kMaxWaitingBytes)
      end_with("more than " + std::to_string(kMaxWaitingBytes) + " bytes of requests wait; wait for answers.");
  }
}

std::string ControlSession::execute_next() {
  if (batch_) return execute_in_batch();
  if (lines_.empty()) return std::exchange(farewell_, {});
  const std::string line = std::move(lines_.front());
  lines_.pop_front();
  waiting_bytes_ -= line.size();
  return execute_line(line);
}

std::string ControlSession::execute_line(const std::string& line) {
  // Deep nesting would recurse in the parser; no request needs more than a few levels.
  constexpr int kMaxDepth = 16;
  bool too_deep = false;
  const auto depth_limit = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kMaxDepth;
    return !too_deep;
  };
  Json request = Json::parse(line, depth_limit, false);
  if (request.is_discarded() || too_deep)
    return line_of(error_response({}, CommandCode::kParseError, "this line is not JSON."));
  if (!request.is_array()) {
    const Json answer = handle_request(request);
    return answer.is_null() ? std::string{} : line_of(answer);
  }
  if (request.empty() || request.size() > kMaxBatch)
    return line_of(error_response({}, CommandCode::kInvalidRequest,
                                  "a batch has 1 to " + std::to_string(kMaxBatch) + " requests."));
  batch_ = Batch{std::move(request), 0, {}};
  return execute_in_batch();
}

std::string ControlSession::execute_in_batch() {
  if (const Json answer = handle_request(batch_->requests[batch_->next++]); !answer.is_null())
    batch_->answers += (batch_->answers.empty() ? "" : ",") + text_of(answer);
  if (batch_->next < batch_->requests.size()) return {};
  const std::string answers = std::move(batch_->answers);
  batch_.reset();
  return answers.empty() ? std::string{} : "[" + answers + "]\n";
}

Json ControlSession::handle_request(const Json& request) {
  const auto invalid = [](const std::string& message) {
    return error_response({}, CommandCode::kInvalidRequest, message);
  };
  if (!request.is_object())
    return invalid("a request is an object {\"jsonrpc\": \"2.0\", \"id\": 1, \"method\": ...}.");
  const bool notification = !request.contains("id");
  const Json id = notification ? Json() : request["id"];
  if (!id.is_null() && !id.is_number() && !id.is_string()) return invalid("id is a number or text.");
  if (!request.contains("jsonrpc") || request["jsonrpc"] != "2.0")
    return error_response(id, CommandCode::kInvalidRequest, "jsonrpc is missing or not \"2.0\".");
  if (!request.contains("method") || !request["method"].is_string())
    return error_response(id, CommandCode::kInvalidRequest, "method is missing or no text.");

  const auto answer = [&]() -> CommandResult {
    const Json params = request.contains("params") ? request["params"] : Json::object();
    const auto bad = [](const std::string& message) {
      return Unexpected(CommandError{CommandCode::kInvalidValue, message});
    };
    if (!params.is_object()) return bad("params is an object {\"drive\": NAME, \"value\": VALUE}.");
    for (const auto& [key, value] : params.items())
      if (key != "drive" && key != "value" && key != "words")
        return bad("unknown word \"" + key + "\" in params; allowed: drive, value, words.");
    std::string drive;
    if (params.contains("drive")) {
      if (!params["drive"].is_string()) return bad("drive is the name of a drive.");
      drive = params["drive"].get<std::string>();
    }
    const std::string method = request["method"].get<std::string>();
    if (!params.contains("words"))
      return execute(plant_, method, drive, params.contains("value") ? params["value"] : Json());
    const Json& words = params["words"];
    if (params.contains("value") || !words.is_array() ||
        !std::all_of(words.begin(), words.end(), [](const Json& w) { return w.is_string(); }))
      return bad("words is a list of texts, in place of value.");
    return execute_words(plant_, method, drive, words.get<std::vector<std::string>>());
  }();
  if (notification) return {};
  if (!answer) return error_response(id, answer.error().code, answer.error().message);
  return {{"jsonrpc", "2.0"}, {"id", id}, {"result", *answer}};
}

void ControlServer::accept(Instant, std::unique_ptr<transports::ByteStream> stream) {
  if (connections_.size() >= kMaxConnections) {
    stream->close();
    return;
  }
  connections_.push_back(std::make_unique<Connection>(std::move(stream), plant_));
  Connection& c = *connections_.back();
  c.stream->set_handlers(
      [this, &c](Instant at, ByteView bytes, bool) {
        if (c.closed) return;
        c.session.take_bytes(bytes);
        if (c.next_request == 0) work(at, c);
      },
      [this, &c](Instant, const std::string&) { retire(c); });
}

void ControlServer::work(Instant now, Connection& c) {
  if (const std::string answers = c.session.execute_next(); !answers.empty())
    c.stream->send(now, ByteView(reinterpret_cast<const std::uint8_t*>(answers.data()), answers.size()));
  if (c.closed) return;
  if (c.session.has_work()) {
    // Whatever is due by then, a tick above all, comes first.
    c.next_request = plant_.scheduler().schedule(plant_.now(), kernel::Priority::kObserver, [this, &c](Instant at) {
      c.next_request = 0;
      work(at, c);
    });
  } else if (c.session.broken()) {
    c.stream->close();
    retire(c);
  }
}

ControlServer::~ControlServer() {
  for (const auto& c : connections_)
    if (c->next_request != 0) plant_.scheduler().cancel(c->next_request);
}

void ControlServer::retire(Connection& c) {
  if (c.closed) return;
  c.closed = true;
  if (c.next_request != 0) plant_.scheduler().cancel(std::exchange(c.next_request, 0));
  // Not here: the call may come out of the stream itself.
  auto& scheduler = plant_.scheduler();
  scheduler.schedule(scheduler.now(), kernel::Priority::kObserver, [this](Instant) {
    std::erase_if(connections_, [](const auto& connection) { return connection->closed; });
  });
}

}  // namespace vinv::rig
