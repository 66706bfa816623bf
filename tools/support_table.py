#!/usr/bin/env python3
"""Writes the support tables of the user pages from the data files that the program itself uses.

A page says where a table goes:

    <!-- support-table: oi-fr-e5nco-registers -->
    ... generated lines ...
    <!-- end support-table -->

usage: support_table.py [--check] [--root FOLDER]
  --check   change nothing; exit 1 if a page is behind its data file, or a row names a test that does not exist
"""
import argparse
import csv
import re
import sys
from pathlib import Path


def register_address(row):
    return row["first"] if row["first"] == row["last"] else f"{row['first']}-{row['last']}"


def register_access(row):
    return {"R": "read", "W": "write", "RW": "read, write", "-": "none (exception 02)"}[row["access"]]


def register_range(row):
    if "W" not in row["access"]:
        return f"{row['value']}H" if row["value"] else ""
    return row["min"] if row["min"] == row["max"] else f"{row['min']}-{row['max']}"


def object_address(row):
    index = row["first"] + (f"H-{row['last']}H" if row["last"] else "H")
    subs = row["sub_first"] + (f"-{row['sub_last']}" if row["sub_last"] else "")
    return f"{index}:{subs}"


def object_pdo(row):
    return {"": "", "r": "RPDO", "t": "TPDO", "rt": "both"}[row["pdo"]]


def object_range(row):
    return f"{row['min']}-{row['max']}" if row["min"] or row["max"] else ""


def parameter_number(row):
    sub = int(row.get("sub") or 0)
    return f"Pr.{row['pr']}" + (f" ({sub})" if sub else "")


def parameter_range(row):
    allowed = row.get("allowed") or (f"{row['min']}-{row['max']}" if row["min"] or row["max"] else "")
    return ", ".join(part for part in [allowed, *(row.get("special") or "").split("|")] if part)


def column(name):
    return lambda row: row.get(name) or ""


# marker: (data file, [(heading, text of a row)])
TABLES = {
    "oi-fr-e5nco-registers": (
        "option_boards/boards/oi_fr_e5nco/registers.csv",
        [("Address", register_address), ("What", column("name")), ("Access", register_access),
         ("Value", register_range), ("Manual section", column("section")), ("Confidence", column("confidence")),
         ("Notes", column("notes")), ("Test", lambda row: f"`{row['test']}`")]),
    "oi-fr-e5nco-objects": (
        "option_boards/boards/oi_fr_e5nco/objects.csv",
        [("Object", object_address), ("What", column("name")), ("Type", column("type")), ("Access", column("access")),
         ("PDO", object_pdo), ("Default", column("default")), ("Range", object_range),
         ("Manual section", column("section")), ("Confidence", column("confidence")), ("Notes", column("notes")),
         ("Test", lambda row: f"`{row['test']}`" if row["test"] else "")]),
    "oi-fr-e5nco-emergencies": (
        "option_boards/boards/oi_fr_e5nco/emergency_codes.csv",
        [("Alarm", column("alarm")), ("Data code (byte 4)", lambda row: row["data_code_hex"] + "H"),
         ("Error code", lambda row: row["error_code_hex"] + "H"),
         ("Error register", lambda row: row["error_register_hex"] + "H"), ("Manual section", column("section")),
         ("Confidence", column("confidence"))]),
    "fr-e500-parameters": (
        "motor_model/families/mitsubishi_e500/parameters.csv",
        [("Parameter", parameter_number), ("Name", column("name")), ("Range", parameter_range),
         ("Step", column("increment")), ("Unit", column("unit")), ("Default", column("default")),
         ("Modbus address", column("modbus_address")), ("Source", column("source")),
         ("Confidence", column("confidence")), ("Acts", column("acts")), ("What it does here", column("effect")),
         ("Test", lambda row: f"`{row['test']}`" if row.get("test") else "")]),
}

SECTION = re.compile(r"(<!-- support-table: (?P<name>[\w-]+) -->\n)(?P<body>.*?)(<!-- end support-table -->)", re.DOTALL)
TEST_NAME = re.compile(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)")


def cell(text):
    return text.strip().replace("|", "\\|")


def make_table(rows, columns):
    # A column that no row fills is left out.
    columns = [(heading, text) for heading, text in columns if any(text(row) for row in rows)]
    lines = ["| " + " | ".join(heading for heading, _ in columns) + " |", "|" + " --- |" * len(columns)]
    lines += ["| " + " | ".join(cell(text(row)) for _, text in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def read_rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def known_tests(root):
    names = set()
    for source in (root / "tests").rglob("*.cpp"):
        names.update(".".join(match) for match in TEST_NAME.findall(source.read_text(encoding="utf-8")))
    return names


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing, exit 1 if something is behind")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parent.parent)
    args = parser.parse_args()
    problems = []
    tests = known_tests(args.root)
    found = set()

    def section(match):
        name = match["name"]
        found.add(name)
        if name not in TABLES:
            problems.append(f"{page}: unknown table {name}; known: {', '.join(TABLES)}")
            return match[0]
        data, columns = TABLES[name]
        if not (args.root / data).exists():
            return match[1] + match[4]
        rows = read_rows(args.root / data)
        for row in rows:
            for test in filter(None, [row.get("test")]):
                if test not in tests:
                    problems.append(f"{data}: no test is named {test}")
        return match[1] + "\n" + make_table(rows, columns) + "\n" + match[4]

    for page in sorted((args.root / "docs").rglob("*.md")):
        old = page.read_text(encoding="utf-8")
        new = SECTION.sub(section, old)
        if new == old:
            continue
        if args.check:
            problems.append(f"{page.relative_to(args.root)} is behind its data; run tools/support_table.py")
        else:
            page.write_text(new, encoding="utf-8")
    problems += [f"no page has the table {name}" for name in TABLES
                 if name not in found and (args.root / TABLES[name][0]).exists()]
    for problem in sorted(set(problems)):
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
