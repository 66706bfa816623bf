// PDUs: parse, emit, equal; and every PDU gets one well-formed answer from the board.
// Input: a byte of circumstances, then PDUs with their length in front.
#include "tests/fuzz/answer_check.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tests/option_boards/support/bench.hpp"

using vinv::Bytes;
namespace modbus = vinv::modbus;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  vinv::fuzz::Input input(data, size);
  vinv::test::Bench bench;
  const std::uint8_t circumstances = input.byte();
  bench.drive.mode =
      (circumstances & 1) != 0 ? vinv::port::OperationMode::kNetwork : vinv::port::OperationMode::kExternal;
  bench.drive.parameters[347].value = (circumstances & 2) != 0 ? 0x84 : 0x04;
  bench.drive.status_now.running = (circumstances & 4) != 0;
  bench.drive.write_disabled = (circumstances & 8) != 0;
  bench.drive.parameters[144].value = circumstances >> 4;
  bench.power_on();
  for (int i = 0; i < 16 && !input.empty(); ++i) {
    const Bytes pdu = input.chunk(input.byte());
    if (const auto request = modbus::parse_request(pdu)) {
      VINV_CHECK(modbus::emit(*request) == pdu);
    } else {
      VINV_CHECK(request.error() == modbus::Exception::kIllegalFunction ||
                 request.error() == modbus::Exception::kIllegalDataValue);
    }
    bench.unit().handle_request(bench.now, 0, modbus::Addressing::kUnit, pdu);
    std::optional<Bytes> answer = bench.unit().poll_answer(bench.now, 0);
    if (!answer) {
      bench.advance(vinv::test::Bench::kTick);
      answer = bench.unit().poll_answer(bench.now, 0);
    }
    VINV_CHECK(answer.has_value());
    vinv::fuzz::check_answer(pdu, *answer);
    VINV_CHECK(!bench.unit().poll_answer(bench.now, 0));
    bench.unit().handle_request(bench.now, 1, modbus::Addressing::kBroadcast, pdu);
    bench.advance(vinv::test::Bench::kTick);
    VINV_CHECK(!bench.unit().poll_answer(bench.now, 1));
  }
  return 0;
}
