// enip_bench: measures any EtherNet/IP adapter from outside, over its sockets. Tables for people on standard output,
// and with --json a file for programs. What counts are ratios against a bare sender or echo of the same run.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "sim/base/ipv4.hpp"
#include "tests/bench/ethernet_ip/explicit_rate.hpp"
#include "tests/bench/ethernet_ip/flood.hpp"
#include "tests/bench/ethernet_ip/io_intervals.hpp"

namespace vinv::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Common {
  std::string host = "127.0.0.2", own = "127.0.0.1", json;
  std::uint16_t port = 44818, io_port = 2222;
  int pid = 0;
};

std::uint32_t address(const std::string& text) {
  const auto parsed = parse_ipv4(text);
  if (!parsed) throw std::runtime_error(text + " is no IPv4 address");
  return *parsed;
}

Json report(const std::vector<ExplicitResult>& results) {
  Json rows = Json::array();
  fmt::print("{:>11} {:>12} {:>12} {:>7} {:>7} {:>12}\n", "connections", "server/s", "echo/s", "ratio", "best",
             "CPU us/trip");
  for (const auto& r : results) {
    fmt::print("{:>11} {:>12.0f} {:>12.0f} {:>7.3f} {:>7.3f} {:>12.2f}\n", r.connections, r.server_per_s, r.echo_per_s,
               r.ratio, r.best_ratio, r.cpu_us_per_trip);
    rows.push_back({{"connections", r.connections},
                    {"server_per_s", r.server_per_s},
                    {"echo_per_s", r.echo_per_s},
                    {"ratio", r.ratio},
                    {"best_ratio", r.best_ratio},
                    {"server_cpu_us_per_trip", r.cpu_us_per_trip}});
  }
  return rows;
}

Json json(const IntervalStatistics& s) {
  return {{"p50_us", s.p50_us}, {"p99_us", s.p99_us}, {"p999_us", s.p999_us}, {"got_share", s.got_share}};
}

std::string row(const IntervalStatistics& s) {
  return fmt::format("{:>8.1f} {:>8.1f} {:>8.1f} {:>8.3f}", s.p50_us, s.p99_us, s.p999_us, 100 * s.got_share);
}

Json report(const std::vector<IoResult>& results) {
  Json rows = Json::array();
  fmt::print("{:>8} {:>7}   {:^35}   {:^35}   {:>6} {:>6} {:>10}\n", "", "", "server: us off, packets", "bare sender",
             "ratio", "", "CPU/drive");
  fmt::print("{:>8} {:>7}   {:>8} {:>8} {:>8} {:>8}   {:>8} {:>8} {:>8} {:>8}   {:>6} {:>6} {:>10}\n", "adapters",
             "RPI us", "p50", "p99", "p99.9", "%", "p50", "p99", "p99.9", "%", "p50", "p99", "% of core");
  for (const auto& r : results) {
    fmt::print("{:>8} {:>7}   {}   {}   {:>6.2f} {:>6.2f} {:>10.2f}\n", r.adapters, r.rpi_us, row(r.server),
               row(r.sender), r.server.p50_us / r.sender.p50_us, r.server.p99_us / r.sender.p99_us,
               100 * r.cpu_share_per_drive);
    rows.push_back({{"adapters", r.adapters},
                    {"rpi_us", r.rpi_us},
                    {"server", json(r.server)},
                    {"sender", json(r.sender)},
                    {"cpu_share_per_drive", r.cpu_share_per_drive}});
  }
  return rows;
}

Json report(const std::vector<FloodResult>& results) {
  Json rows = Json::array();
  fmt::print("{:<18}   {:^35}   {:^35}   {:>6} {:>6} {:>10} {:>10}\n", "", "neighbour: us off, packets",
             "without the flood", "ratio", "", "attacks/s", "MB more");
  for (const auto& r : results) {
    fmt::print("{:<18}   {}   {}   {:>6.2f} {:>6.2f} {:>10.0f} {:>10.1f}\n", r.kind, row(r.during), row(r.quiet),
               r.during.p50_us / r.quiet.p50_us, r.during.p99_us / r.quiet.p99_us, r.attacks_per_s,
               static_cast<double>(r.memory_growth_bytes) / 1e6);
    rows.push_back({{"kind", r.kind},
                    {"during", json(r.during)},
                    {"quiet", json(r.quiet)},
                    {"attacks_per_s", r.attacks_per_s},
                    {"memory_growth_bytes", r.memory_growth_bytes}});
  }
  return rows;
}

int run(int argc, char** argv) {
  CLI::App app{"Benchmarks for EtherNet/IP adapters"};
  app.require_subcommand(1);
  Common common;
  ExplicitOptions explicit_options;
  IoOptions io;
  FloodOptions flood;
  const auto add_common = [&](CLI::App* sub) {
    sub->add_option("--host", common.host, "Address of the adapter; further ones follow it")->capture_default_str();
    sub->add_option("--port", common.port, "Its TCP port")->capture_default_str();
    sub->add_option("--own", common.own, "Own address")->capture_default_str();
    sub->add_option("--pid", common.pid, "Process of the server, for its processor time and memory");
    sub->add_option("--json", common.json, "Writes the results here, too");
  };
  const auto add_io = [&](CLI::App* sub) {
    sub->add_option("--io-port", common.io_port, "Its UDP port")->capture_default_str();
    sub->add_option("--points", io.points, "Connection points: [configuration,] consumed, produced")->delimiter(',');
    sub->add_option("--consumed-bytes", io.consumed_bytes)->capture_default_str();
    sub->add_option("--produced-bytes", io.produced_bytes)->capture_default_str();
  };
  CLI::App* rate = app.add_subcommand("explicit", "Round trips of Get_Attribute_Single against a raw TCP echo");
  add_common(rate);
  rate->add_option("--connections", explicit_options.connections)->delimiter(',');
  rate->add_option("--rounds", explicit_options.rounds)->capture_default_str();
  rate->add_option("--seconds", explicit_options.round_s, "Of each round and side")->capture_default_str();
  rate->add_option("--cpu", explicit_options.cpu, "Processor for all; -1: any")->capture_default_str();
  rate->add_option("--class", explicit_options.class_id)->capture_default_str();
  rate->add_option("--instance", explicit_options.instance)->capture_default_str();
  rate->add_option("--attribute", explicit_options.attribute)->capture_default_str();
  CLI::App* intervals = app.add_subcommand("io", "Intervals of I/O packets against a bare sender");
  add_common(intervals);
  add_io(intervals);
  intervals->add_option("--adapters", io.adapters)->delimiter(',');
  intervals->add_option("--rpi-us", io.rpi_us)->delimiter(',');
  intervals->add_option("--rounds", io.rounds)->capture_default_str();
  intervals->add_option("--seconds", io.round_s, "Of each round and side")->capture_default_str();
  CLI::App* hostile = app.add_subcommand("flood", "A neighbour's I/O while the adapter before it is attacked");
  add_common(hostile);
  add_io(hostile);
  hostile->add_option("--kinds", flood.kinds)->delimiter(',');
  hostile->add_option("--rpi-us", flood.rpi_us)->capture_default_str();
  hostile->add_option("--rounds", flood.rounds)->capture_default_str();
  hostile->add_option("--seconds", flood.round_s, "Of each round")->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  Json out;
  out["host"] = common.host;
  if (rate->parsed()) {
    explicit_options.host = address(common.host);
    explicit_options.own = address(common.own);
    explicit_options.port = common.port;
    explicit_options.pid = common.pid;
    out["explicit"] = report(measure_explicit(explicit_options));
  } else {
    io.host = address(common.host);
    io.own = address(common.own);
    io.port = common.port;
    io.io_port = common.io_port;
    io.pid = common.pid;
    if (intervals->parsed()) {
      out["io"] = report(measure_io(io));
    } else {
      flood.io = io;
      out["flood"] = report(measure_flood(flood));
    }
  }
  if (!common.json.empty()) std::ofstream(common.json) << out.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace vinv::bench

int main(int argc, char** argv) {
  try {
    return vinv::bench::run(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "enip_bench: {}\n", e.what());
    return 1;
  }
}
