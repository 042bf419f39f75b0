"""Elastic areal contact at 5 % area: Tamaas beside asperity; and the sliding of a rubber, which has no peer.

    python3 benches/peers/areal_contact.py [POINTS_OF_A_SIDE ...]

Makes a virtual environment in target/peers, installs the peer there and starts itself in it. Both solve
w_hat(q) = 2 / (E* |q|) p_hat(q) on one thread, on the same points of a random self-affine map (Hurst exponent 0.65,
all waves from the period down to 16 points, root mean square slope of cuts 0.3) and at the same mean pressure. Seconds are
from heights in memory to pressures in memory, set-up included; those of asperity also hold the grids with half, a quarter
and an eighth of the points, which give its error.
"""

import statistics
import subprocess
import sys
import time

from environment import FOLDER, VERSIONS, build_asperity, inside_environment, solve

SIZES = (256, 512, 1024)
POINTS_PER_SHORTEST_WAVE = 16
HURST, SLOPE, SIZE_MM = 0.65, 0.3, 1.0
MODULUS_MPA, POISSON, AREA = 4.17, 0.49, 0.05
SPEED_MM_S = 50.0
ROUNDS, LIMIT_SECONDS = 3, 600.0
TOLERANCE = 1e-8


def self_affine_map(numpy, points):
    """Heights in mm of an isotropic surface, with the same waves on all numbers of points that resolve them."""
    highest = points // POINTS_PER_SHORTEST_WAVE
    k = numpy.arange(-highest, highest + 1)
    q = numpy.hypot(*numpy.meshgrid(k, k))
    inside = (q >= 1) & (q <= highest)
    amplitude = numpy.where(inside, numpy.where(inside, q, 1) ** (-1 - HURST), 0)
    waves = amplitude * numpy.exp(2j * numpy.pi * numpy.random.default_rng(1).random(q.shape))
    spectrum = numpy.zeros((points, points), complex)
    spectrum[numpy.ix_(k % points, k % points)] = waves
    heights = numpy.fft.ifft2(spectrum).real
    along = 2j * numpy.pi / SIZE_MM * numpy.fft.fftfreq(points, 1 / points)
    slope = numpy.fft.ifft2(numpy.fft.fft2(heights) * along).real.std()
    return heights * SLOPE / slope


def tamaas(heights, pressure):
    import tamaas as library

    library.set_log_level(library.LogLevel.error)
    start = time.perf_counter()
    model = library.ModelFactory.createModel(library.model_type.basic_2d, [SIZE_MM] * 2, list(heights.shape))
    model.E, model.nu = MODULUS_MPA, POISSON
    solver = library.PolonskyKeerRey(model, heights, TOLERANCE)
    solver.max_iter = 100_000
    error = solver.solve(pressure)
    seconds = time.perf_counter() - start
    if error > TOLERANCE:
        raise RuntimeError(f"Tamaas stopped at {error}")
    return model.traction.reshape(heights.shape), seconds


def worker(numpy, points, pressure):
    """One solve in a process of its own, so that it can be stopped."""
    heights = numpy.fromfile(FOLDER / "map.raw").reshape(int(points), int(points))
    tamaas(numpy.cos(2 * numpy.pi * numpy.arange(256) / 16).reshape(16, 16), 0.1)
    pressures, seconds = tamaas(heights, float(pressure))
    numpy.asarray(pressures).tofile(FOLDER / "pressures.raw")
    print(seconds)


def run_peer(numpy, heights, pressure):
    """Pressures and seconds; None after the time limit."""
    heights.tofile(FOLDER / "map.raw")
    command = [sys.executable, __file__, "--worker", str(len(heights)), repr(pressure)]
    try:
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, timeout=LIMIT_SECONDS)
    except subprocess.TimeoutExpired:
        return None
    return numpy.fromfile(FOLDER / "pressures.raw"), float(done.stdout)


def compare(numpy, binary, points):
    heights = self_affine_map(numpy, points)
    path = FOLDER / "map.txt"
    numpy.savetxt(path, heights, fmt="%.17g")
    surface = ("--map", path, "--map-unit", "mm", "--size-mm", SIZE_MM, "--quiet")
    elastic = (*surface, "--modulus", MODULUS_MPA, "--poisson", POISSON, "--speed", 1)
    pressure = solve(binary, *elastic, "--area", AREA, contact="areal")[0]["pressure_mpa"]
    seconds = {"Tamaas": [], "asperity": [], "asperity, sliding": []}
    for _ in range(ROUNDS):
        solved = run_peer(numpy, heights, pressure)
        if solved is not None:
            seconds["Tamaas"].append(solved[1])
            field = solved[0]
        ours, _ = solve(binary, *elastic, "--pressure", repr(pressure), contact="areal")
        seconds["asperity"].append(ours["seconds"])
        rubber, _ = solve(binary, *surface, "--speed", SPEED_MM_S, "--area", AREA, contact="areal")
        load = ("--speed", SPEED_MM_S, "--pressure", repr(rubber["pressure_mpa"]))
        rubber, _ = solve(binary, *surface, *load, contact="areal")
        seconds["asperity, sliding"].append(rubber["seconds"])
    fields = ("--fields", FOLDER / "fields.csv", "--force")
    solve(binary, *elastic, "--pressure", repr(pressure), *fields, contact="areal")
    own = numpy.loadtxt(FOLDER / "fields.csv", delimiter=",", skiprows=1, usecols=3)
    median = {name: statistics.median(times) if times else None for name, times in seconds.items()}
    base = median["asperity"]
    if median["Tamaas"] is None:
        print(f"| {points}² | Tamaas | more than {LIMIT_SECONDS:.0f} | more than {LIMIT_SECONDS / base:.0f} | | |")
    else:
        square, area = numpy.mean(field**2) / pressure**2, numpy.mean(field > 0)
        print(f"| {points}² | Tamaas | {median['Tamaas']:.2f} | {median['Tamaas'] / base:.1f} | {square:.7f} | {area:.6f} |")
    square, area = numpy.mean(own**2) / pressure**2, numpy.mean(own > 0)
    print(f"| {points}² | asperity | {base:.2f} | 1.0 | {square:.7f} | {area:.6f} |")
    sliding, cost = median["asperity, sliding"], rubber["operator_applications"]
    print(f"| {points}² | asperity, rubber at {SPEED_MM_S:.0f} mm/s, {cost:.0f} applications | {sliding:.2f} | | | |", flush=True)


def main():
    import numpy

    if sys.argv[1:2] == ["--worker"]:
        worker(numpy, *sys.argv[2:])
        return
    binary = build_asperity()
    print(f"One thread, medians of {ROUNDS} rounds in turn; Tamaas {VERSIONS['tamaas']} to {TOLERANCE:.0e}, asperity to 1e-10")
    print("| points | | seconds | ratio | mean square pressure / p² | part of points in contact |\n|---|---|---:|---:|---:|---:|")
    for points in map(int, sys.argv[1:] or SIZES):
        compare(numpy, binary, points)


if __name__ == "__main__":
    inside_environment()
    main()
