// What a plant file says of boards on Ethernet, and the mistakes that it can have there.
#include <gtest/gtest.h>

#include "sim/base/ipv4.hpp"
#include "sim/rig/plant_file.hpp"

namespace vinv::rig {
namespace {

PlantFile read(const std::string& text) { return parse_plant_file(text, "p.yaml", shipped_catalogue()); }
std::string mistakes(const std::string& text) {
  try {
    read(text);
  } catch (const PlantFileError& e) {
    return e.what();
  }
  return "";
}
std::string mistake(const std::string& board) {
  return mistakes("drives:\n  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n    board: " + board + "\n");
}
EthernetSpec ethernet(const std::string& board) {
  return *read("drives:\n  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n    board: " + board + "\n")
              .drives[0]
              .board->ethernet;
}

TEST(EthernetPlantFile, BoardOfTheFamilyWithTheLowestFreeAddressIsTheDefault) {
  const PlantFile file = read(
      "drives:\n  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n"
      "  - { name: e, board: { modbus_rtu: none } }\n"
      "  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n    board: { address: 127.0.0.3 }\n"
      "  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n");
  EXPECT_EQ(file.drives[0].board->type.value, "fr-a7ne");
  EXPECT_EQ(ipv4_text(file.drives[0].board->ethernet->address), "127.0.0.2");
  EXPECT_EQ(ipv4_text(file.drives[2].board->ethernet->address), "127.0.0.3");
  EXPECT_EQ(ipv4_text(file.drives[3].board->ethernet->address), "127.0.0.4");
  EXPECT_EQ(file.drives[1].board->node.value, 1u) << "boards on Ethernet use up no nodes";
  EXPECT_FALSE(file.drives[0].board->serial || file.drives[0].board->tcp || file.drives[0].board->can);
}

TEST(EthernetPlantFile, EveryKeyIsRead) {
  const EthernetSpec e = ethernet(
      "{ type: fr-a7ne, address: 192.168.1.10, bind: any, timing: fast, link_partner: 10_half,\n"
      "      lease: { address: 10.0.0.7, mask: 255.255.0.0, gateway: 10.0.0.1, name_server: 10.0.0.2, name_server_2: "
      "10.0.0.3, domain: works },\n"
      "      flash: { dhcp: on, address: 172.16.0.1, host_name: m1, line: 100_full } }");
  EXPECT_EQ(e.address, ipv4(192, 168, 1, 10));
  EXPECT_TRUE(e.any_address && e.fast);
  const auto& s = e.surroundings;
  EXPECT_EQ(s.lease, (boards::IpConfiguration{0x0a000007, 0xffff0000, 0x0a000001, 0x0a000002, 0x0a000003, "works"}));
  EXPECT_EQ(s.line_partner, (boards::LineSetting{false, false, 10}));
  EXPECT_TRUE(s.flash.dhcp);
  EXPECT_EQ(s.flash.ip.mask, 0xffff0000u);
  EXPECT_EQ(s.flash.host_name, "m1");
  EXPECT_EQ(s.flash.line, (boards::LineSetting{false, true, 100}));
  const EthernetSpec plain = ethernet("{ address: 192.168.1.10 }");
  EXPECT_EQ(plain.surroundings.lease, (boards::IpConfiguration{ipv4(192, 168, 1, 10), 0xffffff00, 0, 0, 0, ""}));
  EXPECT_TRUE(plain.surroundings.line_partner.automatic);
  EXPECT_FALSE(ethernet("{ flash: { address: 10.0.0.1 } }").surroundings.flash.dhcp);
}

TEST(EthernetPlantFile, MistakesAreToldWithPlaceAndWhatIsAllowed) {
  EXPECT_EQ(mistake("{ address: 127.0.0 }"),
            "p.yaml:3:23: address in board of drive_1 is \"127.0.0\"; allowed: the IPv4 address of one host, as "
            "127.0.0.2 or 192.168.1.10.");
  for (const char* none : {"0.0.0.0", "224.0.0.1", "255.255.255.255", "1.2.3.256", "localhost"})
    EXPECT_NE(mistake("{ address: " + std::string(none) + " }"), "") << none;
  EXPECT_EQ(mistake("{ lease: { mask: 255.0.255.0 } }"),
            "p.yaml:3:29: mask in lease of drive_1 is \"255.0.255.0\"; allowed: a network mask without gaps, as "
            "255.255.255.0.");
  EXPECT_EQ(mistake("{ flash: { host_name: " + std::string(49, 'x') + " } }"),
            "p.yaml:3:34: host_name in flash of drive_1 has 49 characters; allowed: at most 48.");
  EXPECT_EQ(mistake("{ connector: 4 }"),
            "p.yaml:3:25: connector in board of drive_1 is \"4\"; allowed: a whole number, 1 to 3.");
  EXPECT_EQ(mistake("{ node: 5 }"),
            "p.yaml:3:14: node in board of drive_1 belongs to a board with address switches; fr-a7ne is none.");
  EXPECT_EQ(mistake("{ modbus_tcp: 127.0.0.1:0 }"),
            "p.yaml:3:14: modbus_tcp in board of drive_1 belongs to a board on Modbus or CAN; fr-a7ne is none.");
  EXPECT_NE(mistake("{ link_partner: 100_ful }").find("Did you mean \"100_full\"?"), std::string::npos);
  EXPECT_NE(mistake("{ timing: slow }").find("allowed: real, fast."), std::string::npos);
  EXPECT_NE(mistake("{ type: oi-fr-e5nco }").find("does not fit family fr-a700"), std::string::npos);
  EXPECT_EQ(mistakes("drives:\n  - board: { address: 127.0.0.2, connector: 2 }\n"),
            "p.yaml:2:14: address in board of drive_1 belongs to a board on Ethernet; oi-fr-e5nco is none.\n"
            "p.yaml:2:34: connector in board of drive_1 belongs to a board of an inverter with several option "
            "connectors; oi-fr-e5nco is none.");
}

TEST(EthernetPlantFile, TwoAdaptersCannotHaveOneAddress) {
  EXPECT_EQ(
      mistakes("drives:\n  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n    board: { address: 127.0.0.9 }\n"
               "  - inverter: { family: fr-a700, model: FR-A740-1.5K }\n    board: { address: 127.0.0.9 }\n"),
      "p.yaml:5:23: address 127.0.0.9 of drive_2 is taken by drive_1; allowed: another one, each adapter has its own.");
}

TEST(EthernetPlantFile, ModelSaysTheFamilyThatIsNotWritten) {
  const PlantFile file =
      read("drives:\n  - inverter: { model: FR-A740-2.2K }\n  - inverter: { model: FR-E520-0.2K }\n");
  EXPECT_EQ(file.drives[0].family, "fr-a700");
  EXPECT_EQ(file.drives[0].board->type.value, "fr-a7ne");
  EXPECT_EQ(file.drives[0].motor.value.rated_power_w, 2200);
  EXPECT_EQ(file.drives[1].family, "fr-e500");
  EXPECT_EQ(mistakes("drives:\n  - inverter: { family: fr-a700, model: FR-E540-1.5K }\n"),
            "p.yaml:2:41: FR-E540-1.5K of drive_1 is a model of family fr-e500, not fr-a700.");
  EXPECT_TRUE(mistakes("drives:\n  - inverter: { model: FR-A740-2.2k }\n").ends_with("Did you mean \"FR-A740-2.2K\"?"));
  const std::string with_family = mistakes("drives:\n  - inverter: { family: fr-a700, model: FR-A740-2.2k }\n");
  EXPECT_TRUE(with_family.ends_with("Did you mean \"FR-A740-2.2K\"?"));
  EXPECT_EQ(with_family.find("FR-E540"), std::string::npos);
}

}  // namespace
}  // namespace vinv::rig
