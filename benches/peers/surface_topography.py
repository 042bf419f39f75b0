"""Correlation and spectrum of one line of 160000 points: SurfaceTopography beside asperity.

    python3 benches/peers/surface_topography.py

Makes a virtual environment in target/peers, installs SurfaceTopography there and starts itself in it.
Both programs run on one thread and take turns, and the medians of the rounds are compared. Both transform
the same random self-affine line (Hurst exponent 0.65) without gaps.
"""

import statistics
import subprocess
import sys
import time

from environment import FOLDER, ROOT, VERSIONS, inside_environment

VERSION = VERSIONS["SurfaceTopography"]
POINTS, SPACING = 160_000, 6.25e-6
ROUNDS, REPEATS = 5, 9


def self_affine_line(numpy):
    """Heights in metres with random phases, C1D ~ q^-2.3, root mean square 0.5 mm."""
    generator = numpy.random.default_rng(1)
    k = numpy.arange(1, POINTS + 1)
    amplitudes = k ** (-1.15) * numpy.exp(2j * numpy.pi * generator.random(len(k)))
    # A period twice as long as the line: its ends differ, as those of a scan.
    heights = numpy.fft.irfft(numpy.concatenate([[0], amplitudes]), 2 * POINTS)[:POINTS]
    heights -= heights.mean()
    return 0.5e-3 * heights / heights.std()


def timed(work):
    result, seconds = work(), []
    for _ in range(REPEATS):
        start = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - start)
    return result, statistics.median(seconds)


def main():
    import numpy
    from SurfaceTopography import UniformLineScan

    heights = self_affine_line(numpy)
    heights.astype("<f8").tofile(FOLDER / "line.raw")
    build = ["cargo", "build", "--release", "--example", "line_statistics"]
    subprocess.run(build, cwd=ROOT, check=True)
    run = ["cargo", "run", "-q", "--release", "--example", "line_statistics"]
    arguments = [FOLDER / "line.raw", repr(SPACING), str(REPEATS), FOLDER / "asperity.raw"]

    line = UniformLineScan(heights, POINTS * SPACING)
    seconds = {"correlation": [], "spectrum": []}
    for _ in range(ROUNDS):
        out = subprocess.run(run + arguments, cwd=ROOT, check=True, capture_output=True, text=True).stdout
        ours = [float(value) for value in out.split()]
        # All points in their own places, as ours: no resampling, no cut-off.
        options = {"reliable": False, "resampling_method": None}
        (_, correlation), theirs_c = timed(lambda: line.autocorrelation_from_profile(**options))
        (_, density), theirs_s = timed(lambda: line.power_spectrum_from_profile(window="hann", **options))
        seconds["correlation"].append((theirs_c, ours[0]))
        seconds["spectrum"].append((theirs_s, ours[1]))

    values = numpy.fromfile(FOLDER / "asperity.raw", "<f8")
    lags = POINTS // 2 + 1
    # Theirs is half the mean square difference, and a two-sided density over frequencies q / (2 pi).
    apart = {
        "correlation": difference(2 * correlation[1:lags], values[1:lags]),
        "spectrum": difference(density[1 : POINTS // 2 - 1] / numpy.pi, values[lags + 1 : lags + POINTS // 2 - 1]),
    }
    print(f"{POINTS} points, one thread, medians of {ROUNDS} rounds of {REPEATS}")
    print(f"| | SurfaceTopography {VERSION} | asperity | ratio | largest relative difference |\n|---|---|---|---|---|")
    for name, rounds in seconds.items():
        theirs, ours = (statistics.median(column) for column in zip(*rounds))
        ratio = f"{theirs * 1e3:.2f} ms | {ours * 1e3:.2f} ms | {theirs / ours:.1f}"
        print(f"| {name} | {ratio} | {apart[name]:.1e} |")
    return max(apart.values()) > 1e-6


def difference(a, b):
    return float(abs(a / b - 1).max())


if __name__ == "__main__":
    inside_environment()
    sys.exit(main())
