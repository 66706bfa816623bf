"""The whole story of a node on CANopen with python-can: find, configure, map, run, trip, reset, run again.

Usage: canopen_story.py socketcand|slcan
Over slcan, which has remote frames, with node guarding and requested PDOs as well.
"""
import sys

from canopen_master import Node, PRE_OPERATIONAL
from canopen_plant import CanPlant, HEAVY
import canopen_steps as steps
from canopen_steps import is_about


def one_node(line, node, plant, drive, tolerance):
    steps.boots(line, node, plant, drive)
    steps.is_refused_outside_net(node)
    told = steps.watches(node)
    steps.goes_operational(node)
    steps.sets_ramps(node, up_s=2.0, down_s=1.0)
    assert is_about(steps.runs_by_pdo(line, node, told, seconds_to_reference=2.0), 1, tolerance)
    assert is_about(steps.trips(line, node, told), steps.EMERGENCY_DELAY, 10 * tolerance)
    steps.coasts_down(plant, drive)
    steps.is_reset(line, node)
    steps.goes_operational(node)
    for slope in steps.runs_by_velocity_mode(line, node, told, rpm=900, up_s=2, quick_stop_s=3):
        assert is_about(slope, 1, tolerance)
    steps.leaves_net(line, node)


def guarded_nodes(line, nodes, tolerance):
    for node in nodes:
        steps.guards(node)
        steps.answers_remote_frames(line, node)
        node.nmt(PRE_OPERATIONAL)
    by_option = dict(zip((0, 2, 3), nodes))
    watched, since = steps.stops_when_guarding_ends(line, by_option)
    assert is_about(steps.reactions_to_lost_guarding(line, by_option, watched, since), 1, tolerance)
    assert is_about(steps.life_time(line, nodes[0]), 1, 2 * tolerance)


def main():
    interface = sys.argv[1]
    numbers = [5] if interface == "socketcand" else [5, 6, 7]
    # socketcand's times are those of the bus, slcan has only those of arrival.
    tolerance = {"socketcand": 0.05, "slcan": 0.1}[interface]
    with CanPlant(numbers, inertia=HEAVY) as plant:
        with plant.line(interface) as line:
            nodes = [Node(line, number) for number in numbers]
            if line.remote_frames:
                guarded_nodes(line, nodes, tolerance)
            one_node(line, nodes[0], plant, plant.first, tolerance)


if __name__ == "__main__":
    main()
