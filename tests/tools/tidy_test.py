"""The house rules find what they are made to find: each bad sample gives exactly the finding it was written for."""
import os
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools"))
import tidy  # noqa: E402

HPP = "#pragma once\n"
# A small tree that breaks no rule; samples are added to it.
CLEAN = {
    "README.md": "See [the parts](sim/base/time.hpp) and [more](https://example.org/x).\n",
    "sim/base/time.hpp": HPP + "#include <chrono>\n",
    "sim/kernel/clock.cpp": '#include <thread>\n#include "sim/base/time.hpp"\nauto t = std::chrono::steady_clock::now();\n',
    "sim/transports/tcp.hpp": HPP + '#include <asio.hpp>\n#include "sim/kernel/scheduler.hpp"\n',
    "sim/kernel/scheduler.hpp": HPP + '#include "sim/base/time.hpp"\n',
    "sim/rig/rig.cpp": '#include "motor_model/plant/plant.hpp"\n#include "option_boards/boards/board.hpp"\n',
    "motor_model/plant/plant.hpp": HPP + '#include "sim/base/time.hpp"\n',
    "motor_model/plant/solver/ark.cpp": "#include <arkode/arkode_erkstep.h>\n",
    "motor_model/port/port.hpp": HPP,
    "motor_model/drive/ramp.hpp": HPP + '#include "motor_model/port/port.hpp"\n',
    "motor_model/inverter/inverter.cpp": '#include "motor_model/drive/ramp.hpp"\n#include "vinv_inverter_data.hpp"\n',
    "option_boards/cip/epath.hpp": HPP,
    "option_boards/modbus/unit.hpp": HPP,
    "option_boards/ethernet_ip/encap.hpp": HPP + '#include "option_boards/cip/epath.hpp"\n',
    "option_boards/boards/board.hpp": HPP + '#include "option_boards/modbus/unit.hpp"\n#include "motor_model/port/port.hpp"\n',
    "option_boards/boards/one/one.hpp": HPP,
    "tools/vinverter/main.cpp": '#include "sim/rig/rig.hpp"\n#include <filesystem>\n',
    "sim/rig/rig.hpp": HPP,
    "tests/sim/base/bench.hpp": HPP,
    "tests/sim/base/time_test.cpp": '#include "motor_model/drive/ramp.hpp"\n#include "bench.hpp"\nTEST(Time, StartsAwayFromZero) {}\n',
}
# (rule, path, content)
BAD = [
    ("arrow", "sim/base/up.hpp", HPP + '#include "sim/kernel/scheduler.hpp"\n'),
    ("arrow", "sim/kernel/up.cpp", '#include "sim/transports/tcp.hpp"\n'),
    ("arrow", "sim/transports/up.cpp", '#include "sim/rig/rig.hpp"\n'),
    ("arrow", "motor_model/plant/up.cpp", '#include "motor_model/drive/ramp.hpp"\n'),
    ("arrow", "motor_model/drive/side.cpp", '#include "motor_model/plant/plant.hpp"\n'),
    ("arrow", "motor_model/drive/board.cpp", '#include "option_boards/boards/board.hpp"\n'),
    ("arrow", "option_boards/modbus/port.cpp", '#include "motor_model/port/port.hpp"\n'),
    ("arrow", "option_boards/modbus/side.cpp", '#include "option_boards/cip/epath.hpp"\n'),
    ("arrow", "option_boards/boards/drive.cpp", '#include "motor_model/drive/ramp.hpp"\n'),
    ("arrow", "option_boards/boards/two/two.cpp", '#include "option_boards/boards/one/one.hpp"\n'),
    ("arrow", "sim/rig/tool.cpp", '#include "tools/vinverter/x.hpp"\n'),
    ("arrow", "motor_model/port/test.cpp", '#include "tests/support/x.hpp"\n'),
    ("sundials", "motor_model/plant/model.cpp", "#include <arkode/arkode.h>\n"),
    ("sundials", "motor_model/plant/solver/ark.hpp", HPP + "#include <nvector/nvector_serial.h>\n"),
    ("sundials", "sim/rig/solve.cpp", "#include <sundials/sundials_types.h>\n"),
    ("os", "motor_model/drive/file.cpp", "#include <fstream>\n"),
    ("os", "option_boards/modbus/net.cpp", "#include <asio/ip/tcp.hpp>\n"),
    ("os", "option_boards/boards/net.cpp", "#include <sys/socket.h>\n"),
    ("os", "sim/base/lock.hpp", HPP + "#include <mutex>\n"),
    ("clock", "motor_model/drive/now.cpp", "auto t = std::chrono::steady_clock::now();\n"),
    ("clock", "option_boards/modbus/wait.cpp", "std::this_thread::sleep_for(d);\n"),
    ("clock", "sim/base/chance.cpp", "std::random_device r;\n"),
    ("os", "option_boards/modbus/say.cpp", "#include <iostream>\n"),
    ("console", "option_boards/modbus/print.cpp", 'std::fprintf(stderr, "x");\n'),
    ("console", "motor_model/drive/print.cpp", "std::cerr << 1;\n"),
    ("stranger", "tests/conformance/master.cpp", '#include "option_boards/cip/epath.hpp"\n'),
    ("base", "sim/base/format.cpp", "#include <fmt/format.h>\n"),
    ("include", "sim/kernel/near.cpp", '#include "scheduler.hpp"\n'),
    ("include", "sim/kernel/gone.cpp", '#include "sim/kernel/gone.hpp"\n'),
    ("guard", "sim/kernel/twice.hpp", "int x;\n"),
    ("family", "option_boards/boards/ask.cpp", 'if (family == "fr-e500") {}\n'),
    ("family", "sim/rig/ask.cpp", 'if (inverter.family() != "fr-e500") {}\n'),
    ("family", "sim/rig/ask_board.cpp", 'if (board.type() == "fr-' + 'a7ne") {}\n'),
    ("test-name", "tests/sim/base/name_test.cpp", "TEST(Time, starts_at_zero) {}\n"),
    ("unfinished", "sim/kernel/later.cpp", "int x;  // TO" + "DO: more\n"),
    ("unfinished", "docs/half.md", "wi" + "p: more follows\n"),
    ("unfinished", "tests/sim/base/skip_test.cpp", "GTEST" + "_SKIP();\n"),
    ("unfinished", "tools/vinverter/dummy.cpp", "// a place" + "holder\n"),
    ("outside", "tools/script", "cp /wor" + "k/file .\n"),
    ("outside", "docs/x.md", "see ../sha" + "red/guides\n"),
    ("outside", "tests/lock.json", '{"resolved": "https://registry.' + 'npmjs.org/x"}\n'),
    ("link", "docs/y.md", "[gone](../gone.md)\n"),
    ("encoding", "docs/z.md", b"\xff\xfe"),
]


def write(root, files):
    for path, content in files.items():
        full = os.path.join(root, path)
        os.makedirs(os.path.dirname(full), exist_ok=True)
        with open(full, "wb") as f:
            f.write(content if isinstance(content, bytes) else content.encode())


class Tidy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        write(cls.folder.name, CLEAN)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def findings(self, extra):
        write(self.folder.name, extra)
        try:
            return [(path, rule) for path, _, rule, _ in tidy.check_tree(self.folder.name)]
        finally:
            for path in extra:
                os.unlink(os.path.join(self.folder.name, path))

    def test_clean_tree_has_no_finding(self):
        self.assertEqual(self.findings({}), [])

    def test_each_bad_sample_is_found(self):
        for rule, path, content in BAD:
            with self.subTest(path=path, rule=rule):
                extra = {path: content}
                for header in ("tools/vinverter/x.hpp", "tests/support/x.hpp"):
                    extra[header] = HPP
                self.assertEqual(self.findings(extra), [(path, rule)])

    def test_every_rule_has_a_bad_sample(self):
        with open(tidy.__file__, encoding="utf-8") as f:
            rules = set(__import__("re").findall(r'yield (?:path, )?(?:number, |1, )?"([a-z-]+)"', f.read()))
        self.assertEqual(rules, {rule for rule, _, _ in BAD})

    def test_a_comment_may_name_a_clock(self):
        self.assertEqual(self.findings({"motor_model/drive/why.cpp": "// no steady_clock here\n"}), [])


if __name__ == "__main__":
    unittest.main()
