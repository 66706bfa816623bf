"""npm st-ethernet-ip goes through the whole of the FR-A7NE: identity, every attribute of the object table by unconnected
messages, Unconnected_Send and class 3, what there is not, and every parameter read, written in range, out of range and
where it is read-only. Status codes: FR-A7NE manual, appendix.
"""
import csv
import os

from eip_masters import (BAD_VALUE, GET, GET_ALL, NO_ATTRIBUTE, NO_CLASS, NO_INSTANCE, NO_SERVICE, NOT_ENOUGH,
                         NOT_SETTABLE, Node, SET, SUCCESS, TOO_MUCH)
from eip_plant import EipPlant
from plant import HERE

ROOT = os.path.join(HERE, "..", "..")
SIZES = {"BOOL": 1, "BYTE": 1, "SINT": 1, "USINT": 1, "INT": 2, "UINT": 2, "WORD": 2, "DINT": 4, "UDINT": 4, "DWORD": 4}


def table(path):
    with open(os.path.join(ROOT, path), newline="", encoding="utf-8") as f:
        return list(csv.DictReader(f))


def number(text):
    return int(text, 0)


def attributes():
    """(class, instance, attribute, row, parameter number or None)"""
    for row in table("option_boards/boards/fr_a7ne/objects.csv"):
        first = number(row["attribute"])
        for attribute in range(first, number(row["last_attribute"] or row["attribute"]) + 1):
            is_parameter = row["binding"] in ("parameter", "calibration", "parameter_of_option")
            pr = (number(row["argument"]) + attribute - first, number(row["detail"] or "0")) if is_parameter else None
            yield number(row["class"]), number(row["instance"]), attribute, row, pr


def identity(m):
    status, data = m.answer(GET_ALL, 1, 1)
    assert status == SUCCESS
    assert data[:8].hex(" ") == "a1 00 02 00 38 00 01 0a", data.hex(" ")
    assert data[14:] == b"\x04A700", data


def read_all(m, known):
    counts = {"read": 0, "not there": 0}
    for class_id, instance, attribute, row, pr in attributes():
        status, data = m.answer(GET, class_id, instance, attribute)
        what = f"{class_id:02X}/{instance}/{attribute} {row['name']}: status {status:02X} {data.hex()}"
        calibrated = row["binding"] == "calibration" and pr and (pr[0], 1) in known
        missing = (row["binding"] == "not_fitted" or "Get" not in row["access"] or
                   (pr is not None and pr not in known and not calibrated))
        if missing:
            assert status == NO_ATTRIBUTE, what
            counts["not there"] += 1
            continue
        assert status == SUCCESS, what
        assert len(data) == SIZES.get(row["type"], len(data)) > 0, what
        counts["read"] += 1
    return counts


def not_there(m):
    for expected, service, path, data in (
            (NO_CLASS, GET, (2, 1, 1), b""), (NO_CLASS, GET, (0x6F, 1, 1), b""), (NO_CLASS, GET, (0x0F, 1, 1), b""),
            (NO_INSTANCE, GET, (0x29, 2, 3), b""), (NO_INSTANCE, GET, (0x04, 22, 3), b""),
            (NO_ATTRIBUTE, GET, (0x2A, 1, 104), b""), (NO_ATTRIBUTE, GET, (0x29, 1, None), b""),
            (NO_SERVICE, 0x06, (0x29, 1, None), b""), (NO_SERVICE, SET, (0x80, 1, 11), b"\0\0"),
            (NO_SERVICE, SET, (0x04, 21, 3), b"\0\0\0\0"), (TOO_MUCH, GET, (0x29, 1, 6), b"\0"),
            (NOT_ENOUGH, SET, (0x66, 1, 17), b"\0"), (TOO_MUCH, SET, (0x66, 1, 17), b"\0\0\0"),
            (NOT_SETTABLE, SET, (0x29, 1, 6), b"\0"), (BAD_VALUE, SET, (0x29, 1, 141), b"\x16")):
        status, _ = m.answer(service, *path, data)
        assert status == expected, f"{service:02X} {path}: {status:02X}, expected {expected:02X}"


def raw_top(row):
    """The greatest raw word of a parameter, if the number of steps fits a word below the special values."""
    if not row["max"] or row["fine_increment"] or "=" in row["max"]:
        return None
    top = round(float(row["max"]) / float(row["increment"]))
    return top if top + 1 < 0xFFF0 else None


def sweep(m, known):
    """By classes 70 to 79, which have all parameters."""
    tried = {"read": 0, "written": 0, "out of range": 0, "read-only": 0}
    read_only = {pr for _, _, _, row, pr in attributes()
                 if pr and (row["access"] == "Get" or row["binding"] == "parameter_of_option")}
    for (pr, sub), row in known.items():
        if not row["ext3_class"] or sub:
            continue
        path = number(row["ext3_class"]), number(row["ext3_instance"]), number(row["ext3_attribute"])
        value = m.get(*path)
        tried["read"] += 1
        if (pr, sub) in read_only or row["network_access"] == "R":
            assert m.set_status(*path, value) == NOT_SETTABLE, pr
            tried["read-only"] += 1
            continue
        if row["kind"] != "ordinary" or row["network_access"] != "RW":
            continue
        if raw_top(row) is not None and not row["allowed"]:
            status = m.set_status(*path, raw_top(row) + 1)
            assert status == BAD_VALUE, f"Pr.{pr} {raw_top(row) + 1}: status {status:02X}"
            tried["out of range"] += 1
        status = m.set_status(*path, value)
        assert status == SUCCESS, f"Pr.{pr} {value}: status {status:02X}"
        assert m.get(*path) == value, pr
        tried["written"] += 1
    return tried


def main():
    known = {(int(r["pr"]), int(r["sub"])): r
             for r in table("motor_model/families/mitsubishi_a700/parameters.csv")}
    with EipPlant(41, [{}], timing="fast") as plant, Node(plant.master) as node:
        for kind in ("plain", "routed", "class3"):
            m = node.explicit(kind, plant.host(), kind)
            identity(m)
            counts = read_all(m, known)
            print(kind, counts)
            assert counts["read"] > 700 and counts["not there"] > 100, counts
            not_there(m)
        tried = sweep(node.explicit("sweep", plant.host()), known)
        print(tried)
        assert tried["written"] > 300 and tried["out of range"] > 200 and tried["read-only"] >= 10, tried
        plant.check_recording(explicit=6 * counts["read"], io=0)


if __name__ == "__main__":
    main()
