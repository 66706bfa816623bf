#!/usr/bin/env python3
"""Writes the support tables of the user pages from the data files that the program itself uses; what is behaviour and
no table of the program (services of a board) has a data file beside the page.

A page says where a table goes:

    <!-- support-table: oi-fr-e5nco-registers -->
    ... generated lines ...
    <!-- end support-table -->

usage: support_table.py [--check] [--root FOLDER]
  --check   change nothing; exit 1 if a page is behind its data file

Either way exit 1 if a row names a test that does not exist, or a row that must be proven names none: every register,
object, emergency code, service, alarm and terminal function, and every parameter that acts; its test must mention it. A parameter that does not act says
why ("Nothing: ...").
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


def parameter_writable(row):
    if row.get("access") == "RO" or row.get("kind") == "manufacturer":
        return "never"
    running = row.get("write_while_running")
    if running == "yes":
        text = "stopped and running"
    elif row.get("write_while_running_pr77_2") == "yes":
        text = "stopped; running with Pr.77 = 2"
    else:
        text = "stopped"
    if running == "unknown":
        text += " (with 0 not known)"
    if row.get("write_when_locked") == "yes":
        text += "; with Pr.77 = 1 too"
    return text


def parameter_default(row):
    """Rules of the data file as words: "kw<=3.7:5 kw<=7.5:10" is "5 (to 3.7 kW), 10 (to 7.5 kW)"."""
    rule = row.get("model_default") or ""
    if rule == "rated_current":
        return "rated current of the model"
    rule = rule.replace("rated*0.85", "85 % of the rated current").replace(":rated", ":rated current")
    parts = re.findall(r"(kw|volt)<=([\d.]+):(.+?)(?= kw<=| volt<=|$)", rule)
    words = {"kw": "{} (to {} kW)", "volt": "{} ({} V class)"}
    return ", ".join(words[what].format(value, limit) for what, limit, value in parts) or row["default"]


def parameter_step(row):
    fine = re.fullmatch(r"(\d+)=(\d+):([\d.]+)", row.get("fine_increment") or "")
    return row["increment"] + (f"; {fine[3]} with Pr.{fine[1]} = {fine[2]}" if fine else "")


def parameter_clear(row):
    return {"": "both", "all_only": "ALLC only", "never": "none"}[row.get("clear") or ""]


def alarm_retry(row):
    return (row.get("retry_pr65") or "").replace("|", ", ") or "no"


def alarm_reset(row):
    return {"any": "any", "power": "power cycle only"}.get(row.get("reset") or "", "")


def cip_object(row):
    attribute = row["attribute"] + (f" to {row['last_attribute']}" if row["last_attribute"] else "")
    return f"{row['class']} / {row['instance']} / {attribute}"


def cip_service(row):
    classes = row["class"] + (f" to {row['last_class']}" if row["last_class"] else "")
    return f"{classes} / {row['instance']}: {row['service']}"


def produced_problems(row, tests):
    if row["produced"] == "yes":
        return must_have_test(column("code"))(row, tests)
    problems = [] if row["here"].startswith("Nothing: ") else [f"{row['code']} is not produced and does not say why"]
    return problems + ([f"{row['code']} is not produced but names a test"] if tests_of(row) else [])


def column(name):
    return lambda row: row.get(name) or ""


def tests_of(row):
    return (row.get("test") or "").split()


def tests_column(row):
    return ", ".join(f"`{test}`" for test in tests_of(row))


def must_have_test(label):
    return lambda row, tests: [] if tests_of(row) else [f"{label(row)} names no test"]


def register_problems(row, tests):
    return must_have_test(register_address)(row, tests)


def alarm_problems(row, tests):
    return [] if row["name"] == "none" else must_have_test(column("name"))(row, tests)


def parameter_problems(row, tests):
    label = parameter_number(row)
    if row.get("acts") == "no":
        idle = (row.get("effect") or "").startswith("Nothing: ")
        return ([] if idle else [f"{label} does not act and does not say why"]) + \
            ([f"{label} does not act but names a test"] if tests_of(row) else [])
    problems = must_have_test(parameter_number)(row, tests)
    mention = re.compile(rf"Pr\.?{row['pr']}(?!\d)|[(\[]{row['pr']}[,)\]]")
    problems += [f"{label}: {test} does not mention it" for test in tests_of(row)
                 if test in tests and not mention.search(tests[test])]
    return problems


def terminal_problems(row, tests):
    if row.get("acts") == "no":
        return [] if row["notes"].startswith("Nothing: ") else [f"{row['signal']} does not act and does not say why"]
    return must_have_test(lambda r: f"{r['direction']} {r['signal']}")(row, tests)


def terminal_settings(row):
    return ", ".join(part for part in [row["number"], row.get("number_negative_logic")] if part)


def cip_place(prefix):
    def place(row):
        parts = [row.get(f"{prefix}_{part}") or "" for part in ("class", "instance", "attribute")]
        return "/".join(parts) if all(parts) else ""
    return place


# marker: (data file, [(heading, text of a row)], what is wrong with a row besides unknown tests)
TABLES = {
    "oi-fr-e5nco-registers": (
        "option_boards/boards/oi_fr_e5nco/registers.csv",
        [("Address", register_address), ("What", column("name")), ("Access", register_access),
         ("Value", register_range), ("Manual section", column("section")), ("Confidence", column("confidence")),
         ("Notes", column("notes")), ("Test", tests_column)], register_problems),
    "oi-fr-e5nco-objects": (
        "option_boards/boards/oi_fr_e5nco/objects.csv",
        [("Object", object_address), ("What", column("name")), ("Type", column("type")), ("Access", column("access")),
         ("PDO", object_pdo), ("Default", column("default")), ("Range", object_range),
         ("Manual section", column("section")), ("Confidence", column("confidence")), ("Notes", column("notes")),
         ("Test", tests_column)], must_have_test(object_address)),
    "oi-fr-e5nco-emergencies": (
        "option_boards/boards/oi_fr_e5nco/emergency_codes.csv",
        [("Alarm", column("alarm")), ("Data code (byte 4)", lambda row: row["data_code_hex"] + "H"),
         ("Error code", lambda row: row["error_code_hex"] + "H"),
         ("Error register", lambda row: row["error_register_hex"] + "H"), ("Manual section", column("section")),
         ("Confidence", column("confidence")), ("Test", tests_column)], must_have_test(column("alarm"))),
    "oi-fr-e5nco-services": (
        "docs/boards/oi-fr-e5nco-services.csv",
        [("Manual section", column("section")), ("Service", column("service")), ("Here", column("behaviour")),
         ("Confidence", column("confidence")), ("Test", tests_column)], must_have_test(column("service"))),
    "fr-a7ne-objects": (
        "option_boards/boards/fr_a7ne/objects.csv",
        [("Class / instance / attribute", cip_object), ("What", column("name")), ("Type", column("type")),
         ("Access", column("access")), ("Value", column("default")), ("Range", object_range),
         ("Manual section", column("section")), ("Confidence", column("confidence")), ("Notes", column("notes")),
         ("Test", tests_column)], must_have_test(cip_object)),
    "fr-a7ne-services": (
        "option_boards/boards/fr_a7ne/services.csv",
        [("Class / instance: service", cip_service), ("Name", column("name")), ("Manual section", column("section")),
         ("Confidence", column("confidence")), ("Notes", column("notes")), ("Test", tests_column)],
        must_have_test(cip_service)),
    "fr-a7ne-error-codes": (
        "docs/boards/fr-a7ne-error-codes.csv",
        [("Code", column("code")), ("Name", column("name")), ("Here", column("here")), ("Test", tests_column)],
        produced_problems),
    "fr-e500-parameters": (
        "motor_model/families/mitsubishi_e500/parameters.csv",
        [("Parameter", parameter_number), ("Name", column("name")), ("Range", parameter_range),
         ("Step", parameter_step), ("Unit", column("unit")), ("Default", parameter_default),
         ("Writable", parameter_writable), ("Cleared by", parameter_clear),
         ("Modbus address", column("modbus_address")), ("Source", column("source")),
         ("Confidence", column("confidence")), ("Acts", column("acts")), ("What it does here", column("effect")),
         ("Test", tests_column)], parameter_problems),
    "fr-e500-alarms": (
        "motor_model/families/mitsubishi_e500/alarms.csv",
        [("Alarm", column("name")), ("Code (hex)", column("data_code_hex")), ("Cause", column("cause")),
         ("Retried with Pr.65", alarm_retry), ("Reset", alarm_reset), ("Source", column("source")),
         ("Confidence", column("confidence")), ("Notes", column("notes")), ("Test", tests_column)], alarm_problems),
    "fr-a700-parameters": (
        "motor_model/families/mitsubishi_a700/parameters.csv",
        [("Parameter", parameter_number), ("Panel", column("alias")), ("Name", column("name")),
         ("Range", parameter_range), ("Step", parameter_step), ("Unit", column("unit")), ("Default", parameter_default),
         ("Writable", parameter_writable), ("Network", column("network_access")), ("Cleared by", parameter_clear),
         ("CIP", cip_place("cip")), ("CIP, extended III", cip_place("ext3")), ("Source", column("source")),
         ("Confidence", column("confidence")), ("Acts", column("acts")), ("What it does here", column("effect")),
         ("Test", tests_column)], parameter_problems),
    "fr-a700-alarms": (
        "motor_model/families/mitsubishi_a700/alarms.csv",
        [("Alarm", column("name")), ("Code (hex)", column("data_code_hex")), ("Display", column("display")),
         ("Cause", column("cause")), ("Retried with Pr.65", alarm_retry), ("Reset", alarm_reset),
         ("Source", column("source")), ("Confidence", column("confidence")), ("Notes", column("notes")),
         ("Test", tests_column)], alarm_problems),
    "fr-a700-terminals": (
        "motor_model/families/mitsubishi_a700/terminals.csv",
        [("Direction", column("direction")), ("Parameters", column("parameters")), ("Setting", terminal_settings),
         ("Signal", column("signal")), ("Meaning", column("meaning")), ("Default of", column("default_of")),
         ("Source", column("source")), ("Confidence", column("confidence")), ("Acts", column("acts")),
         ("Notes", column("notes")), ("Test", tests_column)], terminal_problems),
    "fr-a700-monitors": (
        "motor_model/families/mitsubishi_a700/monitors.csv",
        [("Code", column("code")), ("Monitor", column("name")), ("Unit", column("unit")),
         ("Increment", column("increment")), ("Bits", column("bits")), ("0x80", column("object_0x80_attribute")),
         ("0x2A", column("object_0x2a_attribute")), ("Source", column("source")), ("Notes", column("notes")),
         ("Test", tests_column)], must_have_test(column("name"))),
    "fr-e500-terminals": (
        "motor_model/families/mitsubishi_e500/terminals.csv",
        [("Direction", column("direction")), ("Parameters", column("parameters")), ("Setting", column("number")),
         ("Signal", column("signal")), ("Meaning", column("meaning")), ("Default of", column("default_of")),
         ("Source", column("source")), ("Confidence", column("confidence")), ("Notes", column("notes")),
         ("Test", tests_column)], must_have_test(lambda row: f"{row['direction']} {row['signal']}")),
}

SECTION = re.compile(r"(<!-- support-table: (?P<name>[\w-]+) -->\n)(?P<body>.*?)(<!-- end support-table -->)", re.DOTALL)
# To the brace that closes it: on the same line, or alone in the first column.
TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)(?: *\{[^\n]*\}$|.*?^\})", re.DOTALL | re.MULTILINE)


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
    """Suite.Name of every GoogleTest: its text."""
    return {f"{match[1]}.{match[2]}": match[0]
            for source in sorted((root / "tests").rglob("*.cpp"))
            for match in TEST.finditer(source.read_text(encoding="utf-8"))}


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
        data, columns, problems_of = TABLES[name]
        if not (args.root / data).exists():
            return match[1] + match[4]
        rows = read_rows(args.root / data)
        for row in rows:
            problems.extend(f"{data}: no test is named {test}" for test in tests_of(row) if test not in tests)
            problems.extend(f"{data}: {problem}" for problem in problems_of(row, tests))
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
