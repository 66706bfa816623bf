#!/usr/bin/env python3
"""Runs a command where there is a CAN interface vcan0: here, if this kernel has CAN and we may make one, else in a
user-mode Linux (Debian's user-mode-linux), an ordinary process that boots a kernel on this machine's files.

Usage: in_vcan.py [--here|--uml] [--preload LIBRARY] COMMAND ...        exits with the command's status
As root. Needs iproute2, and for user-mode Linux: user-mode-linux kmod busybox-static. LIBRARY is loaded into the
user-mode kernel: uml_xstate, without which it does not run on some processors.

In a container user-mode Linux needs ptrace (Docker: --cap-add=SYS_PTRACE where the default profile forbids it), and half a
gigabyte of room that may hold code: in /dev/shm (Docker: --shm-size=1g --tmpfs /dev/shm:exec), else in the folder for
temporary files. Where neither this nor CAN in the kernel is to be had the command is not run, and that is a failure.
"""
import os
import shlex
import shutil
import subprocess
import sys
import tempfile

TIME_LIMIT_S = 300
MEMORY_MB = 512

INIT = """#!/bin/sh
{environment}
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/run LANG=C.UTF-8
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t tmpfs tmpfs /run
modules=/usr/lib/uml/modules/$(uname -r)/kernel
for module in net/can/can.ko net/can/can-raw.ko drivers/net/can/dev/can-dev.ko drivers/net/can/vcan.ko; do
  insmod $modules/$module || echo "cannot load $module"
done
ip link set lo up
ip link add dev vcan0 type vcan && ip link set vcan0 up
cd {cwd}
{command}
echo $? > {status}
sync
busybox poweroff -f
"""


def can_run_here():
    made = subprocess.run(["ip", "link", "add", "dev", "vcan0", "type", "vcan"], capture_output=True)
    return made.returncode == 0


def run_here(command):
    try:
        subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)
        return subprocess.run(command, timeout=TIME_LIMIT_S).returncode
    finally:
        subprocess.run(["ip", "link", "del", "vcan0"], capture_output=True)


def folder_for_memory():
    """The user-mode kernel's memory is a file that it maps with the right to execute."""
    for folder in ("/dev/shm", tempfile.gettempdir()):
        try:
            about = os.statvfs(folder)
        except OSError:
            continue
        room = about.f_bavail * about.f_frsize
        if room >= MEMORY_MB << 20 and not about.f_flag & os.ST_NOEXEC and os.access(folder, os.W_OK):
            return folder
    return None


def run_in_uml(command, preload):
    kernel = shutil.which("linux.uml")
    if kernel is None:
        print("in_vcan: no CAN in this kernel and no linux.uml; install user-mode-linux kmod busybox-static iproute2")
        return 1
    memory_folder = folder_for_memory()
    if memory_folder is None:
        print(f"in_vcan: no folder with {MEMORY_MB} MB that may hold code, neither /dev/shm nor {tempfile.gettempdir()}")
        return 1
    with tempfile.TemporaryDirectory(prefix="vinv_vcan_") as folder:
        status = os.path.join(folder, "status")
        init = os.path.join(folder, "init.sh")
        with open(init, "w", encoding="utf-8") as f:
            environment = "\n".join(f"export {name}={shlex.quote(value)}" for name, value in os.environ.items()
                                    if name.isidentifier())
            f.write(INIT.format(command=shlex.join(command), status=shlex.quote(status), cwd=shlex.quote(os.getcwd()),
                                environment=environment))
        os.chmod(init, 0o755)
        arguments = [kernel, f"mem={MEMORY_MB}M", "root=/dev/root", "rootfstype=hostfs", "rootflags=/", "rw", f"init={init}",
                     f"uml_dir={folder}", "con=null", "con0=fd:0,fd:1", "quiet"]
        environment = dict(os.environ, TMPDIR=memory_folder)
        if preload:
            environment["LD_PRELOAD"] = preload
        try:
            # A session of its own, so that all of its processes end with it.
            kernel_process = subprocess.Popen(arguments, stdin=subprocess.DEVNULL, start_new_session=True,
                                              env=environment)
            kernel_process.wait(TIME_LIMIT_S)
        except subprocess.TimeoutExpired:
            os.killpg(kernel_process.pid, 9)
            kernel_process.wait()
            print(f"in_vcan: no end after {TIME_LIMIT_S} s")
            return 1
        try:
            with open(status, encoding="utf-8") as f:
                return int(f.read())
        except (OSError, ValueError):
            print("in_vcan: the user-mode kernel ended without a status; in a container it needs ptrace, as this script's head says")
            return 1


def main():
    arguments = sys.argv[1:]
    where = arguments.pop(0) if arguments and arguments[0] in ("--here", "--uml") else ""
    preload = ""
    if len(arguments) > 1 and arguments[0] == "--preload":
        preload = os.path.abspath(arguments[1])
        del arguments[:2]
    if not arguments:
        print(__doc__)
        return 2
    if where == "--here" or (where == "" and can_run_here()):
        return run_here(arguments)
    return run_in_uml(arguments, preload)


if __name__ == "__main__":
    sys.exit(main())
