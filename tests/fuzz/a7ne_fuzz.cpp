// FR-A7NE: any explicit request gets one answer or one ticket; polled data of any kind, resets and power cycles in
// between.
#include <cstddef>
#include <cstdint>
#include <set>

#include "option_boards/boards/fr_a7ne/cip_unit.hpp"
#include "sim/base/check.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/support/fake_drive.hpp"

namespace {

using vinv::boards::fr_a7ne::CipUnit;

struct Bench {
  vinv::test::FakeDrive drive;
  CipUnit unit{drive, {}};
  vinv::Instant now = vinv::instant_from_ns(1'000'000'000);
  std::set<vinv::cip::Ticket> awaited;
  vinv::cip::Reply reply;

  Bench() {
    for (unsigned number = 0; number < 900; ++number) {
      drive.parameters.emplace(static_cast<std::uint16_t>(number), vinv::test::FakeDrive::Parameter{});
    }
    drive.parameters[346].value = 132;
    drive.mode = vinv::port::OperationMode::kNetwork;
    unit.handle_power(now, true);
    collect();
  }
  void request(const vinv::Bytes& bytes) {
    const auto parsed = vinv::cip::parse_request(bytes);
    if (!parsed.request) return;
    if (const auto ticket = unit.router().handle(now, *parsed.request, reply)) {
      VINV_CHECK(awaited.insert(*ticket).second);
    } else {
      vinv::Bytes out;
      vinv::cip::append_reply(out, parsed.service, reply);
      VINV_CHECK(vinv::cip::parse_reply(out).has_value());
    }
  }
  void polled(const vinv::Bytes& bytes, bool idle) {
    for (const std::uint32_t point : {20u, 21u, 126u, 129u}) {
      const auto size = unit.consumed_size(point);
      if (!size || bytes.size() < *size) continue;
      unit.consume(now, point, vinv::ByteView(bytes).first(*size),
                   idle ? vinv::cip::RunMode::kIdle : vinv::cip::RunMode::kRun);
    }
    for (const std::uint32_t point : {70u, 71u, 176u, 179u}) {
      vinv::Bytes out(unit.produced_size(point).value_or(0));
      if (!out.empty()) unit.produce(now, point, out);
    }
  }
  void tick(unsigned milliseconds) {
    now += std::chrono::milliseconds(milliseconds);
    drive.tick();
    unit.handle_drive_tick(now);
    collect();
  }
  void collect() {
    while (const auto deferred = unit.router().poll_reply()) VINV_CHECK(awaited.erase(deferred->ticket) == 1);
    if (unit.take_restart()) awaited.clear();
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  Bench bench;
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    switch (what % 8) {
      case 0: bench.tick(what / 8u); break;
      case 1: bench.tick(5000); break;
      case 2: bench.polled(input.chunk(6), (what & 0x80) != 0); break;
      case 3: bench.drive.parameters[346].value = input.word() & 0x0FFF; break;
      case 4:
        bench.unit.handle_power(bench.now, (what & 0x80) != 0);
        bench.collect();
        break;
      case 5: bench.drive.status_now.alarm = (what & 0x80) != 0; break;
      default: bench.request(input.chunk(what / 8u)); break;
    }
  }
  // With supply and time every answer comes.
  bench.unit.handle_power(bench.now, true);
  bench.collect();
  for (unsigned i = 0; i < 300; ++i) bench.tick(50);
  VINV_CHECK(bench.awaited.empty());
  return 0;
}
