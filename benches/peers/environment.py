"""What the comparisons share: their virtual environment, asperity's binary, one solve with it."""

import json
import os
import subprocess
import sys
import time
import venv
from pathlib import Path

VERSIONS = {"SurfaceTopography": "1.27.1", "ContactMechanics": "1.8.3", "tamaas": "2.9.0"}
ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "target" / "peers"


def inside_environment():
    """Starts the running script again, on one thread and with the peers installed, unless it is."""
    python = FOLDER / "venv" / "bin" / "python"
    if Path(sys.prefix) == FOLDER / "venv":
        return
    if not python.exists():
        venv.create(FOLDER / "venv", with_pip=True)
    pinned = [f"{name}=={version}" for name, version in VERSIONS.items()]
    subprocess.run([python, "-m", "pip", "install", "-q", *pinned], check=True)
    os.environ.update({name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "RAYON_NUM_THREADS")})
    os.execv(python, [python, *sys.argv])


def build_asperity():
    """Path of the binary, built if need be."""
    subprocess.run(["cargo", "build", "--release"], cwd=ROOT, check=True)
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    metadata = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return Path(json.loads(metadata)["target_directory"]) / "release" / "asperity"


def solve(binary, *options, contact="bem"):
    """What `asperity solve bem --json`, or another contact, says, and the seconds of the whole process."""
    start = time.perf_counter()
    command = [binary, "solve", contact, "--json", *map(str, options)]
    done = subprocess.run(command, capture_output=True, text=True)
    whole = time.perf_counter() - start
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout), whole
