#!/usr/bin/env python3
"""The tables that scenarios/reference follows, and the voltage that one of them is fed with, are the independent
trajectories in the signals' own units.

Compares them; with --write writes them anew.
"""
import csv
import gzip
import math
import pathlib
import sys

ROOT = pathlib.Path(sys.argv[1])
SOURCE = ROOT / "tests/motor_model/plant/data"
TARGET = ROOT / "scenarios/reference/data"

RPM = 30 / math.pi
COLUMNS = {
    "speed rpm": lambda row: float(row["omega_rad_s"]) * RPM,
    "torque Nm": lambda row: float(row["Te_Nm"]),
    "output_current A": lambda row: float(row["is_abs_A"]) / math.sqrt(2),
    "motor_current A": lambda row: math.hypot(*(float(row[c]) for c in current_of(row))) / math.sqrt(2),
    "dc_link V": lambda row: float(row["Vdc_V"]),
    "alpha V": lambda row: float(row["u_alpha_V"]),
    "beta V": lambda row: float(row["u_beta_V"]),
}


def current_of(row):
    return ("isd_A", "isq_A") if "isd_A" in row else ("is_alpha_A", "is_beta_A")


# What a run is fed with has all digits.
DIGITS = {"alpha V": 8, "beta V": 8}
ON_LINE = ["speed rpm", "torque Nm", "motor_current A"]
# Table: (trajectory, time from and to in s, every nth row, columns). Times begin anew at 0.
TABLES = {
    "a1_direct_start_3_hp": ("a1_dol_krause3hp_noload", 0, 0.6, 4, ON_LINE),
    "a2_direct_start_50_hp": ("a2_dol_krause50hp_noload", 0, 1, 2, ON_LINE),
    "b_ramp_with_fan": ("b_vf_ramp_fan_2k2", 0, 6, 2, ["speed rpm", "torque Nm", "output_current A"]),
    "c_load_step": ("c_load_step_2k2", 0.1, 1, 2, ["speed rpm", "torque Nm", "output_current A"]),
    "d_stop_into_the_link": ("d_decel_overvoltage_2k2", 0.1, 0.16, 1,
                             ["speed rpm", "torque Nm", "output_current A", "dc_link V"]),
    "e1_locked_rotor_full_voltage": ("e1_locked_rotor_dol_2k2", 0, 0.5, 1, ["torque Nm", "output_current A"]),
    "e2_locked_rotor_5_hz": ("e2_locked_rotor_vf5hz_2k2", 0, 2, 2, ["torque Nm", "output_current A"]),
    "x0_replayed_voltage": ("x0_motulator_vhz_replay", 0, 1.5, 4, ON_LINE),
    "x0_voltage": ("x0_motulator_vhz_replay", 0, 1.5, 1, ["alpha V", "beta V"]),
}


def table(name):
    trajectory, begin, end, every, columns = TABLES[name]
    with gzip.open(SOURCE / f"{trajectory}.csv.gz", "rt", encoding="utf-8") as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    rows = [r for r in rows if begin - 1e-9 <= float(r["t_s"]) <= end + 1e-9]
    if rows[0]["t_s"] and abs(float(rows[0]["t_s"]) - begin) > 1e-9:
        raise SystemExit(f"{trajectory} has no row at {begin} s")
    content = ("stator voltage vector, phase peak, held until the next row" if "alpha V" in columns
               else "speed, air-gap torque and current (rms) of the motor")
    out = [f"# {trajectory} from {begin} s on; {content}",
           ",".join(["time_s", *columns])]
    for row in rows[::every]:
        values = [f"{COLUMNS[c](row):.{DIGITS.get(c, 6)}g}" for c in columns]
        out.append(",".join([f"{float(row['t_s']) - begin:.6g}", *values]))
    return "\n".join(out) + "\n"


def main():
    wrong = []
    for name in TABLES:
        path = TARGET / f"{name}.csv"
        if "--write" in sys.argv:
            path.write_text(table(name), encoding="utf-8")
        elif path.read_text(encoding="utf-8") != table(name):
            wrong.append(str(path))
    unknown = [str(p) for p in TARGET.glob("*.csv") if p.stem not in TABLES]
    for path in wrong:
        print(f"{path} is not what the trajectory says")
    for path in unknown:
        print(f"{path} has no trajectory")
    return 1 if wrong or unknown else 0


if __name__ == "__main__":
    sys.exit(main())
