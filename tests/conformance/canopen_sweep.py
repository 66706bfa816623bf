"""The whole dictionary over SDO, driven by the object table: every object and sub-index is read and written in its range,
out of it, in wrong lengths, and asked for a sub-index that it does not have. Abort codes: OI-FR-E5NCO manual, 6.1.

The dictionary is dealt out to several nodes on buses of their own, which go through it side by side.
"""
import concurrent.futures
import csv
import os

from canopen_master import Line, Node
from plant import HERE, Plant
import canopen_steps as steps

ROOT = os.path.join(HERE, "..", "..")
SIZES = {"INTEGER8": 1, "INTEGER16": 2, "UNSIGNED8": 1, "UNSIGNED16": 2, "UNSIGNED32": 4, "VISIBLE_STRING": 4}
READ_OF_WRITE_ONLY, WRITE_OF_READ_ONLY, NO_OBJECT, WRONG_LENGTH, NO_SUB_INDEX, OUT_OF_RANGE, NOT_NOW = (
    0x06010001, 0x06010002, 0x06020000, 0x06070010, 0x06090011, 0x06090030, 0x08000022)
WORKERS = 4

PLANT = """
name: sweep
networks:
{networks}
drives:
{drives}
"""
NETWORK = '  can{n}: {{can: virtual, bitrate: 1M, socketcand: "127.0.0.1:0", channel: can{n}}}'
DRIVE = """
  - name: d{n}
    inverter: {{family: fr-e500, model: FR-E540-1.5K}}
    board: {{type: oi-fr-e5nco, node: 5, network: can{n}, modbus_rtu: none, modbus_tcp: none}}
    parameters: {{Pr.346: 1}}
"""


def table(path):
    with open(os.path.join(ROOT, path), newline="", encoding="utf-8") as f:
        return list(csv.DictReader(f))


def parameters():
    """(number, sub-index as in the table) to its row."""
    rows = table("motor_model/families/mitsubishi_e500/parameters.csv")
    return {(int(r["pr"]), int(r["sub"])): r for r in rows}


def objects():
    """(index, sub-index, row) for every one that the family has; indices without a parameter come as (index, None, row)."""
    known = {number for number, _ in parameters()}
    for row in table("option_boards/boards/oi_fr_e5nco/objects.csv"):
        first, last = int(row["first"], 16), int(row["last"] or row["first"], 16)
        subs = range(int(row["sub_first"]), int(row["sub_last"] or row["sub_first"]) + 1)
        for index in range(first, last + 1):
            missing = 0x3000 <= index <= 0x33E7 and index - 0x3000 not in known
            for sub in subs:
                yield index, (None if missing else sub), row


def refused_values(row, parameter):
    """Values of the right length that the object must refuse as out of range."""
    values = []
    size = SIZES[row["type"]]
    if parameter:
        if parameter["max"] and parameter["kind"] == "ordinary":
            increment, top = float(parameter["increment"]), float(parameter["max"])
            if round(top / increment) + 1 < 0xFFF0:
                values.append(round(top / increment) + 1)
            if float(parameter["min"]) > 0:
                values.append(round(float(parameter["min"]) / increment) - 1)
        return values
    limit = 1 << 8 * size - (row["type"].startswith("INTEGER"))
    if row["max"] and int(row["max"]) + 1 < limit:
        values.append(int(row["max"]) + 1)
    if row["min"] and (int(row["min"]) > 0 or row["type"].startswith("INTEGER")):
        values.append(int(row["min"]) - 1)
    return values


def valid_pdo(index, sub):
    """What cannot be changed while the PDO exists, as RPDO1 and TPDO1 do from the start: mapping and inhibit time."""
    return index in (0x1600, 0x1A00) or (index, sub) == (0x1800, 3)


class Sweep:
    def __init__(self, node):
        self.node = node
        self.tried = {"read": 0, "written": 0, "out of range": 0, "read-only": 0, "wrong length": 0, "no sub-index": 0,
                      "no object": 0}

    def refused(self, kind, code, call, *arguments):
        self.tried[kind] += 1
        self.node.expect_abort(code, call, *arguments)

    def visit(self, index, sub, row, parameter, last_sub):
        node, size = self.node, SIZES[row["type"]]
        if sub is None:
            self.refused("no object", NO_OBJECT, node.read, index, 0)
            self.refused("no object", NO_OBJECT, node.write, index, 0, 0, size)
            return
        value = None
        if row["access"] == "WO":
            self.refused("read", READ_OF_WRITE_ONLY, node.read, index, sub)
        else:
            data = node.read_bytes(index, sub)
            assert len(data) == size, f"{index:04X}:{sub} is {data}, expected {size} bytes"
            value = int.from_bytes(data, "little")
            self.tried["read"] += 1
        if row["access"] == "RO":
            self.refused("read-only", WRITE_OF_READ_ONLY, node.write, index, sub, 0, size)
        else:
            for wrong in {1, 2, 3, 4} - {size}:
                self.refused("wrong length", WRONG_LENGTH, node.write, index, sub, 0, wrong)
            for wrong in refused_values(row, parameter):
                self.refused("out of range", OUT_OF_RANGE, node.write, index, sub, wrong, size)
            self.write_back(index, sub, row, parameter, value, size)
        if sub == last_sub:
            self.refused("no sub-index", NO_SUB_INDEX, node.read, index, sub + 1)
            self.refused("no sub-index", NO_SUB_INDEX, node.write, index, sub + 1, 0, size)

    def write_back(self, index, sub, row, parameter, value, size):
        node = self.node
        if valid_pdo(index, sub):
            self.refused("written", NOT_NOW, node.write, index, sub, value, size)
            return
        if index in (0x1011, 0x2106, 0x2107) or (parameter and parameter["kind"] != "ordinary"):
            return  # they do something: the end of the sweep and the stories
        if row["access"] == "WO":
            value = {0x6060: 2}.get(index)
            if value is None:
                return
        takes_what_it_shows = index not in (0x4000, 0x4001)
        if not takes_what_it_shows:
            value = 0
        node.write(index, sub, value, size)
        self.tried["written"] += 1
        if row["access"] == "RW" and takes_what_it_shows:
            assert node.read(index, sub) == value, f"{index:04X}:{sub}"


def sweep(plant, worker):
    all_objects = list(objects())
    rows = parameters()
    last_subs = {}
    for index, sub, _ in all_objects:
        last_subs[index] = max(last_subs.get(index, 0), sub or 0)
    with Line.of("socketcand", plant.endpoint(f"d{worker}", "canopen")) as line:
        node = Node(line, 5)
        steps.goes_operational(node)
        work = Sweep(node)
        indices = sorted(last_subs)
        mine = {index for i, index in enumerate(indices) if i % WORKERS == worker}
        for index, sub, row in all_objects:
            if index not in mine:
                continue
            number = index - 0x3000
            parameter = None
            if row["item"] == "parameter" and sub is not None:
                parameter = rows.get((number, sub))
            work.visit(index, sub, row, parameter, last_subs[index])
        return work.tried


def clears_all(plant):
    """1011H takes nothing but "load", and gives the parameters their values as delivered."""
    with Line.of("socketcand", plant.endpoint("d0", "canopen")) as line:
        node = Node(line, 5)
        node.parameter(7, 77)
        node.expect_abort(NOT_NOW, node.write, 0x1011, 0, 0x6C6F6164, 4)
        assert node.read(0x3007) == 77
        node.write(0x1011, 0, int.from_bytes(b"load", "little"), 4)
        assert node.read(0x3007) == 50
        for index in (0x1018, 0x0001, 0x2003, 0x3404, 0x4002, 0x6045, 0xFFFF):
            node.expect_abort(NO_OBJECT, node.read, index)
            node.expect_abort(NO_OBJECT, node.write, index, 0, 0)


def main():
    networks = "\n".join(NETWORK.format(n=n) for n in range(WORKERS))
    drives = "".join(DRIVE.format(n=n) for n in range(WORKERS))
    with Plant(PLANT.format(networks=networks, drives=drives)) as plant:
        with concurrent.futures.ThreadPoolExecutor(WORKERS) as pool:
            results = list(pool.map(lambda worker: sweep(plant, worker), range(WORKERS)))
        total = {kind: sum(result[kind] for result in results) for kind in results[0]}
        print(total)
        assert all(count > 10 for count in total.values()), total
        clears_all(plant)


if __name__ == "__main__":
    main()
