#!/usr/bin/env python3
"""Runs a sweep on a Slurm of this machine with two nodes, kills one of them in mid-run, and compares the tables
with those of a run without Slurm.

    python3 scripts/check_slurm.py --program target/release/asperity
    python3 scripts/check_slurm.py --program target/release/asperity --measure

Fails unless the array completes by requeue, the collected tables are equal to the bit, and a second round (micro)
is planned and submitted by the first. With --measure the time a solve and a shard take beside computing, and a
sweep of 2000 solves on one node and on two.
"""

import argparse
import filecmp
import json
import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from slurm import Slurm, kill  # noqa: E402

PROJECT = Path(__file__).resolve().parent.parent


def recipe(folder, name, *changes):
    """The sweep of the project with other values, in a file of its own."""
    text = (PROJECT / "pipelines/sweep.toml").read_text()
    text = text.replace('"../data/', f'"{PROJECT}/data/')
    for old, new in changes:
        if text.count(old) != 1:
            raise RuntimeError(f"`{old}` stands {text.count(old)} times in the recipe")
        text = text.replace(old, new)
    path = folder / name
    path.write_text(text)
    return path


class Sweep:
    """A recipe in a folder, by the program."""

    def __init__(self, program, slurm, path, out):
        self.program, self.slurm, self.path, self.out = program, slurm, path, out

    def asperity(self, *arguments):
        return self.slurm.run(self.program, "--quiet", *map(str, arguments)).strip()

    def plan(self, shards):
        return self.asperity("sweep", "plan", self.path, "--out", self.out, "--shards", shards)

    def submit(self, plan, *options):
        """Numbers of the array and of the job that collects."""
        words = self.asperity("sweep", "submit", plan, *options).replace(",", "").split()
        return words[1], words[4].rstrip(";")

    def log(self):
        logs = sorted((self.out / "logs").glob("*collect.log"))
        return "\n".join(path.read_text(errors="replace") for path in logs)


def lose_node(slurm, node):
    """SIGKILL to what Slurm runs there; the tasks themselves freeze, as behind a network that is cut. Returns
    their processes."""
    slurm.kill(node)
    frozen = []
    for process in slurm.of_jobs(node):
        parent = parent_of(process)
        if parent and "slurmstepd" in Path(f"/proc/{parent}/cmdline").read_bytes().decode():
            kill(parent)
            # Before the child stops: one that becomes an orphan while it is stopped is sent SIGHUP.
            slurm.wait_for("end of a step", lambda: parent_of(process) != parent, 20)
        if parent_of(process):
            os.kill(process, signal.SIGSTOP)
            frozen.append(process)
    if not frozen:
        raise RuntimeError("no task of the lost node was left to freeze")
    return frozen


def parent_of(process):
    """The parent of a process; none if it has ended."""
    try:
        status = Path(f"/proc/{process}/status").read_text()
    except FileNotFoundError:
        return None
    words = dict(line.split(":", 1) for line in status.splitlines())
    return None if words["State"].split()[0] == "Z" else int(words["PPid"])


def same_tables(one, other):
    return filecmp.cmp(one / "sweep/friction.arrow", other / "sweep/friction.arrow", shallow=False)


def wait_for_collection(slurm, sweep, collect, seconds):
    def ended():
        states = {state for state, _ in slurm.states(collect).values()}
        return states and states <= {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL"}

    slurm.wait_for("end of the collection", ended, seconds)
    states = slurm.states(collect)
    if any(state != "COMPLETED" for state, _ in states.values()):
        raise RuntimeError(f"collection: {states}\n{sweep.log()}")


def node_dies(program, folder):
    """A node is lost in mid-run; what it was working on is requeued, and goes on unseen as well."""
    changes = [
        ("realisations = 3", "realisations = 12"),
        ("[bem]\n", "[bem]\npoints_per_shortest_wavelength = 256\n"),
    ]
    path = recipe(folder, "dies.toml", *changes)
    alone, out = folder / "alone", folder / "spread"
    with Slurm() as slurm:
        sweep = Sweep(program, slurm, path, out)
        begin = time.monotonic()
        sweep.asperity("run", path, "--out", alone)
        seconds = time.monotonic() - begin
        plan = sweep.plan(24)
        array, collect = sweep.submit(plan)

        seen = set()

        def under_way():
            """An element has just begun on the node, after some have ended."""
            processes = set(slurm.of_jobs("n2"))
            begun = processes - seen
            seen.update(processes)
            states = slurm.states(array).values()
            return begun and sum(state == "COMPLETED" for state, _ in states) >= 3

        slurm.wait_for("array in mid-run", under_way, 300)
        lost = [name for name, row in slurm.states(array).items() if row == ("RUNNING", "n2")]
        frozen = lose_node(slurm, "n2")
        print(f"node n2 lost in mid-run with elements {', '.join(lost)} on it")
        wait_for_collection(slurm, sweep, collect, 900)
        states = slurm.states(array)
        unfinished = {name: row for name, row in states.items() if row[0] != "COMPLETED"}
        if unfinished:
            raise RuntimeError(f"elements that did not complete: {unfinished}")
        moved = [name for name in lost if states[name][1] == "n1"]
        if not moved:
            raise RuntimeError(f"no element of the lost node was requeued: {states}")
        if not same_tables(alone, out):
            raise RuntimeError("the tables of the sweep differ from those of one machine")
        print(f"{len(states)} elements completed, requeued: {', '.join(moved)}")
        print(f"tables are equal to the bit to those of a run on one machine ({seconds:.0f} s)")
        for process in frozen:
            os.kill(process, signal.SIGCONT)
        slurm.wait_for("end of what came back", lambda: not slurm.of_jobs("n2"), 120)
        sweep.asperity("sweep", "collect", plan)
        if not same_tables(alone, out):
            raise RuntimeError("what the lost node wrote late has changed the tables")
        print(f"{len(frozen)} processes of the lost node came back and ended: the tables are the same")


def second_round(program, folder):
    """Microscales, which need the half-space first, come as an array of their own."""
    changes = [
        ("temperatures_c = [10.0, 40.0]", "temperatures_c = [40.0]"),
        ("seeds = [1, 2]", "seeds = [1]"),
        ("realisations = 3", "realisations = 2"),
        ("speeds_mm_s = [10.0, 50.0]", "speeds_mm_s = [10.0]"),
        ("area_fractions = [0.02, 0.05, 0.1]", "area_fractions = [0.02, 0.03]"),
    ]
    path = recipe(folder, "micro.toml", *changes)
    coarse = "\n[micro]\ncolumns_per_shortest_wavelength = 32\ntolerance = 0.02\n"
    path.write_text(path.read_text() + coarse)
    alone, out = folder / "micro_alone", folder / "micro_spread"
    with Slurm() as slurm:
        sweep = Sweep(program, slurm, path, out)
        sweep.asperity("run", path, "--out", alone)
        array, collect = sweep.submit(sweep.plan(4))
        wait_for_collection(slurm, sweep, collect, 300)
        jobs = set(slurm.run("squeue", "-h", "-t", "all", "-o", "%A").split())
        later = max(int(job) for job in jobs)
        if later <= int(collect):
            raise RuntimeError(f"no second array was submitted\n{sweep.log()}")
        wait_for_collection(slurm, sweep, str(later), 600)
        plans = [json.loads(path.read_text()) for path in (out / "plans").glob("*/plan.json")]
        tasks = sorted(sum(shard["tasks"] for shard in plan["shards"]) for plan in plans)
        # The last one finds that nothing is missing.
        if tasks[0] != 0 or len(tasks) != 3 or not same_tables(alone, out):
            raise RuntimeError(f"plans of {tasks} tasks; tables equal: {same_tables(alone, out)}")
        print(f"half-space and microscale in two arrays of {tasks[2]} and {tasks[1]} tasks: equal to the bit")


def measure(program, folder):
    """A sweep of about 2000 solves on one node and on two, of one core each."""
    changes = [
        ("realisations = 3", "realisations = 8"),
        ("[bem]\n", "[bem]\npoints_per_shortest_wavelength = 256\n"),
    ]
    path = recipe(folder, "measure.toml", *changes)
    with Slurm(cpus=1) as slurm:
        times = {}
        for nodes in [1, 2]:
            slurm.run("scontrol", "update", "NodeName=n2", f"State={'DRAIN' if nodes == 1 else 'RESUME'}", "Reason=scaling")
            time.sleep(3)
            out = folder / f"nodes_{nodes}"
            sweep = Sweep(program, slurm, path, out)
            begin = time.monotonic()
            plan = sweep.plan(20)
            planned = time.monotonic() - begin
            predicted = sum(json.loads(slurm.run(program, "--quiet", "sweep", "plan", str(path), "--out", str(out), "--shards", "20", "--json"))["seconds"])
            begin = time.monotonic()
            array, collect = sweep.submit(plan)
            wait_for_collection(slurm, sweep, collect, 1800)
            times[nodes] = time.monotonic() - begin
            lines = [line for log in (out / "logs").glob(f"{array}_*.log") for line in log.read_text().splitlines()]
            computing = [float(line.split(" in ")[1].split()[0]) for line in lines if " tasks solved in " in line]
            solves = sum(count_solves(path) for path in (out / "solves").glob("*/*.pack"))
            files = sum(1 for path in (out / "solves").glob("*/*") if path.is_file())
            print(
                f"{nodes} nodes: {solves} solves in {times[nodes]:.1f} s from submission to tables; planning {planned:.1f} s; "
                f"{len(computing)} shards computed {sum(computing):.1f} s (predicted {predicted:.1f}), median "
                f"{statistics.median(computing):.2f} s, longest {max(computing):.2f} s; {files} files of solves; overhead "
                f"{1e3 * (times[nodes] * nodes - sum(computing)) / solves:.1f} ms a solve"
            )
        print(f"two nodes against one: {times[1] / times[2]:.2f} times as fast")


def count_solves(path):
    return len(json.loads(path.read_text())["solves"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, type=Path)
    parser.add_argument("--measure", action="store_true")
    arguments = parser.parse_args()
    program = str(arguments.program.resolve())
    parts = [measure] if arguments.measure else [node_dies, second_round]
    with tempfile.TemporaryDirectory(prefix="asperity-sweep-") as folder:
        for part in parts:
            begin = time.monotonic()
            part(program, Path(folder))
            print(f"{part.__name__}: {time.monotonic() - begin:.0f} s", flush=True)


if __name__ == "__main__":
    main()
