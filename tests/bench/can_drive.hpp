// An FR-E500 with its OI-FR-E5NCO as a node on a CAN bus, ticked every millisecond of the scheduler's time. The
// smallest owner a drive can have, so that benchmarks of the bus measure the bus.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "motor_model/inverter/inverter.hpp"
#include "option_boards/boards/make_board.hpp"
#include "sim/base/check.hpp"
#include "sim/transports/can/can_bus.hpp"

namespace vinv::test {

class CanDrive {
 public:
  // Bus and scheduler outlive the drive.
  CanDrive(kernel::Scheduler& scheduler, transports::CanBus& bus, unsigned node_address) : scheduler_(scheduler) {
    inverter::InverterConfig config;
    config.model = "FR-E540-1.5K";
    config.motor = *plant::find_machine("iec4p_1k5kW_400V");
    config.factory_values.emplace_back("Pr.345", node_address);
    auto inverter = inverter::make_inverter("fr-e500", config);
    VINV_CHECK(inverter.has_value());
    inverter_ = std::move(*inverter);
    auto board = boards::make_board({"oi-fr-e5nco", node_address}, inverter_->port());
    VINV_CHECK(board.has_value());
    board_ = std::move(*board);
    channel_ = board_->can_channel();
    VINV_CHECK(channel_ != nullptr);
    transports::CanNodeOptions options;
    options.name = "drive " + std::to_string(node_address);
    node_ = bus.attach(scheduler.now(), options);
    transports::CanHandlers handlers;
    handlers.on_frame = [this](Instant now, const CanFrame& frame) {
      channel_->handle_frame(now, frame);
      settle(now);
    };
    handlers.on_sent = [this](Instant now, const CanFrame&) { settle(now); };
    node_->set_handlers(std::move(handlers));
    inverter_->set_power(true);
  }
  ~CanDrive() {
    if (event_ != 0) scheduler_.cancel(event_);
  }
  CanDrive(const CanDrive&) = delete;
  CanDrive& operator=(const CanDrive&) = delete;

  void tick(Instant now) {
    inverter_->tick(now);
    if (std::exchange(powered_, inverter_->powered()) != inverter_->powered()) board_->handle_power(now, powered_);
    board_->handle_drive_tick(now);
    settle(now);
  }
  transports::CanNode& node() { return *node_; }

 private:
  void settle(Instant now) {
    while (node_->queue_room() > 0) {
      const auto frame = channel_->poll_transmit(now);
      if (!frame) break;
      node_->send(now, *frame);
    }
    const auto deadline = board_->next_deadline();
    if (deadline == deadline_) return;
    if (event_ != 0) scheduler_.cancel(std::exchange(event_, 0));
    deadline_ = deadline;
    if (!deadline) return;
    event_ = scheduler_.schedule(std::max(*deadline, now), kernel::Priority::kBoard, [this](Instant at) {
      event_ = 0;
      deadline_.reset();
      board_->handle_timeout(at);
      settle(at);
    });
  }

  kernel::Scheduler& scheduler_;
  std::unique_ptr<inverter::Inverter> inverter_;
  std::unique_ptr<boards::OptionBoard> board_;
  boards::CanChannel* channel_ = nullptr;
  std::unique_ptr<transports::CanNode> node_;
  bool powered_ = false;
  std::optional<Instant> deadline_;
  kernel::EventId event_ = 0;
};

// Drives 1, 2, ... ticked in turn.
class CanDrives {
 public:
  CanDrives(kernel::Scheduler& scheduler, transports::CanBus& bus, unsigned count) : scheduler_(scheduler) {
    for (unsigned n = 1; n <= count; ++n) drives_.push_back(std::make_unique<CanDrive>(scheduler, bus, n));
    ticks_ =
        scheduler.schedule_every(scheduler.now() + inverter::Inverter::kControlPeriod,
                                 inverter::Inverter::kControlPeriod, kernel::Priority::kDrive, [this](Instant now) {
                                   for (const auto& drive : drives_) drive->tick(now);
                                 });
  }
  ~CanDrives() { scheduler_.cancel(ticks_); }
  CanDrives(const CanDrives&) = delete;
  CanDrives& operator=(const CanDrives&) = delete;

 private:
  kernel::Scheduler& scheduler_;
  std::vector<std::unique_ptr<CanDrive>> drives_;
  kernel::EventId ticks_ = 0;
};

}  // namespace vinv::test
