#include "sim/campaign/document.hpp"

#include <algorithm>
#include <charconv>

#include "sim/rig/words.hpp"

namespace vinv::campaign {
namespace {

// Aliases of YAML can make a small text a huge tree.
constexpr std::size_t kMaxNodes = 1'000'000;
constexpr int kMaxDepth = 64;

struct Mistake {
  std::string text;
};

Document read(const YAML::Node& node, std::size_t& left, int depth) {
  if (left == 0 || depth > kMaxDepth) throw Mistake{"it is nested too deep, or its aliases make it too large."};
  --left;
  Document out;
  switch (node.Type()) {
    case YAML::NodeType::Scalar:
      out.kind = Document::Kind::kScalar;
      out.text = node.Scalar();
      out.quoted = node.Tag() == "!";
      break;
    case YAML::NodeType::Sequence:
      out.kind = Document::Kind::kList;
      out.flow = node.Style() == YAML::EmitterStyle::Flow;
      for (const auto& item : node) out.items.push_back(read(item, left, depth + 1));
      break;
    case YAML::NodeType::Map:
      out.kind = Document::Kind::kMap;
      out.flow = node.Style() == YAML::EmitterStyle::Flow;
      for (const auto& pair : node) {
        if (!pair.first.IsScalar()) throw Mistake{"a key is no word."};
        out.keys.push_back(pair.first.Scalar());
        out.items.push_back(read(pair.second, left, depth + 1));
      }
      break;
    default: break;
  }
  return out;
}

void write(YAML::Emitter& out, const Document& d, bool in_flow) {
  switch (d.kind) {
    case Document::Kind::kNull: out << YAML::Null; break;
    case Document::Kind::kScalar:
      if (d.quoted) out << YAML::DoubleQuoted;
      out << d.text;
      break;
    case Document::Kind::kList:
      out << (d.flow || in_flow ? YAML::Flow : YAML::Block) << YAML::BeginSeq;
      for (const Document& item : d.items) write(out, item, d.flow || in_flow);
      out << YAML::EndSeq;
      break;
    case Document::Kind::kMap:
      out << (d.flow || in_flow ? YAML::Flow : YAML::Block) << YAML::BeginMap;
      for (std::size_t i = 0; i < d.items.size(); ++i) {
        out << YAML::Key << d.keys[i] << YAML::Value;
        write(out, d.items[i], d.flow || in_flow);
      }
      out << YAML::EndMap;
      break;
  }
}

Document* entry_of(Document& list, std::string_view word, std::string& why) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc{} && end == word.data() + word.size()) {
    if (number >= 1 && number <= list.items.size()) return &list.items[number - 1];
    why = "there is no entry " + std::string(word) + "; allowed: 1 to " + std::to_string(list.items.size()) + ".";
    return nullptr;
  }
  std::vector<std::string_view> names;
  for (Document& item : list.items) {
    const Document* name = item.is_map() ? item.find("name") : nullptr;
    if (name == nullptr || !name->is_scalar()) continue;
    if (name->text == word) return &item;
    names.push_back(name->text);
  }
  why = "there is no entry \"" + std::string(word) + "\"; allowed: a number from 1 to " +
        std::to_string(list.items.size()) +
        (names.empty() ? "." : ", or one of these names; " + rig::allowed_words(word, names));
  return nullptr;
}

}  // namespace

Document Document::scalar(std::string value) {
  Document out;
  out.kind = Kind::kScalar;
  out.text = std::move(value);
  return out;
}

Document* Document::find(std::string_view key) {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i] == key) return &items[i];
  return nullptr;
}

Document& Document::at(std::string_view key) {
  if (Document* found = find(key)) return *found;
  kind = Kind::kMap;
  keys.emplace_back(key);
  return items.emplace_back();
}

Result<Document, std::string> read_document(const YAML::Node& node) {
  std::size_t left = kMaxNodes;
  try {
    return read(node, left, 0);
  } catch (const Mistake& m) {
    return Unexpected(m.text);
  }
}

std::string write_document(const Document& document) {
  YAML::Emitter out;
  write(out, document, false);
  return std::string(out.c_str()) + "\n";
}

Document* find_place(Document& root, std::string_view path, bool create, std::string& why) {
  Document* at = &root;
  for (std::string_view rest = path; !rest.empty();) {
    rest.remove_prefix(1);  // the slash
    const std::string_view word = rest.substr(0, rest.find('/'));
    rest.remove_prefix(word.size());
    if (at->is_list()) {
      at = entry_of(*at, word, why);
      if (at == nullptr) return nullptr;
    } else if (at->is_map() || at->kind == Document::Kind::kNull) {
      Document* next = at->find(word);
      if (next == nullptr && !create) {
        const std::vector<std::string_view> known(at->keys.begin(), at->keys.end());
        why = "there is no \"" + std::string(word) + "\"; " + rig::allowed_words(word, known);
        return nullptr;
      }
      at = next != nullptr ? next : &at->at(word);
    } else {
      why = "\"" + std::string(word) + "\" lies below the value \"" + at->text + "\".";
      return nullptr;
    }
  }
  return at;
}

}  // namespace vinv::campaign
