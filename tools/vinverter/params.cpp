// vinverter params: the parameters of a family as a table.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/rig/catalogue.hpp"
#include "sim/rig/commands.hpp"
#include "sim/rig/words.hpp"
#include "tools/vinverter/subcommands.hpp"

namespace vinv::tools {
namespace {

struct ParamsOptions {
  std::string family;
  std::string model;
  std::string filter;
  bool csv = false;
  bool json = false;
};

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return std::tolower(c); });
  return s;
}

std::string name_of(const inverter::ParameterInfo& p) {
  return fmt::format("Pr.{}{}", p.id.number, p.id.sub == 0 ? "" : fmt::format(".{}", p.id.sub));
}

std::string range_of(const inverter::ParameterInfo& p) {
  std::string out = p.allowed.empty() ? fmt::format("{:g}-{:g}", p.minimum, p.maximum) : std::string(p.allowed);
  if (!p.special.empty()) out += " " + std::string(p.special);
  return out;
}

// RFC 4180: quotes around what needs them.
std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

// Pr.902 means both halves, Pr.902.1 and Pr.902.2.
bool is_named(const std::string& name, const std::string& wanted) {
  return lower(name) == lower(wanted) || lower(name).starts_with(lower(wanted) + ".");
}

// "Pr.7" and "7" mean the parameter; anything else is looked for in all texts.
bool matches(const inverter::ParameterInfo& p, const std::string& filter) {
  if (filter.empty()) return true;
  const std::string name = name_of(p);
  if (std::all_of(filter.begin(), filter.end(), [](unsigned char c) { return std::isdigit(c) || c == '.'; }))
    return is_named(name, "pr." + filter);
  if (lower(filter).starts_with("pr.")) return is_named(name, filter);
  return lower(fmt::format("{} {} {}", p.name, p.effect, p.source)).find(lower(filter)) != std::string::npos;
}

std::vector<inverter::ParameterInfo> parameters_of(const ParamsOptions& options,
                                                   std::unique_ptr<inverter::Inverter>& owner) {
  const auto families = inverter::families();
  if (std::find(families.begin(), families.end(), options.family) == families.end())
    throw std::runtime_error("there is no family \"" + options.family + "\"; " +
                             rig::allowed_words(options.family, families));
  const auto models = inverter::models(options.family);
  inverter::InverterConfig config;
  config.model = options.model.empty() ? std::string(models.front()) : options.model;
  if (std::find(models.begin(), models.end(), config.model) == models.end())
    throw std::runtime_error("there is no model \"" + config.model + "\"; " + rig::allowed_words(config.model, models));
  config.motor = rig::default_motor(config.model);
  config.load = rig::default_load(config.motor);
  auto made = inverter::make_inverter(options.family, config);
  if (!made) throw std::runtime_error(made.error());
  owner = std::move(made).value();
  return owner->parameters();
}

int params(const ParamsOptions& options) {
  std::unique_ptr<inverter::Inverter> owner;  // of the texts
  auto list = parameters_of(options, owner);
  std::erase_if(list, [&](const auto& p) { return !matches(p, options.filter); });
  if (list.empty()) {
    fmt::print(stderr, "vinverter: no parameter of {} has \"{}\" as its number or in its texts.\n", options.family,
               options.filter);
    return kRefused;
  }
  if (options.json) {
    rig::Json out = rig::Json::array();
    for (const auto& p : list)
      out.push_back({{"parameter", name_of(p)},
                     {"name", p.name},
                     {"minimum", p.minimum},
                     {"maximum", p.maximum},
                     {"increment", p.increment},
                     {"unit", p.unit},
                     {"special", p.special},
                     {"allowed", p.allowed},
                     {"default", p.factory_default},
                     {"acts", p.acts},
                     {"effect", p.effect},
                     {"source", p.source},
                     {"confidence", p.confidence}});
    fmt::print("{}\n", out.dump(2));
  } else if (options.csv) {
    fmt::print("parameter,name,minimum,maximum,increment,unit,special,allowed,default,acts,effect,source,confidence\n");
    for (const auto& p : list)
      fmt::print("{},{},{:g},{:g},{:g},{},{},{},{:g},{},{},{},{}\n", name_of(p), csv_cell(p.name), p.minimum, p.maximum,
                 p.increment, csv_cell(p.unit), csv_cell(p.special), csv_cell(p.allowed), p.factory_default,
                 p.acts ? "yes" : "no", csv_cell(p.effect), csv_cell(p.source), csv_cell(p.confidence));
  } else {
    fmt::print("{:<9} {:<44} {:<22} {:>7} {:<4} {:>8}  {}\n", "parameter", "name", "range", "step", "unit", "default",
               "acts");
    for (const auto& p : list) {
      fmt::print("{:<9} {:<44} {:<22} {:>7g} {:<4} {:>8g}  {}\n", name_of(p), p.name, range_of(p), p.increment, p.unit,
                 p.factory_default, p.acts ? "yes" : "no");
      if (!options.filter.empty())
        fmt::print("{:<9} {}\n{:<9} source: {} (confidence {})\n", "", p.effect, "", p.source, p.confidence);
    }
  }
  return kDone;
}

}  // namespace

void add_params(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<ParamsOptions>();
  CLI::App* sub = app.add_subcommand("params", "Print the parameters of an inverter family");
  sub->add_option("FAMILY", options->family, "For example fr-e500")->required();
  sub->add_option("FILTER", options->filter, "A number (7 or Pr.7), or text to look for in name, effect and source");
  sub->add_option("--model", options->model, "Defaults of this model; default: the family's first");
  auto* csv = sub->add_flag("--csv", options->csv, "All columns as CSV");
  sub->add_flag("--json", options->json, "All columns as JSON")->excludes(csv);
  sub->callback([options, &exit_code] { exit_code = params(*options); });
}

}  // namespace vinv::tools
