// A YAML document as a plain value: a campaign takes a scenario apart, puts other values in, and writes it again.
// Aliases are resolved; flow and block style and quotes are kept, comments are not.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "sim/base/result.hpp"

namespace vinv::campaign {

struct Document {
  enum class Kind { kNull, kScalar, kList, kMap };
  Kind kind = Kind::kNull;
  std::string text;               // kScalar
  bool quoted = false;            // kScalar
  bool flow = false;              // kList, kMap
  std::vector<std::string> keys;  // kMap, as long as items
  std::vector<Document> items;

  static Document scalar(std::string value);
  bool is_map() const { return kind == Kind::kMap; }
  bool is_list() const { return kind == Kind::kList; }
  bool is_scalar() const { return kind == Kind::kScalar; }
  // Of a map; nullptr if there is none.
  Document* find(std::string_view key);
  const Document* find(std::string_view key) const { return const_cast<Document*>(this)->find(key); }
  // Of a map; added if there is none.
  Document& at(std::string_view key);
};

// The error is a sentence: too large or too deep, keys that are no words.
Result<Document, std::string> read_document(const YAML::Node& node);
// Block style at the top, a line feed at the end. Reading it again gives the same document.
std::string write_document(const Document& document);

// The value at "/plant/drives/1/load/inertia_kg_m2": keys of mappings; entries of lists by number from 1 or by their
// `name`. Mappings that are not there are made if create is set. nullptr: no such place; why is a sentence.
Document* find_place(Document& root, std::string_view path, bool create, std::string& why);

}  // namespace vinv::campaign
