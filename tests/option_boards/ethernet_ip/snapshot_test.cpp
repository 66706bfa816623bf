// Sessions, connections and answers under way survive a snapshot (docs/decisions/0005-snapshots.md).
#include <gtest/gtest.h>

#include "tests/option_boards/ethernet_ip/adapter_bench.hpp"

namespace vinv::ethernet_ip {
namespace {

using namespace std::chrono_literals;
using test::AdapterBench;
using test::from_hex;
using test::Master;
using test::OpenWish;
using test::to_hex;

struct Whole {
  AdapterBench& bench;
  friend void archive(Archive& a, Whole& w) {
    a.io(w.bench.adapter);
    a.io(w.bench.device.router());
  }
};

TEST(AdapterSnapshotTest, ResumedAdapterGoesOnAsTheUninterruptedOne) {
  AdapterBench a;
  auto master = Master::registered(a);
  OpenWish io;
  io.t2o = 0x2800 | 6;
  io.transport = 0x11;
  const auto id = master.open_id(io);
  OpenWish explicit_wish;
  explicit_wish.serial = 2;
  explicit_wish.transport = 0xa3;
  explicit_wish.o2t = explicit_wish.t2o = 0x4000 | 500;
  explicit_wish.path = "20 02 24 01";
  const auto class3 = master.open_id(explicit_wish);
  master.send_io(id, 1, 1, "01 02 03 04");
  master.connected(class3, 1, from_hex("10 03 20 70 24 01 30 01 05 00"));
  master.send(from_hex("63 00 00 00 00"));  // part of a message
  a.advance(7ms);
  a.take(Channel::kIo);

  Whole whole_a{a};
  const Bytes snapshot = save_snapshot(whole_a);
  AdapterBench b;
  Whole whole_b{b};
  ASSERT_TRUE(load_snapshot(whole_b, snapshot)) << load_snapshot(whole_b, snapshot).error();
  EXPECT_EQ(save_snapshot(whole_b), snapshot);
  b.now = a.now;
  Master resumed = master;

  const auto go_on = [&](AdapterBench& bench, Master& m) {
    Master on(bench, m.peer.address);
    on.tcp = m.tcp;
    on.session = m.session;
    std::vector<std::string> seen;
    const auto note = [&] {
      for (const Channel c : {Channel::kTcp, Channel::kUdp, Channel::kIo})
        for (const auto& p : bench.take(c)) seen.push_back(std::to_string(to_ns(p.at)) + " " + to_hex(p.bytes));
    };
    seen.push_back(to_hex(on.send(Bytes(19, 0))));
    cip::Reply reply;
    bench.device.router().complete(1000, reply);  // nobody's
    for (unsigned i = 2; i < 9; ++i) {
      on.send_io(id, i, i, "05 06 07 08");
      bench.advance(9ms);
      note();
    }
    seen.push_back(to_hex(on.connected(class3, 2, from_hex("0E 03 20 70 24 01 30 01"))));
    bench.advance(100ms);
    note();
    for (const auto& line : bench.take_log()) seen.push_back(line);
    return seen;
  };
  a.take_log();
  const auto one = go_on(a, master);
  EXPECT_EQ(one, go_on(b, resumed));
  EXPECT_GT(one.size(), 10u);
}

TEST(AdapterSnapshotTest, DamagedSnapshotIsRefused) {
  AdapterBench a;
  auto master = Master::registered(a);
  master.open({});
  const Bytes good = save_snapshot(a.adapter);
  AdapterBench b;
  std::size_t taken = 0;
  for (std::size_t at = kSnapshotHeader; at < good.size(); ++at) {
    Bytes bad = good;
    bad[at] ^= 0x41;
    seal_snapshot(bad);
    if (load_snapshot(b.adapter, bad)) ++taken;  // a number that may be any
    b.adapter.handle_timeout(b.now);
    b.adapter.next_deadline();
    for (int i = 0; i < 3; ++i) b.adapter.poll_transmit(b.now);
  }
  EXPECT_LT(taken, good.size() * 3 / 4);
}

}  // namespace
}  // namespace vinv::ethernet_ip
