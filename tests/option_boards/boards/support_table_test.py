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

    def test_parameters_are_made_from_the_family_table_once_it_exists(self):
        self.put("docs/parameters.md", "<!-- support-table: fr-e500-parameters -->\n<!-- end support-table -->\n")
        self.run_script()
        self.assertEqual(self.run_script("--check").returncode, 0)
        self.put("motor_model/families/mitsubishi_e500/parameters.csv",
                 "pr,sub,name,min,max,special,increment,unit,default,source,confidence,acts,effect\n"
                 "57,00,Restart,0,5,9999,0.1,s,9999,typical for the family,medium,yes,Coasting time\n"
                 "902,01,Bias,0,60,,0.01,Hz,0,manual 6.2.2.1,medium,no,None here\n")
        self.assertEqual(self.run_script("--check").returncode, 1)
        self.assertEqual(self.run_script().returncode, 0)
        text = (self.root / "docs/parameters.md").read_text()
        self.assertIn("| Pr.57 | Restart | 0-5, 9999 | 0.1 | s | 9999 |", text)
        self.assertIn("| Pr.902 (1) | Bias |", text)
        self.assertNotIn("Test |", text)


if __name__ == "__main__":
    unittest.main()
