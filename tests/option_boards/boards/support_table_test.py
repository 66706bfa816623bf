"""tools/support_table.py on a tree of its own: writes, finds what is behind, names what is wrong."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[3] / "tools" / "support_table.py"
HEADER = "first,last,step,access,item,index,min,max,value,name,section,confidence,test,notes\n"
ROW = "24006,24006,2,W,analog,0,0,255,,Analog speed,8.7.8,high,Map.Analog,A|B\n"
PAGE = "# Board\n<!-- support-table: oi-fr-e5nco-registers -->\n<!-- end support-table -->\nend\n"


class SupportTable(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.root = Path(self.folder.name)
        self.put("option_boards/boards/oi_fr_e5nco/registers.csv", HEADER + ROW)
        self.put("tests/map_test.cpp", "TEST_F(Map, Analog) {}\n")
        self.page = self.put("docs/boards/board.md", PAGE)

    def put(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, str(SCRIPT), "--root", str(self.root), *arguments],
                              capture_output=True, text=True, check=False)

    def test_writes_the_table_between_the_marks_and_is_then_up_to_date(self):
        self.assertEqual(self.run_script("--check").returncode, 1)
        self.assertEqual(self.page.read_text(), PAGE)
        self.assertEqual(self.run_script().returncode, 0)
        text = self.page.read_text()
        self.assertIn("| 24006 | Analog speed | write | 0-255 | 8.7.8 | high | A\\|B | `Map.Analog` |", text)
        self.assertTrue(text.startswith("# Board\n") and text.endswith("end\n"))
        self.assertEqual(self.run_script("--check").returncode, 0)

    def test_changed_data_is_found(self):
        self.run_script()
        self.put("option_boards/boards/oi_fr_e5nco/registers.csv", HEADER + ROW.replace("255", "254"))
        result = self.run_script("--check")
        self.assertEqual(result.returncode, 1)
        self.assertIn("docs/boards/board.md is behind its data", result.stderr)

    def test_row_that_names_no_test_is_found(self):
        self.run_script()
        self.put("tests/map_test.cpp", "TEST_F(Map, Analogue) {}\n")
        result = self.run_script("--check")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no test is named Map.Analog", result.stderr)

    def test_data_without_a_page_is_found(self):
        self.page.write_text("# Board\n")
        self.assertIn("no page has the table oi-fr-e5nco-registers", self.run_script("--check").stderr)

    PARAMETERS = ("pr,sub,name,min,max,special,increment,fine_increment,unit,default,model_default,write_while_running,"
                  "write_while_running_pr77_2,write_when_locked,clear,source,confidence,acts,effect,test\n")
    RESTART = "57,00,Restart,0,5,9999,0.1,,s,9999,,no,yes,no,,typical,medium,yes,Coasting time,Map.Restart\n"

    def put_parameters(self, *rows):
        self.put("tests/restart_test.cpp", 'TEST(Map, Restart) {\n  preset("Pr.57", 1);\n}\n')
        self.put("docs/parameters.md", "<!-- support-table: fr-e500-parameters -->\n<!-- end support-table -->\n")
        self.put("motor_model/families/mitsubishi_e500/parameters.csv", self.PARAMETERS + "".join(rows))

    def test_parameters_are_made_from_the_family_table_once_it_exists(self):
        page = self.put("docs/parameters.md",
                        "<!-- support-table: fr-e500-parameters -->\n<!-- end support-table -->\n")
        self.run_script()
        self.assertEqual(self.run_script("--check").returncode, 0)
        self.put_parameters(self.RESTART,
                            "902,01,Bias,0,60,,0.01,,Hz,0,,unknown,yes,no,all_only,manual,medium,no,Nothing: no input,\n",
                            "7,00,Ramp,0,3600,,0.1,21=1:0.01,s,5,kw<=3.7:5 kw<=7.5:10,yes,yes,yes,,typical,low,no,"
                            "Nothing: test,\n")
        self.assertEqual(self.run_script("--check").returncode, 1)
        self.assertEqual(self.run_script().stderr, "")
        text = page.read_text()
        self.assertIn("| Pr.57 | Restart | 0-5, 9999 | 0.1 | s | 9999 | stopped; running with Pr.77 = 2 | both |", text)
        self.assertIn("| Pr.902 (1) | Bias | 0-60 | 0.01 | Hz | 0 | stopped; running with Pr.77 = 2 (with 0 not known) | "
                      "ALLC only |", text)
        self.assertIn("| 0.1; 0.01 with Pr.21 = 1 | s | 5 (to 3.7 kW), 10 (to 7.5 kW) | "
                      "stopped and running; with Pr.77 = 1 too |", text)

    def problems_of_parameter(self, row):
        self.put_parameters(row)
        self.run_script()
        result = self.run_script("--check")
        self.assertEqual(result.returncode, 1 if result.stderr else 0)
        return result.stderr

    def test_parameter_that_acts_needs_a_test_that_mentions_it(self):
        self.assertEqual(self.problems_of_parameter(self.RESTART), "")
        self.assertIn("Pr.57 names no test", self.problems_of_parameter(self.RESTART.replace("Map.Restart", "")))
        self.assertIn("Pr.5: Map.Restart does not mention it", self.problems_of_parameter("5" + self.RESTART[2:]))
        self.assertIn("no test is named Map.Other",
                      self.problems_of_parameter(self.RESTART.replace("Map.Restart", "Map.Restart Map.Other")))

    def test_parameter_that_does_nothing_says_why_and_names_no_test(self):
        idle = self.RESTART.replace("yes,Coasting time", "no,Nothing: no bell")
        self.assertIn("Pr.57 does not act but names a test", self.problems_of_parameter(idle))
        self.assertEqual(self.problems_of_parameter(idle.replace("Map.Restart", "")), "")
        self.assertIn("does not say why",
                      self.problems_of_parameter(self.RESTART.replace("yes,Coasting", "no,Coasting")))

    def test_each_row_of_the_other_tables_needs_a_test(self):
        family = "motor_model/families/mitsubishi_e500/"
        self.put(family + "alarms.csv", "name,data_code_hex,cause,retry_pr65,reset,test\nE.OC1,10,Current,0|1,any,\n"
                                        "none,00,No alarm,,,\n")
        self.put(family + "terminals.csv", "direction,parameters,number,signal,meaning,default_of,test\n"
                                           "input,180-183,3,RT,Second,,\n")
        self.put("docs/family.md", "<!-- support-table: fr-e500-alarms -->\n<!-- end support-table -->\n"
                                   "<!-- support-table: fr-e500-terminals -->\n<!-- end support-table -->\n")
        self.put("option_boards/boards/oi_fr_e5nco/objects.csv",
                 "first,last,sub_first,sub_last,type,access,pdo,default,min,max,name,test\n"
                 "1000,,0,,UNSIGNED32,RO,,,,,Device type,\n")
        self.put("option_boards/boards/oi_fr_e5nco/emergency_codes.csv",
                 "alarm,data_code_hex,error_code_hex,error_register_hex,test\nE.GF,80,2330,03,\n")
        self.put("docs/boards/oi-fr-e5nco-services.csv", "section,service,behaviour,test\n6.1,SDO,Expedited,\n")
        self.put("docs/can.md", "".join(f"<!-- support-table: oi-fr-e5nco-{name} -->\n<!-- end support-table -->\n"
                                        for name in ("objects", "emergencies", "services")))
        self.put("option_boards/boards/oi_fr_e5nco/registers.csv", HEADER + ROW.replace("Map.Analog", ""))
        errors = self.run_script().stderr
        self.assertIn("E.OC1 names no test", errors)
        self.assertNotIn("none names no test", errors)
        self.assertIn("input RT names no test", errors)
        self.assertIn("24006 names no test", errors)
        self.assertIn("1000H:0 names no test", errors)
        self.assertIn("E.GF names no test", errors)
        self.assertIn("SDO names no test", errors)


if __name__ == "__main__":
    unittest.main()
