#include "sim/campaign/campaign.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include "sim/base/check.hpp"
#include "sim/campaign/files.hpp"
#include "sim/rig/plant_file.hpp"
#include "sim/scenario/variables.hpp"

namespace vinv::campaign {
namespace {

bool is_place(const std::string& name) { return name.front() == '/'; }

void assign_variables(Document& scenario, const Assignment& values) {
  for (const auto& [name, value] : values)
    if (!is_place(name)) scenario.at("variables").at(name) = Document::scalar(value);
}

// Variables may be made of those before them.
scenario::Variables variables_of(const Document& scenario) {
  scenario::Variables out;
  if (const Document* list = scenario.find("variables"))
    for (std::size_t i = 0; i < list->items.size(); ++i)
      if (const auto value = scenario::substitute(list->items[i].text, out)) out[list->keys[i]] = *value;
  return out;
}

}  // namespace

void Campaign::number_cases() {
  ends_.clear();
  axes_.clear();
  std::uint64_t end = 0;
  for (const Block& b : blocks) {
    end += b.cases(kMaxCases).value_or(0);
    ends_.push_back(end);
    const auto add = [&](const std::string& axis) {
      if (std::find(axes_.begin(), axes_.end(), axis) == axes_.end()) axes_.push_back(axis);
    };
    for (const auto& [axis, value] : b.set) add(axis);
    for (const auto* plan : {&b.grid, &b.boundary, &b.latin_hypercube, &b.random})
      for (const Axis& a : *plan) add(a.name);
  }
  base_hash_ = hash_text(write_document(base));
  for (const Measure& m : measures)
    base_hash_ =
        hash_text(fmt::format("{}\n{}\n{}\n{}\n", m.name, static_cast<int>(m.kind), m.drive, m.signal), base_hash_);
}

Assignment Campaign::assignment(std::uint64_t number) const {
  VINV_CHECK(number >= 1 && number <= cases());
  const auto block = static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), number) - ends_.begin());
  const std::uint64_t before = block == 0 ? 0 : ends_[block - 1];
  return blocks[block].assignment(number - before - 1, mix(seed, block));
}

std::string Campaign::shown_values(std::uint64_t number) const {
  std::string out;
  for (const auto& [axis, value] : assignment(number)) out += (out.empty() ? "" : ", ") + axis + " = " + value;
  for (char& c : out)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return out;
}

const Campaign::PlantText* Campaign::plant_of(const Assignment& values) const {
  const Document* plant = base.find("plant");
  if (plant == nullptr || !plant->is_scalar()) return nullptr;
  std::string file = plant->text;
  if (file.find('$') != std::string::npos) {
    Document varied = base;
    assign_variables(varied, values);
    const auto text = scenario::substitute(file, variables_of(varied));
    if (!text) throw std::runtime_error(text.error());
    file = *text;
  }
  const auto known = plants_.find(file);
  if (known != plants_.end()) return &known->second;
  const std::string full = (std::filesystem::path(base_path).parent_path() / file).lexically_normal().string();
  const std::string text = read_file(full);
  PlantText out;
  try {
    const auto document = read_document(YAML::Load(text));
    if (!document) throw std::runtime_error(full + ": " + document.error());
    out.document = *document;
  } catch (const YAML::Exception& e) {
    throw std::runtime_error(full + ": this is not YAML: " + e.msg + ".");
  }
  // A plant file without a name is called after its file.
  if (out.document.is_map() && out.document.find("name") == nullptr) {
    std::string stem = std::filesystem::path(file).filename().string();
    stem = stem.substr(0, stem.find('.'));
    for (char& c : stem)
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-') c = '_';
    if (rig::is_plant_word(stem)) {
      out.document.keys.insert(out.document.keys.begin(), "name");
      out.document.items.insert(out.document.items.begin(), Document::scalar(stem));
    }
  }
  out.hash = hash_text(write_document(out.document));
  return &plants_.emplace(file, std::move(out)).first->second;
}

Document Campaign::scenario(std::uint64_t number) const {
  const Assignment values = assignment(number);
  Document out = base;
  assign_variables(out, values);
  if (const PlantText* plant = plant_of(values)) out.at("plant") = plant->document;
  for (const auto& [axis, value] : values) {
    if (!is_place(axis)) continue;
    std::string why;
    Document* place = find_place(out, axis, true, why);
    if (place == nullptr) throw std::runtime_error(axis + " is no place in the scenario: " + why);
    if (place->is_list() || place->is_map())
      throw std::runtime_error(axis + " is no value in the scenario, but a " +
                               (place->is_list() ? "list." : "mapping."));
    *place = Document::scalar(value);
  }
  return out;
}

std::string Campaign::text_of(const Document& scenario, const std::string& title) {
  return "# " + title + "\n" + write_document(scenario);
}

std::string Campaign::scenario_text(std::uint64_t number) const {
  return text_of(scenario(number), fmt::format("{}, case {}: {}", title, number, shown_values(number)));
}

std::string Campaign::digest(std::uint64_t number) const {
  const Assignment values = assignment(number);
  const PlantText* plant = plant_of(values);
  std::uint64_t hash = mix(base_hash_, plant == nullptr ? 0 : plant->hash);
  for (const auto& [axis, value] : values)
    hash = hash_text("\n", hash_text(value, hash_text("=", hash_text(axis, hash))));
  return fmt::format("{:016x}", hash);
}

std::string Campaign::case_name(std::uint64_t number) const { return fmt::format("{}_case_{}", name, number); }

}  // namespace vinv::campaign
