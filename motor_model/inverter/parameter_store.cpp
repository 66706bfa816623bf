#include "motor_model/inverter/parameter_store.hpp"

#include <cmath>

#include "sim/base/check.hpp"

namespace vinv::inverter {
namespace {

constexpr double kScale[] = {1.0, 10.0, 100.0, 1000.0};

}  // namespace

ParameterStore::ParameterStore(const ParameterTable& table, const ModelRow& model)
    : table_(&table), factory_(table.defaults(model)), ram_(factory_), eeprom_(factory_), physical_(ram_.size()) {
  for (std::size_t row = 0; row < ram_.size(); ++row) physical_[row] = physical(row, ram_[row]);
}

// One row may change the increment of others.
void ParameterStore::ram_changed() {
  ++revision_;
  for (std::size_t row = 0; row < ram_.size(); ++row) physical_[row] = physical(row, ram_[row]);
}

int ParameterStore::decimals_in(std::size_t row, const std::vector<std::int32_t>& image) const {
  const ParameterRow& r = table_->rows()[row];
  if (!r.fine) return r.decimals;
  const auto switching = table_->index(port::ParameterId{r.fine->number, 0});
  return switching && image[*switching] == r.fine->value ? r.fine->decimals : r.decimals;
}

double ParameterStore::physical(std::size_t row, std::int32_t raw) const {
  const ParameterRow& r = table_->rows()[row];
  if (r.has_9999 && raw == kRaw9999) return 9999;
  if (r.has_8888 && raw == kRaw8888) return 8888;
  return static_cast<double>(raw) / kScale[decimals(row)];
}

double ParameterStore::value(unsigned number, unsigned sub) const {
  const auto row = table_->index(port::ParameterId{static_cast<std::uint16_t>(number), static_cast<std::uint8_t>(sub)});
  return row ? physical_[*row] : 0;
}

bool ParameterStore::is_9999(unsigned number) const {
  const auto row = table_->index(port::ParameterId{static_cast<std::uint16_t>(number), 0});
  return row && table_->rows()[*row].has_9999 && ram_[*row] == kRaw9999;
}

std::string ParameterStore::text(std::size_t row, std::int32_t raw) const {
  const ParameterRow& r = table_->rows()[row];
  if (r.has_9999 && raw == kRaw9999) return "9999";
  if (r.has_8888 && raw == kRaw8888) return "8888";
  return raw_to_text(raw, decimals(row));
}

std::string ParameterStore::allowed_text(std::size_t row) const {
  const ParameterRow& r = table_->rows()[row];
  if (r.kind == ParameterKind::kManufacturer) return "nothing, it is a manufacturer setting";
  const std::string unit = r.unit == "-" ? "" : " " + r.unit;
  std::string text;
  if (!r.allowed_text.empty()) {
    text = r.allowed_text + unit;
  } else if (r.raw_minimum == r.raw_maximum) {
    text = raw_to_text(r.raw_minimum, decimals(row)) + unit;
  } else {
    text = raw_to_text(r.raw_minimum, decimals(row)) + " to " + raw_to_text(r.raw_maximum, decimals(row)) + unit;
  }
  if (decimals(row) > 0) text += " in steps of " + raw_to_text(1, decimals(row));
  if (r.has_8888) text += ", 8888";
  if (r.has_9999) text += ", 9999";
  return text;
}

Result<std::int32_t, std::string> ParameterStore::from_physical(std::size_t row, double value) const {
  const ParameterRow& r = table_->rows()[row];
  const auto refuse = [&] { return Unexpected(r.label + " (" + r.name + ") takes " + allowed_text(row)); };
  if (r.kind == ParameterKind::kManufacturer || !std::isfinite(value)) return refuse();
  if (r.has_9999 && value == 9999) return kRaw9999;
  if (r.has_8888 && value == 8888) return kRaw8888;
  const double scaled = value * kScale[decimals(row)];
  if (!(scaled > -1 && scaled < 1e9)) return refuse();
  const auto raw = std::llround(scaled);
  if (std::abs(scaled - static_cast<double>(raw)) > 1e-6 * std::max(1.0, std::abs(scaled))) return refuse();
  // A number that only looks like one of the words for 8888 and 9999 is not meant as such.
  if (raw > r.raw_maximum || !r.accepts(raw)) return refuse();
  return static_cast<std::int32_t>(raw);
}

void ParameterStore::write(std::size_t row, std::int32_t raw, Storage storage) {
  VINV_CHECK(row < ram_.size() && table_->rows()[row].accepts(raw));
  ram_[row] = raw;
  if (storage == Storage::kRamAndEeprom) eeprom_[row] = raw;
  ram_changed();
}

void ParameterStore::set_factory(std::size_t row, std::int32_t raw) {
  write(row, raw, Storage::kRamAndEeprom);
  factory_[row] = raw;
}

void ParameterStore::clear(ClearKind kind, bool communication_too) {
  for (std::size_t i = 0; i < ram_.size(); ++i) {
    const ClearRule rule = table_->rows()[i].clear;
    if (rule == ClearRule::kNever || (rule == ClearRule::kAllClearOnly && kind == ClearKind::kParameterClear)) continue;
    if (table_->rows()[i].communication && !communication_too) continue;
    ram_[i] = eeprom_[i] = factory_[i];
  }
  ram_changed();
}

void ParameterStore::clear_to_factory() {
  ram_ = eeprom_ = factory_;
  ram_changed();
}

void ParameterStore::load_ram_from_eeprom() {
  ram_ = eeprom_;
  ram_changed();
}

void ParameterStore::set_eeprom(const std::vector<std::int32_t>& image) {
  VINV_CHECK(image.size() == eeprom_.size());
  eeprom_ = image;
}

void archive(Archive& a, ParameterStore& store) {
  // The physical values are made from the image.
  VINV_MEMBERS(store, table, factory, ram, eeprom, values, revision);
  const std::vector<std::int32_t> own = a.loads() ? factory : std::vector<std::int32_t>{};
  VINV_FIELDS(a, ParameterStore, factory, ram, eeprom, revision);
  if (!a.loads()) return;
  for (const auto* image : {&factory, &ram, &eeprom}) {
    a.require(image->size() == table->rows().size(), "it has another number of parameters");
    for (std::size_t i = 0; i < own.size() && !a.failed(); ++i) {
      const std::int32_t raw = (*image)[i];
      // Rows that hold no value accept none and keep what the factory gives them.
      a.require(raw == own[i] || table->rows()[i].accepts(raw), "a parameter has a value that it does not take");
    }
  }
  if (a.failed()) {
    factory = own;  // by which what is put back is judged
    return;
  }
  for (std::size_t row = 0; row < ram.size(); ++row) values[row] = store.physical(row, ram[row]);
}

}  // namespace vinv::inverter
