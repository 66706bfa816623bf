// All equations of the power side in one right-hand side: stage, machine, shaft, DC link, temperatures, energies.
// Plain constants and switch positions; whoever integrates sets them between two integrations, never during one.
#pragma once

#include <array>
#include <cstddef>

#include "motor_model/plant/dc_link.hpp"
#include "motor_model/plant/load.hpp"
#include "motor_model/plant/machine.hpp"
#include "motor_model/plant/rectifier.hpp"
#include "motor_model/plant/solver/solver.hpp"
#include "motor_model/plant/stage.hpp"
#include "motor_model/plant/thermal.hpp"

namespace vinv::plant {

// Order of the state vector. The first kCoreStates decide the step size; temperatures are slow and energies are
// quadratures, they ride along.
namespace state {
inline constexpr std::size_t kPsiSd = 0, kPsiSq = 1, kPsiRd = 2, kPsiRq = 3;  // Wb
inline constexpr std::size_t kOmegaMech = 4;                                  // rad/s
inline constexpr std::size_t kDcLink = 5;                                     // V
inline constexpr std::size_t kCoreStates = 6;
inline constexpr std::size_t kHeatSink = 6, kWinding = 7;  // degC
inline constexpr std::size_t kFromMains = 8, kStatorCopper = 9, kRotorCopper = 10, kIron = 11, kInverter = 12,
                             kStandby = 13, kSource = 14, kBrake = 15, kFriction = 16, kLoad = 17;  // J
inline constexpr std::size_t kFrameAngle = 18;  // rad, of the d axis against phase U
inline constexpr std::size_t kStates = 19;
}  // namespace state

// Comparators as rising functions: they act when they go through zero upwards.
namespace root {
inline constexpr std::size_t kOverCurrent = 0;  // |i_s|^2 above its limit
inline constexpr std::size_t kLinkAbove = 1;    // link at the upper edge of the band in which no switch acts
inline constexpr std::size_t kLinkBelow = 2;    // link at its lower edge
inline constexpr std::size_t kShaft = 3;        // sliding: rotation ends; held: breaks away
inline constexpr std::size_t kRoots = 4;
}  // namespace root

struct PlantModel {
  MachineModel machine;
  LoadModel load;
  DcLink link;
  Rectifier rectifier;
  Thermal thermal;

  // What feeds the stator: the stage, a line of its own, or nothing.
  bool gates_on = false;
  bool on_line = false;  // never together with gates_on
  bool fed() const { return gates_on || on_line; }

  // Line: a vector of this length that turns with omega.
  double line_peak_v = 0;
  double line_omega = 0;

  // Stage.
  bool chopper_on = false;
  double omega_k = 0;  // rad/s, at t_input
  double commanded_peak_v = 0;
  double omega_k_slope = 0;  // per second, on the way there
  double commanded_peak_slope = 0;
  double t_input = 0;
  double inverter_loss_fraction = 0;
  double iron_w_per_wb2 = 0;  // at the present frequency

  // Comparator levels of this integration.
  double over_current_squared = 0;  // A^2, 0: off
  double link_above_v = 0;
  double link_below_v = 0;
};

// Every flow at one instant.
struct Flows {
  CurrentPair i;
  FluxPair d_psi;
  double stator_peak_v = 0;
  double torque_nm = 0;
  ShaftTorques shaft;
  RectifierFlow rectifier;
  double link_current_a = 0;  // out of the link: stage, losses, standby, brake
  double current_squared = 0;
  double line_w = 0;                                                            // from the line, with the iron loss
  double output_w = 0, iron_w = 0, inverter_w = 0, standby_w = 0, brake_w = 0;  // output: into the stator
};

inline FluxPair flux_of(const double* y) {
  return {y[state::kPsiSd], y[state::kPsiSq], y[state::kPsiRd], y[state::kPsiRq]};
}

Flows flows(const PlantModel& model, double t, const double* y);

// Torque that dry friction has to hold on a standing shaft.
double net_torque_at_rest(const PlantModel& model, const double* y);

// Energy in the fields, the moving mass and the capacitor, J. Zero capacitance (inverse 0) counts as none.
double stored_energy(const PlantModel& model, const double* y);

// The stator flux that belongs to i_s = 0.
void open_stator(const PlantModel& model, double* y);

// Turns the frame so that its d axis stands at this angle; the fluxes stay where they are in space.
void align_frame(double angle_rad, double* y);

// The system as a solver takes it. The model must outlive it and stay where it is.
OdeSystem ode_system(const PlantModel& model);

// Magnitudes below which a core state's error counts absolutely (docs/decisions/0001-plant-solver.md).
inline constexpr std::array<double, state::kCoreStates> kStateFloor{0.1, 0.1, 0.1, 0.1, 10, 50};

}  // namespace vinv::plant
