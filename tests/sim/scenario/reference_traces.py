#!/usr/bin/env python3
"""The tables that scenarios/reference follows are the independent trajectories in the signals' own units.

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
    "dc_link V": lambda row: float(row["Vdc_V"]),
}
# Table: (trajectory, time from and to in s, every nth row, columns). Times begin anew at 0.
TABLES = {
    "b_ramp_with_fan": ("b_vf_ramp_fan_2k2", 0, 6, 2, ["speed rpm", "torque Nm", "output_current A"]),
    "c_load_step": ("c_load_step_2k2", 0.1, 1, 2, ["speed rpm", "torque Nm", "output_current A"]),
    "d_stop_into_the_link": ("d_decel_overvoltage_2k2", 0.1, 0.16, 1,
                             ["speed rpm", "torque Nm", "output_current A", "dc_link V"]),
    "e1_locked_rotor_full_voltage": ("e1_locked_rotor_dol_2k2", 0, 0.5, 1, ["torque Nm", "output_current A"]),
    "e2_locked_rotor_5_hz": ("e2_locked_rotor_vf5hz_2k2", 0, 2, 2, ["torque Nm", "output_current A"]),
}


def table(name):
    trajectory, begin, end, every, columns = TABLES[name]
    with gzip.open(SOURCE / f"{trajectory}.csv.gz", "rt", encoding="utf-8") as f:
        rows = list(csv.DictReader(line for line in f if not line.startswith("#")))
    rows = [r for r in rows if begin - 1e-9 <= float(r["t_s"]) <= end + 1e-9]
    if rows[0]["t_s"] and abs(float(rows[0]["t_s"]) - begin) > 1e-9:
        raise SystemExit(f"{trajectory} has no row at {begin} s")
    out = [f"# {trajectory} from {begin} s on; speed, air-gap torque and current (rms) of the motor",
           ",".join(["time_s", *columns])]
    for row in rows[::every]:
        values = [f"{COLUMNS[c](row):.6g}" for c in columns]
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
