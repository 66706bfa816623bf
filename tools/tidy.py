#!/usr/bin/env python3
"""House rules as a test: who may include whom, where the operating system may appear, what no file may contain.

Usage: tidy.py [ROOT]      prints one line per finding, FILE:LINE: [rule] text; exits 1 if there is one.
ARCHITECTURE.md explains the arrows; this file is where they are enforced.
"""
import os
import re
import sys

# Each part and the parts it may include directly. What it may reach is the closure of this; longest path wins.
ARROWS = {
    "sim/base": [],
    "sim/kernel": ["sim/base"],
    "sim/transports": ["sim/kernel"],
    "sim/rig": ["sim/transports", "option_boards/boards", "motor_model/inverter"],
    "sim/masters": ["sim/transports", "option_boards/modbus", "option_boards/canopen", "option_boards/ethernet_ip"],
    "sim/scenario": ["sim/rig", "sim/masters"],
    "sim/campaign": ["sim/scenario"],
    "motor_model/port": ["sim/base"],
    "motor_model/plant": ["sim/base"],
    "motor_model/drive": ["motor_model/port", "sim/base"],
    "motor_model/families": ["motor_model/port", "sim/base"],
    "motor_model/inverter": ["motor_model/drive", "motor_model/plant", "motor_model/families"],
    "option_boards/modbus": ["sim/base"],
    "option_boards/canopen": ["sim/base"],
    "option_boards/cip": ["sim/base"],
    "option_boards/cip/profile": ["option_boards/cip", "motor_model/port"],
    "option_boards/devicenet": ["option_boards/cip"],
    "option_boards/ethernet_ip": ["option_boards/cip"],
    "option_boards/componet": ["option_boards/cip"],
    "option_boards/fins": ["option_boards/componet"],
    "option_boards/boards": ["option_boards/*", "motor_model/port", "sim/base"],
    "tools/panel": ["sim/campaign"],
    "tools/vinverter": ["tools/panel"],
}
# Tools that are not in the chain above, and the tests, see everything; nothing includes them.
SEE_EVERYTHING = ("tests", "tools")

CODE = (".cpp", ".hpp", ".h", ".cc", ".c")
TEXT = CODE + (".py", ".sh", ".js", ".mjs", ".cmake", ".txt", ".md", ".yaml", ".yml", ".json", ".csv", "")
SKIPPED_DIRS = {"build", ".git", "node_modules", "__pycache__", "corpus"}

# Engines and models: no input or output, no clock, no threads. C++ time types are values and fine.
ENGINE_PARTS = ("sim/base", "motor_model", "option_boards")
OS_HEADER = re.compile(
    r"^(asio([./].*)?|boost/.*|sys/.*|netinet/.*|arpa/.*|net/.*|linux/.*|unistd\.h|fcntl\.h|poll\.h|termios\.h|pty\.h|"
    r"pthread\.h|signal\.h|csignal|netdb\.h|ifaddrs\.h|time\.h|ctime|thread|mutex|shared_mutex|condition_variable|future|"
    r"semaphore|stop_token|barrier|latch|fstream|iostream|filesystem|pcap.*|modbus.*)$")
CLOCK = re.compile(
    r"\b(steady_clock|system_clock|high_resolution_clock|gettimeofday|clock_gettime|sleep_for|sleep_until|usleep|nanosleep|"
    r"random_device|getenv)\b|\bstd::(rand|time|clock)\b")
CONSOLE_OR_FILE = re.compile(r"\bstd::c(out|err|log|in)\b|\b(v?f?printf|f?puts|putchar|fopen|fwrite|popen|system)\(")
PRINTS = ("sim/base/check.cpp",)  # the last words of a broken invariant
SUNDIALS_HEADER = re.compile(
    r"^(sundials|cvodes?|arkode|idas?|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol|sunmemory)/")
SOLVER_SOURCE = re.compile(r"^motor_model/plant/solver/([^/]+\.cpp|sundials_[^/]+\.hpp)$")
THIRD_PARTY_FREE = "sim/base"  # standard library only

# Spelled with a class each, so that this file does not contain what it looks for.
UNFINISHED = re.compile(r"\b(TO[D]O|FIX[M]E|X[X]X|HAC[K]|[Ww][Ii][Pp]|not implemente[d]|unimplemente[d])\b|GTEST_SKI[P]|\bDISABLE[D]_")
PLACEHOLDER = re.compile(r"\bplace[h]older\b", re.IGNORECASE)
OUTSIDE = re.compile(r"(?<![\w.$}/*])/(work|farm|Users|root)/\w|\.\./share[d]|/tm[p]/wt\b|"
                     r"\b(registry\.(npmjs|yarnpkg)|pypi\.or[g]|deb\.debian\.or[g]|crates\.i[o])\b")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^">]+)[">]')
TEST_NAME = re.compile(r"^\s*(?:TEST|TEST_F|TEST_P|TYPED_TEST)\(\s*(\w+)\s*,\s*(\w+)\s*\)")
FAMILY_BRANCH = re.compile(r'\bfamily\w*(?:\(\))?\s*[!=]=\s*"|"\s*[!=]=\s*\w*family\b|'
                           r'[!=]=\s*"(?:fr|oi)-|"(?:fr|oi)-[\w-]+"\s*[!=]=')
FAMILY_BLIND = ("sim", "motor_model/drive", "motor_model/plant", "motor_model/port", "option_boards")
# Masters and clients that judge the product from outside.
STRANGERS = ("tests/conformance/", "tests/support/")
KNOWN_TO_STRANGERS = ("tests/", "sim/base/")
LINK = re.compile(r"\]\(([^)\s]+)\)")


def part_of(path):
    """The longest known part that the path lies in; for a tool or test outside the chain its top folder."""
    best = ""
    for part in ARROWS:
        if path.startswith(part + "/") and len(part) > len(best):
            best = part
    return best or path.split("/")[0]


def reachable(part):
    seen, todo = set(), [part]
    while todo:
        for target in ARROWS.get(todo.pop(), []):
            matches = [p for p in ARROWS if p.startswith(target[:-1]) and p != "option_boards/boards"] \
                if target.endswith("/*") else [target]
            todo += [p for p in matches if p not in seen]
            seen.update(matches)
    return seen


def board_of(path):
    """The folder of one board, or None: two boards never include each other."""
    pieces = path.split("/")
    return pieces[2] if pieces[:2] == ["option_boards", "boards"] and len(pieces) > 3 else None


def check_include(path, system, header, files):
    part = part_of(path)
    engine = path.startswith(tuple(p + "/" for p in ENGINE_PARTS))
    if system or header not in files:
        if SUNDIALS_HEADER.match(header) and not SOLVER_SOURCE.match(path):
            yield "sundials", f"{header}: only sources and sundials_*.hpp in motor_model/plant/solver include SUNDIALS"
        if engine and OS_HEADER.match(header):
            yield "os", f"{header}: engines and models have no sockets, files, threads or clocks"
        if part == THIRD_PARTY_FREE and system and not re.match(r"^[a-z_]+$", header):
            yield "base", f"{header}: sim/base includes the standard library only"
        near = os.path.dirname(path) + "/" + header in files  # the tests' own benches may be named so
        if not system and ("/" in header or near and part != "tests"):
            yield "include", f"{header}: write the path from the root of the repository, of a file that exists"
        return
    target = part_of(header)
    if path.startswith(STRANGERS) and not header.startswith(KNOWN_TO_STRANGERS):
        yield "stranger", f"{header}: what judges the product from outside shares no code with it"
    if part.split("/")[0] == "tests" or (part in SEE_EVERYTHING and path.startswith("tools/")):
        return
    if target != part and target not in reachable(part):
        yield "arrow", f"{part} may not include {header}"
    if board_of(header) and board_of(path) and board_of(header) != board_of(path):
        yield "arrow", f"board {board_of(path)} may not include board {board_of(header)}"


def strip_comments(line):
    return re.sub(r"//.*", "", line)


def check_code(path, lines, files):
    engine = path.startswith(tuple(p + "/" for p in ENGINE_PARTS))
    if path.endswith(".hpp") and not any(line.strip() == "#pragma once" for line in lines):
        yield 1, "guard", "a header starts with #pragma once"
    for number, line in enumerate(lines, 1):
        include = INCLUDE.match(line)
        if include:
            for rule, text in check_include(path, include.group(1) == "<", include.group(2), files):
                yield number, rule, text
            continue
        code = strip_comments(line)
        if engine and (clock := CLOCK.search(code)):
            yield number, "clock", f"{clock.group(0)}: time and chance are arguments here"
        if engine and path not in PRINTS and (words := CONSOLE_OR_FILE.search(code)):
            yield number, "console", f"{words.group(0)}: engines and models neither print nor open files"
        if path.startswith(tuple(p + "/" for p in FAMILY_BLIND)) and FAMILY_BRANCH.search(code):
            yield number, "family", "shared code does not ask which family it serves"
        test = TEST_NAME.match(line)
        if test and "_" in test.group(1) + test.group(2):
            yield number, "test-name", f"{test.group(1)}.{test.group(2)}: no underscores"


def check_text(path, lines, files):
    for number, line in enumerate(lines, 1):
        if found := UNFINISHED.search(line):
            yield number, "unfinished", found.group(0)
        if path.endswith(CODE) and (found := PLACEHOLDER.search(line)):
            yield number, "unfinished", found.group(0)
        if found := OUTSIDE.search(line):
            yield number, "outside", f"{found.group(0)}: a path that exists on no user's machine"
        if path.endswith(".md"):
            for link in LINK.findall(line):
                target = link.split("#")[0]
                if not target or re.match(r"^[a-z]+:", target):
                    continue
                resolved = os.path.normpath(os.path.join(os.path.dirname(path), target))
                if resolved not in files and not any(f.startswith(resolved + "/") for f in files):
                    yield number, "link", f"{link}: no such file"


def list_files(root):
    found = set()
    for folder, dirs, names in os.walk(root):  # .git is a file in a linked work tree
        dirs[:] = [d for d in dirs if d not in SKIPPED_DIRS]
        for name in set(names) - SKIPPED_DIRS:
            found.add(os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/"))
    return found


def check_tree(root):
    files = list_files(root)
    for path in sorted(files):
        if os.path.splitext(path)[1] not in TEXT or path == "LICENSE":
            continue
        try:
            with open(os.path.join(root, path), encoding="utf-8") as f:
                lines = f.read().splitlines()
        except UnicodeDecodeError:
            yield path, 1, "encoding", "not UTF-8"
            continue
        if path.endswith(CODE):
            yield from ((path, *finding) for finding in check_code(path, lines, files))
        yield from ((path, *finding) for finding in check_text(path, lines, files))


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    findings = list(check_tree(root))
    for path, number, rule, text in findings:
        print(f"{path}:{number}: [{rule}] {text}")
    print(f"tidy: {len(list_files(root))} files, {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
