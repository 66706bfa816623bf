// The FR-E500: what it differs in from the other Mitsubishi families.
// OI-FR-E5NCO manual (mode, commands, monitors, parameters of the option); the rest typical for the family.
#pragma once

#include <memory>

#include "motor_model/inverter/e500/operation_mode.hpp"
#include "motor_model/inverter/mitsubishi/inverter.hpp"

namespace vinv::inverter::e500 {

inline constexpr std::string_view kFamily = "fr-e500";

const FamilyData& family_data();
const mitsubishi::Personality& personality();

class E500Inverter final : public mitsubishi::MitsubishiInverter {
 public:
  E500Inverter(const InverterConfig& config, const ModelRow& model, ParameterStore store)
      : MitsubishiInverter(personality(), config, model, std::move(store)) {}

  Outcome set_reference(double hz) override;
  std::string display() const override;

 private:
  Result<std::uint16_t, port::Refusal> read_monitor(unsigned number) const override;
  port::OperationMode start_mode() const override { return e500::start_mode(mode_situation()); }
  Result<port::OperationMode, port::Refusal> requested_mode(ModeRequest request) const override {
    return request_mode(v_.mode, request, mode_situation());
  }
  port::OperationMode mode_by_settings() const override { return follow_settings(v_.mode, mode_situation()); }
  mitsubishi::Inputs read_inputs() override;
  double set_frequency(const mitsubishi::Inputs& inputs) override;
  mitsubishi::SettingsSelection selection(const mitsubishi::Inputs& inputs) const override;
  drive::DriveSettings make_settings(const mitsubishi::SettingsSelection& selection) const override;
  void follow_communication() override;
  void publish_family(OutputSignals& outputs) override;
  std::optional<port::Refusal> command_parameter(unsigned number, std::int32_t raw) override;
  std::int32_t command_value(unsigned number) const override;
  void link_parameters(unsigned number, Storage storage) override;
  bool in_user_group(unsigned number) const override;
  port::WriteOutcome decide_family(const port::WriteRequest& request) override;

  ModeSituation mode_situation() const;
  double terminal_2_percent();
  double terminal_4_percent();
};

// Refuses with a sentence.
Result<std::unique_ptr<Inverter>, std::string> make_e500(const InverterConfig& config);

}  // namespace vinv::inverter::e500
