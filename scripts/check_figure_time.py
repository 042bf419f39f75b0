#!/usr/bin/env python3
"""Checks the processor time of one PNG.

    python3 scripts/check_figure_time.py --program target/release/asperity runs/smoke

A figure may take a second of processor time on the machine where this was written. Others are slower, so the limit
grows with the time of a loop of this interpreter, which takes 0.5 s there. The best of three counts: the machine is
shared.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

LIMIT = 1.0
LOOP = 0.5


def loop():
    """Seconds of processor time of a fixed loop."""
    begin = time.process_time()
    total = 0
    for number in range(8_000_000):
        total += number * number
    return time.process_time() - begin


def figure(program, run):
    """Seconds of processor time of `plot friction --to x.png`."""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [program, "plot", "friction", run, "--to", str(Path(folder) / "x.png")]
        subprocess.run(command, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("run")
    arguments = parser.parse_args()
    slowness = max(1.0, min(loop() for _ in range(3)) / LOOP)
    seconds = min(figure(arguments.program, arguments.run) for _ in range(3))
    limit = LIMIT * slowness
    print(f"a PNG takes {seconds:.2f} s of processor time, of {limit:.2f} s at most")
    if seconds > limit:
        sys.exit("what draws a PNG is not optimised (Cargo.toml), or the figure has too much in it")


if __name__ == "__main__":
    main()
