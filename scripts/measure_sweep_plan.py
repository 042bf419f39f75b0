#!/usr/bin/env python3
"""Plans a sweep of a million solves for a thousand nodes and says what that takes and how even the shares are.

    python3 scripts/measure_sweep_plan.py --program target/release/asperity

The plan is a real one of real scans. How long its tasks would take is drawn from those of a smaller sweep that is solved here,
task by task relative to what was predicted for it; a shard then takes the sum over its tasks. Standard library only.
"""

import argparse
import json
import random
import resource
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

PROJECT = Path(__file__).resolve().parent.parent
SHARDS = 1000


def recipe(folder, name, temperatures, seeds, realisations):
    text = (PROJECT / "pipelines/sweep.toml").read_text()
    text = text.replace('"../data/', f'"{PROJECT}/data/')
    text = text.replace("[10.0, 40.0]", str([round(10 + 30 * k / max(1, temperatures - 1), 3) for k in range(temperatures)]))
    text = text.replace("[1, 2]", str(list(range(1, seeds + 1))))
    text = text.replace("realisations = 3", f"realisations = {realisations}")
    path = folder / name
    path.write_text(text)
    return path


def plan(program, path, out, shards):
    """The plan, with seconds and megabytes that making it took."""
    begin = time.monotonic()
    command = [program, "--quiet", "sweep", "plan", path, "--out", out, "--shards", str(shards)]
    printed = subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True)
    seconds = time.monotonic() - begin
    megabytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    return Path(printed.stdout.strip()), seconds, megabytes


def solve_small(program, folder):
    """For each task of a small sweep the seconds it took over their mean, and the mean number of solves."""
    path = recipe(folder, "small.toml", 4, 3, 4)
    out = folder / "small"
    planned, _, _ = plan(program, path, out, 1)
    subprocess.run([program, "--quiet", "sweep", "run", str(planned), "--shard", "0", "--threads", "1"], check=True)
    seconds, solves = [], []
    for pack in (out / "solves").glob("*/*.pack"):
        rows = json.loads(pack.read_text())["solves"].values()
        seconds.append(sum(row["seconds"] for row in rows))
        solves.append(len(rows))
    mean = statistics.mean(seconds)
    return [value / mean for value in seconds], statistics.mean(solves), mean


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, type=Path)
    program = str(parser.parse_args().program.resolve())
    with tempfile.TemporaryDirectory(prefix="asperity-plan-") as folder:
        folder = Path(folder)
        spread, solves, mean = solve_small(program, folder)
        path = recipe(folder, "large.toml", 20, 40, 11)
        out = folder / "large"
        planned, seconds, megabytes = plan(program, path, out, SHARDS)
        header = json.loads(planned.read_text())
        tasks = sum(shard["tasks"] for shard in header["shards"])
        print(f"{tasks} tasks, {tasks * solves / 1e6:.2f} million solves, in {header['cases']} cases and {SHARDS} shards")
        print(f"planned in {seconds:.1f} s within {megabytes:.0f} MB; {mean:.2f} s a task of {solves:.0f} solves, one thread")
        draw = random.Random(1)
        times = [sum(mean * draw.choice(spread) for _ in range(shard["tasks"])) for shard in header["shards"]]
        average = statistics.mean(times)
        predicted = [shard["seconds"] for shard in header["shards"]]
        print(f"shares as predicted: longest {max(predicted) / statistics.mean(predicted):.3f} of the mean")
        print(f"times as drawn: mean {average:.0f} s, longest {max(times):.0f} s: {average / max(times):.1%} of the nodes' time is used")
        files = [path for path in planned.parent.iterdir()]
        size = sum(path.stat().st_size for path in files) / 1e6
        print(f"plan: {len(files)} files, {size:.0f} MB, {size / SHARDS * 1e3:.0f} kB a shard")
        print(f"solves: {tasks} files in 256 folders, about {tasks / 256:.0f} in each")


if __name__ == "__main__":
    main()
