// Parameters and EEPROM of the Mitsubishi families: writes with their side effects, clears, user groups, the EEPROM
// text.
#include <cmath>

#include "motor_model/inverter/mitsubishi/inverter.hpp"
#include "motor_model/inverter/mitsubishi/parameter_numbers.hpp"

namespace vinv::inverter::mitsubishi {

using port::Refusal;

namespace {

std::string number_text(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string not_in_group(const ParameterRow& row) {
  return row.label + " is not in the user group that Pr.160 selects";
}

}  // namespace

AccessSituation MitsubishiInverter::access(Writer writer) const {
  AccessSituation s;
  s.writer = writer;
  s.mode = v_.mode;
  s.disable = static_cast<WriteDisable>(store_.integer(pr::kWriteDisable));
  s.running = running() || v_.tuning.running();
  return s;
}

std::int32_t MitsubishiInverter::shown_raw(std::size_t row) const {
  const ParameterRow& r = data_.parameters.rows()[row];
  switch (r.kind) {
    case ParameterKind::kManufacturer: return 0;
    case ParameterKind::kCommand: return command_value(r.id.number);
    case ParameterKind::kOrdinary: break;
  }
  if (r.id.number == v_.tuned_setting && v_.tuning_status != TuningStatus::kOff) {
    return static_cast<std::int32_t>(v_.tuning_status);
  }
  return store_.raw(row);
}

void MitsubishiInverter::eeprom_written() {
  eeprom_changed_ = true;
  if (!causes_.eeprom_write || !control_alive_) return;
  ++v_.storage_failures;
  raise("E.PE", "a write to the parameter storage failed");
}

std::optional<Refusal> MitsubishiInverter::group_command(std::size_t group, bool add, std::int32_t raw) {
  UserGroup& g = record_.groups[group];
  if (!add && raw == kRaw9999) {
    g.clear();
    return std::nullopt;
  }
  if (!data_.parameters.has_number(static_cast<std::uint32_t>(raw))) return Refusal::kOutOfRange;
  const auto n = static_cast<std::uint16_t>(raw);
  if (!add) {
    g.remove(n);
    return std::nullopt;
  }
  return g.add(n) ? std::nullopt : std::optional(Refusal::kOutOfRange);
}

void MitsubishiInverter::copy_parameter(port::ParameterId from, port::ParameterId to, Storage storage) {
  store_.write(*data_.parameters.index(to), store_.raw(*data_.parameters.index(from)), storage);
}

std::optional<Refusal> MitsubishiInverter::write_parameter(std::size_t row, std::int32_t raw, Storage storage) {
  const ParameterRow& r = data_.parameters.rows()[row];
  const unsigned number = r.id.number;
  if (r.kind == ParameterKind::kCommand) {
    if (const auto refusal = command_parameter(number, raw)) return refusal;
    eeprom_written();
    return std::nullopt;
  }
  if (r.ram_only) storage = Storage::kRamOnly;
  // With a storage that cannot be written the value acts until the next power-off.
  if (causes_.eeprom_write && control_alive_ && storage == Storage::kRamAndEeprom) {
    store_.write(row, raw, Storage::kRamOnly);
    link_parameters(number, Storage::kRamOnly);
    ++v_.storage_failures;
    raise("E.PE", "writing " + r.label + " to the parameter storage failed");
  } else {
    store_.write(row, raw, storage);
    link_parameters(number, storage);
    if (storage == Storage::kRamAndEeprom) eeprom_written();
  }
  if (number == v_.tuned_setting) v_.tuning_status = TuningStatus::kOff;
  return std::nullopt;
}

void MitsubishiInverter::clear_parameters(ClearKind kind, bool communication_too) {
  store_.clear(kind, communication_too);
  cleared(kind);
  record_.groups = {};
  v_.tuning_status = TuningStatus::kOff;
  eeprom_written();
}

MitsubishiInverter::TuningNumbers MitsubishiInverter::tuning_numbers() const {
  return {pr::kAutoTuning, pr::kMotorCapacity, pr::kMotorR1};
}

void MitsubishiInverter::store_tuned_resistance(double ohm) {
  const auto row = data_.parameters.index(port::ParameterId{static_cast<std::uint16_t>(tuning_numbers().r1), 0});
  const auto raw = static_cast<std::int32_t>(std::lround(ohm * 1000));
  const ParameterRow& r = data_.parameters.rows()[*row];
  write_parameter(*row, std::min(raw, r.raw_maximum), Storage::kRamAndEeprom);
}

// The setting goes back to 0, so that the next start runs the motor; its status is read until it is written again.
void MitsubishiInverter::finish_tuning() {
  const TuningStatus status = v_.tuning_status;
  write_parameter(*data_.parameters.index(port::ParameterId{static_cast<std::uint16_t>(v_.tuned_setting), 0}), 0,
                  Storage::kRamAndEeprom);
  v_.tuning_status = status;
}

Outcome MitsubishiInverter::write_from_panel(std::size_t row, double value) {
  const ParameterRow& r = data_.parameters.rows()[row];
  AccessSituation situation = access(Writer::kPanel);
  situation.in_user_group = in_user_group(r.id.number);
  if (!situation.in_user_group) return Unexpected(not_in_group(r));
  if (const auto refusal = write_refusal(r, situation)) {
    switch (*refusal) {
      case Refusal::kReadOnly: return Unexpected(r.label + " cannot be written");
      case Refusal::kWrongMode:
        return Unexpected(r.label + " is written from the panel in PU operation (or with Pr.77 = 2); " +
                          mode_sentence());
      case Refusal::kWriteDisabled: return Unexpected(r.label + " is locked by Pr.77 = 1");
      default: return Unexpected(r.label + " cannot be written while the inverter runs");
    }
  }
  if (locked(Writer::kPanel, r.id.number, true))
    return Unexpected(r.label + " is locked by a password (Pr.296, Pr.297)");
  const auto raw = store_.from_physical(row, value);
  if (!raw) return Unexpected(raw.error());
  if (auto why = not_fitted(r.id.number, *raw)) return Unexpected(*std::move(why));
  if (write_parameter(row, *raw, Storage::kRamAndEeprom)) {
    return Unexpected(r.label + " takes the number of a parameter; a user group has room for " +
                      std::to_string(UserGroup::kCapacity));
  }
  return {};
}

Outcome MitsubishiInverter::set_parameter(std::string_view name, double value) {
  if (!ready()) return Unexpected(std::string("the inverter has no supply or is in start-up or reset"));
  if (causes_.pu_disconnected) return Unexpected(std::string("the operation panel is disconnected"));
  const bool clear = name == "Pr.CL";
  const bool all_clear = name == "ALLC";
  const bool alarm_clear = name == "Er.CL";
  if (clear || all_clear || alarm_clear) {
    if (value != 1) return Unexpected(std::string(name) + " takes 1");
    if (alarm_clear) {
      record_.alarms = {};
      eeprom_written();
      return {};
    }
    if (const auto refusal = clear_refusal(access(Writer::kPanel))) {
      if (*refusal == Refusal::kWrongMode)
        return Unexpected(std::string(name) + " needs PU operation; " + mode_sentence());
      if (*refusal == Refusal::kRunning) return Unexpected(std::string(name) + " needs a stopped inverter");
      return Unexpected(std::string(name) + " is locked by Pr.77 = 1");
    }
    clear_parameters(all_clear ? ClearKind::kAllClear : ClearKind::kParameterClear);
    return {};
  }
  const auto row = data_.parameters.index(name);
  if (!row) return Unexpected("there is no parameter " + std::string(name) + " (write Pr.7, or Pr.902.1)");
  return write_from_panel(*row, value);
}

Result<double, std::string> MitsubishiInverter::get_parameter(std::string_view name) const {
  const auto row = data_.parameters.index(name);
  if (!row) return Unexpected("there is no parameter " + std::string(name) + " (write Pr.7, or Pr.902.1)");
  const ParameterRow& r = data_.parameters.rows()[*row];
  if (!in_user_group(r.id.number)) return Unexpected(not_in_group(r));
  if (locked(Writer::kPanel, r.id.number, false))
    return Unexpected(r.label + " is locked by a password (Pr.296, Pr.297)");
  return store_.physical(*row, shown_raw(*row));
}

Outcome MitsubishiInverter::preset_parameter(std::string_view name, double value) {
  const auto row = data_.parameters.index(name);
  if (!row) return Unexpected("there is no parameter " + std::string(name) + " (write Pr.7, or Pr.902.1)");
  const ParameterRow& r = data_.parameters.rows()[*row];
  if (r.kind == ParameterKind::kManufacturer) return Unexpected(r.label + " cannot be written");
  const auto raw = store_.from_physical(*row, value);
  if (!raw) return Unexpected(raw.error());
  if (auto why = not_fitted(r.id.number, *raw)) return Unexpected(*std::move(why));
  if (write_parameter(*row, *raw, Storage::kRamAndEeprom)) {
    return Unexpected(r.label + " takes the number of a parameter, not " + number_text(value));
  }
  return {};
}

std::vector<ParameterInfo> MitsubishiInverter::parameters() const {
  std::vector<ParameterInfo> out;
  const auto& rows = data_.parameters.rows();
  out.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ParameterRow& r = rows[i];
    ParameterInfo info;
    info.id = r.id;
    info.name = r.name;
    info.unit = r.unit;
    double scale = 1;
    for (int d = 0; d < r.decimals; ++d) scale *= 10;
    info.increment = 1 / scale;
    info.minimum = r.raw_minimum / scale;
    info.maximum = r.raw_maximum / scale;
    info.special = r.special_text;
    info.allowed = r.allowed_text;
    const std::int32_t factory = store_.factory_raw(i);
    info.factory_default = r.has_9999 && factory == kRaw9999   ? 9999
                           : r.has_8888 && factory == kRaw8888 ? 8888
                                                               : factory / scale;
    info.source = r.source;
    info.confidence = r.confidence;
    info.effect = r.effect;
    info.acts = r.acts;
    out.push_back(info);
  }
  return out;
}

std::string MitsubishiInverter::eeprom_text() const {
  EepromRecord record = record_;
  record.operating_seconds += static_cast<std::int64_t>(v_.operating_s);
  count_family(record);
  return emit_eeprom({personality_.family, model_.model, personality_.counters}, store_, data_.alarms, record);
}

bool MitsubishiInverter::take_eeprom_changed() {
  const bool changed = eeprom_changed_;
  eeprom_changed_ = false;
  return changed;
}

Outcome MitsubishiInverter::load_eeprom(std::string_view text) {
  auto contents = parse_eeprom(text, {personality_.family, model_.model, personality_.counters}, store_, data_.alarms);
  if (!contents) {
    store_.clear_to_factory();
    record_ = {};
    causes_.eeprom_damaged = true;
    eeprom_changed_ = false;  // the owner keeps the damaged text until the inverter has gone through a power cycle
    if (control_alive_) {
      store_.load_ram_from_eeprom();
      raise("E.PE", "the stored parameters are damaged, factory values are in use: " + contents.error());
    }
    return Unexpected(contents.error());
  }
  store_.set_eeprom(contents->parameters);
  record_ = contents->record;
  eeprom_changed_ = false;
  if (!control_alive_) store_.load_ram_from_eeprom();
  return {};
}

void MitsubishiInverter::start_volatile() {
  store_.load_ram_from_eeprom();
  v_.panel_frequency_hz = record_.panel_frequency / 100.0;
  // Only Pr.59 = 1 has a memory; what an earlier setting stored does not count.
  v_.remote.power_on(store_.integer(pr::kRemoteSetting) == 1 ? record_.remote_frequency / 100.0 : 0);
  v_.mrs_inverted = store_.integer(pr::kMrsSense) != 0;
  start_family();
  v_.mode = start_mode();
}

}  // namespace vinv::inverter::mitsubishi
