"""Elastic line contact at 5 % area: Tamaas and ContactMechanics beside asperity.

    python3 benches/peers/elastic_contact.py [POINTS ...]

Makes a virtual environment in target/peers, installs the peers there and starts itself in it. All three
solve plane strain, w_hat(q) = 2 / (E* |q|) p_hat(q), on one thread, on the same points and at the same mean
pressure. First a sine against Westergaard's closed form, then random self-affine profiles (Hurst exponent
0.65, all waves from the period down to 16 points) against asperity on a grid 16 times as fine (four times for
the largest). Seconds are from heights in memory to pressures in memory, set-up included.
"""

import math
import statistics
import subprocess
import sys
import time

from environment import FOLDER, VERSIONS, build_asperity, inside_environment, solve

SIZES = (4096, 16384, 65536, 1 << 20)
POINTS_PER_SHORTEST_WAVE = 16
LARGEST_GRID = 1 << 22
HURST, ROOT_MEAN_SQUARE_MM = 0.65, 0.01
PERIOD_MM, MODULUS_MPA, POISSON, AREA = 1.0, 4.17, 0.49, 0.05
PLANE_MODULUS_MPA = MODULUS_MPA / (1 - POISSON**2)
ROUNDS, LIMIT_SECONDS = 5, 300.0
REFINEMENT, REFINED_UP_TO = 4, 65536
# The loosest powers of ten that leave the iteration's error of the mean square pressure below the
# grid's; ContactMechanics' is of the root mean square height.
TOLERANCES = {"Tamaas": 1e-5, "ContactMechanics": 1e-5}
TIGHT = {"Tamaas": 1e-10, "ContactMechanics": 1e-9}


def tamaas(heights, pressure, tolerance):
    import tamaas as library

    library.set_log_level(library.LogLevel.error)
    start = time.perf_counter()
    model = library.ModelFactory.createModel(library.model_type.basic_1d, [PERIOD_MM], [len(heights)])
    model.E, model.nu = MODULUS_MPA, POISSON
    solver = library.PolonskyKeerRey(model, heights, tolerance)
    solver.max_iter = 100_000
    error = solver.solve(pressure)
    seconds = time.perf_counter() - start
    if error > tolerance:
        raise RuntimeError(f"Tamaas stopped at {error}")
    return model.traction.ravel(), seconds


def contact_mechanics(heights, pressure, tolerance):
    from ContactMechanics import PeriodicFFTElasticHalfSpace
    from ContactMechanics.Systems import NonSmoothContactSystem
    from SurfaceTopography import UniformLineScan

    size = heights.std()
    start = time.perf_counter()
    half_space = PeriodicFFTElasticHalfSpace((len(heights),), PLANE_MODULUS_MPA, (PERIOD_MM,))
    system = NonSmoothContactSystem(half_space, UniformLineScan(heights, PERIOD_MM, periodic=True))
    result = system.minimize_proxy(
        external_force=pressure * PERIOD_MM,
        pentol=tolerance * size,
        forcetol=tolerance * pressure * half_space.area_per_pt,
    )
    seconds = time.perf_counter() - start
    if not result.success:
        raise RuntimeError(f"ContactMechanics: {result.message}")
    return result.jac / half_space.area_per_pt, seconds


PEERS = {"Tamaas": tamaas, "ContactMechanics": contact_mechanics}


def worker(numpy, peer, pressure, tolerance):
    """One solve in a process of its own, so that it can be stopped."""
    heights = numpy.fromfile(FOLDER / "heights.raw")
    # What a library loads when first used is not counted.
    PEERS[peer](numpy.cos(2 * numpy.pi * numpy.arange(64) / 64), 0.1, 1e-3)
    pressures, seconds = PEERS[peer](heights, float(pressure), float(tolerance))
    numpy.asarray(pressures).tofile(FOLDER / "pressures.raw")
    print(seconds)


def run_peer(numpy, peer, heights, pressure, tolerance):
    """Pressures and seconds; None after the time limit."""
    heights.tofile(FOLDER / "heights.raw")
    command = [sys.executable, __file__, "--worker", peer, repr(pressure), repr(tolerance)]
    try:
        done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, timeout=LIMIT_SECONDS)
    except subprocess.TimeoutExpired:
        return None
    return numpy.fromfile(FOLDER / "pressures.raw"), float(done.stdout)


def write_profile(numpy, heights):
    positions = numpy.arange(len(heights)) * (PERIOD_MM / len(heights))
    path = FOLDER / "profile.txt"
    numpy.savetxt(path, numpy.column_stack([positions, heights]), fmt="%.17g")
    return ["--profile", path, "--profile-unit", "mm"]


def run_asperity(binary, profile, *load, fields=False):
    options = [*profile, "--modulus", MODULUS_MPA, "--poisson", POISSON, "--speed", 1, *load]
    return solve(binary, *options, *(["--fields", FOLDER / "fields.csv", "--force"] if fields else []))


def pressures_of_asperity(numpy):
    return numpy.loadtxt(FOLDER / "fields.csv", delimiter=",", skiprows=1, usecols=2)


def check_on_sine(numpy, binary):
    """Westergaard: area 2/pi asin sqrt(p/p*), largest pressure 2 p* sqrt(p/p*), p* = pi E* A / lambda."""
    points, amplitude = 4096, 0.02
    heights = amplitude * numpy.cos(2 * math.pi * numpy.arange(points) / points)
    profile = write_profile(numpy, heights)
    full = math.pi * PLANE_MODULUS_MPA * amplitude / PERIOD_MM
    print(f"A sine on {points} points against Westergaard: error of the area, of the largest pressure, relative")
    print("| p/p* | Tamaas | ContactMechanics | asperity |\n|---|---|---|---|")
    for fraction in (0.01, 0.1, 0.3):
        pressure, cells = fraction * full, []
        exact = 2 / math.pi * math.asin(math.sqrt(fraction)), 2 * full * math.sqrt(fraction)
        for peer in PEERS:
            field, _ = run_peer(numpy, peer, heights, pressure, TIGHT[peer])
            cells.append((numpy.mean(field > 0), field.max()))
        ours, _ = run_asperity(binary, profile, "--pressure", pressure, fields=True)
        cells.append((ours["contact_area_fraction"], pressures_of_asperity(numpy).max()))
        errors = [(area / exact[0] - 1, largest / exact[1] - 1) for area, largest in cells]
        # Half a point at either edge of the contact; the pressure is smooth at its largest.
        if any(abs(area) * exact[0] * points > 2 or abs(largest) > 1e-5 for area, largest in errors):
            raise RuntimeError(f"not the same problem: {errors}")
        print(f"| {fraction} | " + " | ".join(f"{area:+.1e}, {largest:+.1e}" for area, largest in errors) + " |")


def self_affine_profile(numpy, points):
    """Heights in mm; more points continue the same waves to shorter ones."""
    waves = points // POINTS_PER_SHORTEST_WAVE
    k = numpy.arange(1, waves + 1)
    spectrum = numpy.zeros(points // 2 + 1, complex)
    spectrum[1 : waves + 1] = k ** (-0.5 - HURST) * numpy.exp(2j * numpy.pi * numpy.random.default_rng(1).random(waves))
    heights = numpy.fft.irfft(spectrum, points)
    return ROOT_MEAN_SQUARE_MM * heights / heights.std()


def interpolate(numpy, heights, points):
    """The same waves on a finer grid."""
    return numpy.fft.irfft(numpy.fft.rfft(heights), points) * (points / len(heights))


def compare(numpy, binary, points):
    heights = self_affine_profile(numpy, points)
    profile = write_profile(numpy, heights)
    pressure = run_asperity(binary, profile, "--area", AREA)[0]["pressure_mpa"]
    load = ("--pressure", repr(pressure))
    seconds = {name: [] for name in (*PEERS, "asperity", "whole process")}
    read = {}
    for _ in range(ROUNDS):
        for peer in PEERS:
            if seconds[peer] is None:
                continue
            solved = run_peer(numpy, peer, heights, pressure, TOLERANCES[peer])
            if solved is None:
                seconds[peer] = None
                continue
            read[peer] = numpy.mean(solved[0] > 0), numpy.mean(solved[0] ** 2)
            seconds[peer].append(solved[1])
        ours, whole = run_asperity(binary, profile, *load)
        seconds["asperity"].append(ours["seconds"])
        seconds["whole process"].append(whole)
    run_asperity(binary, profile, *load, fields=True)
    read["asperity"] = ours["contact_area_fraction"], numpy.mean(pressures_of_asperity(numpy) ** 2)
    truth = over_resolved(numpy, binary, heights, load)
    median = {name: statistics.median(times) if times else None for name, times in seconds.items()}
    for name in (*PEERS, "asperity"):
        report(points, name, median, read.get(name), truth)
    print(f"| {points} | asperity, whole process | {median['whole process']:.4f} s | | | |", flush=True)
    if points <= REFINED_UP_TO:
        refine_peers(numpy, heights, pressure, median["asperity"], truth)


def refine_peers(numpy, heights, pressure, ours, truth):
    """The peers once more on a finer grid: they count points for the area, which is of first order."""
    finer = interpolate(numpy, heights, REFINEMENT * len(heights))
    for peer in PEERS:
        solved = run_peer(numpy, peer, finer, pressure, TOLERANCES[peer])
        read = solved and (numpy.mean(solved[0] > 0), numpy.mean(solved[0] ** 2))
        median = {peer: solved and solved[1], "asperity": ours}
        report(f"{len(heights)}, on {len(finer)}", peer, median, read, truth)


def over_resolved(numpy, binary, heights, load):
    """Area and mean square pressure of the same waves on the fine grid."""
    points = min(16 * len(heights), LARGEST_GRID)
    finer = interpolate(numpy, heights, points)
    fine, _ = run_asperity(binary, write_profile(numpy, finer), *load, fields=True)
    mean_square = numpy.mean(pressures_of_asperity(numpy) ** 2)
    if len(heights) == SIZES[0]:
        # That answer is ours: here a peer solves for it too.
        field, _ = run_peer(numpy, "Tamaas", finer, float(load[1]), TIGHT["Tamaas"])
        apart = numpy.mean(field**2) / mean_square - 1, numpy.mean(field > 0) - fine["contact_area_fraction"]
        print(
            f"<!-- Tamaas on the fine grid of {points} points: mean square pressure {apart[0]:+.1e}, "
            f"counted area {apart[1] * points:+.0f} points, from asperity's -->"
        )
    return fine["contact_area_fraction"], mean_square


def report(points, name, median, read, truth):
    if median[name] is None:
        print(f"| {points} | {name} | more than {LIMIT_SECONDS:.0f} s | more than {LIMIT_SECONDS / median['asperity']:.0f} | | |")
        return
    area, square = (value / exact - 1 for value, exact in zip(read, truth))
    ratio = median[name] / median["asperity"]
    print(f"| {points} | {name} | {median[name]:.4f} s | {ratio:.1f} | {square:+.1e} | {area:+.1e} |", flush=True)


def main():
    import numpy

    if sys.argv[1:2] == ["--worker"]:
        worker(numpy, *sys.argv[2:])
        return
    binary = build_asperity()
    check_on_sine(numpy, binary)
    tolerances = ", ".join(f"{name} {value:.0e}" for name, value in TOLERANCES.items())
    print(f"\nOne thread, medians of {ROUNDS} rounds in turn; tolerances: {tolerances}, asperity 1e-10")
    print(f"Tamaas {VERSIONS['tamaas']}, ContactMechanics {VERSIONS['ContactMechanics']}")
    print("| points | | seconds | ratio | error of mean square pressure | error of area |\n|---|---|---|---|---|---|")
    for points in map(int, sys.argv[1:] or SIZES):
        compare(numpy, binary, points)


if __name__ == "__main__":
    inside_environment()
    main()
