"""Steady viscoelastic sliding on a sine: Tamaas by time marching beside asperity.

    python3 benches/peers/viscoelastic_sliding.py [POINTS ...]

Makes a virtual environment in target/peers, installs the peers there and starts itself in it. The rubber has
two Maxwell branches; both programs run on one thread, on the same points of the sine and at the same mean
pressure. Tamaas' MaxwellViscoelastic is only right when the shear modulus of its model is 1, so the unit of
pressure is the relaxed shear modulus, here 1 MPa.

Tamaas has no steady solver: the sine is moved on and the contact solved at each step (backward Euler) until
the friction of a period no longer changes, then the step is halved, going on from that state. Its seconds are
those of the whole way: larger steps first reach the steady state sooner than small steps from rest. On the same
points both have the same error of the grid, to which the march adds that of its steps; it is stopped when its
error is at most twice asperity's. The errors are against asperity's friction on 65536 points; at the end a march
on 4096 points with a tight tolerance, extrapolated to steps of no length and not timed, checks that (some minutes).
"""

import math
import statistics
import sys
import time

from environment import FOLDER, VERSIONS, build_asperity, inside_environment, solve

SIZES = (256, 1024)
PERIOD_MM, AMPLITUDE_MM, SPEED_MM_S, POISSON = 1.0, 0.02, 1.0, 0.49
# Shear moduli in MPa beside the relaxed one of 1 MPa, and relaxation times in s.
SHEAR_MODULI_MPA, RELAXATION_TIMES_S = (3.0, 10.0), (0.3, 0.03)
RELAXED_MODULUS_MPA = 2 * (1 + POISSON)
# Mean pressure over the pressure of full contact of the relaxed rubber.
PRESSURE = 0.1
FIRST_STEPS, SAMPLES = 128, 16
# The loosest power of ten that changes the friction by less than the grid of 1024 points does.
TOLERANCE = 1e-5
CONVERGED_POINTS, EXTRAPOLATED_POINTS = 1 << 16, 4096
ROUNDS, LIMIT_SECONDS = 5, 300.0
WAVENUMBER = 2 * math.pi / PERIOD_MM


class March:
    """Tamaas under a sine that moves on in steps of an equal part of the period."""

    def __init__(self, points, pressure, tolerance=TOLERANCE):
        import numpy
        import tamaas

        tamaas.set_log_level(tamaas.LogLevel.error)
        self.numpy, self.pressure = numpy, pressure
        self.positions = PERIOD_MM / points * numpy.arange(points)
        self.model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_1d, [PERIOD_MM], [points])
        self.model.E, self.model.nu = RELAXED_MODULUS_MPA, POISSON
        self.solver = tamaas.MaxwellViscoelastic(
            self.model, self.heights(0), tolerance, 1.0, list(SHEAR_MODULI_MPA), list(RELAXATION_TIMES_S)
        )
        self.solver.max_iter = 10_000

    def heights(self, moved):
        return AMPLITUDE_MM * self.numpy.cos(WAVENUMBER * (self.positions - moved))

    def friction(self, moved):
        """Mean of pressure times slope over the mean pressure; the rubber slides towards -x over the sine."""
        slope = -AMPLITUDE_MM * WAVENUMBER * self.numpy.sin(WAVENUMBER * (self.positions - moved))
        pressures = self.model.traction.ravel()
        return -(pressures * slope).mean() / pressures.mean()

    def period(self, steps):
        """Friction averaged over one period of `steps` steps."""
        self.solver.time_step = PERIOD_MM / SPEED_MM_S / steps
        samples = []
        for step in range(1, steps + 1):
            moved = PERIOD_MM * step / steps
            self.solver.surface[:] = self.heights(moved)
            self.solver.solve(self.pressure)
            if step % (steps // SAMPLES) == 0:
                samples.append(self.friction(moved))
        return statistics.fmean(samples)

    def settle(self, steps, tolerance):
        """Friction once a period changes it by less than `tolerance`, relative."""
        before, now = math.inf, self.period(steps)
        while abs(now / before - 1) > tolerance:
            before, now = now, self.period(steps)
        return now


def rubber_file():
    factor = 2 * (1 + POISSON)
    lines = ['name = "two branches"', 'source = "benches/peers"']
    lines += [f"equilibrium_modulus_mpa = {RELAXED_MODULUS_MPA}", f"poisson_ratio = {POISSON}"]
    for modulus, relaxation_time in zip(SHEAR_MODULI_MPA, RELAXATION_TIMES_S):
        lines += ["[[branches]]", f"modulus_mpa = {factor * modulus}", f"relaxation_time_s = {relaxation_time}"]
    path = FOLDER / "rubber.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def run_asperity(binary, points, pressure):
    options = ["--wave", f"{PERIOD_MM}:{AMPLITUDE_MM}", "--rubber", rubber_file(), "--points", points]
    return solve(binary, *options, "--speed", SPEED_MM_S, "--pressure", repr(pressure))


def check_in_full_contact(binary, pressure):
    """mu = q^2 D^2 E''(q v) / (4 (1 - nu^2) p) when all points touch."""
    turns = [WAVENUMBER * SPEED_MM_S * relaxation_time for relaxation_time in RELAXATION_TIMES_S]
    loss = 2 * (1 + POISSON) * sum(g * w / (1 + w * w) for g, w in zip(SHEAR_MODULI_MPA, turns))
    exact = WAVENUMBER**2 * AMPLITUDE_MM**2 * loss / (4 * (1 - POISSON**2) * pressure)
    march = March(256, pressure)
    coarse, fine = (march.settle(steps, 1e-7) for steps in (1024, 2048))
    ours = run_asperity(binary, 256, pressure)[0]["friction_coefficient"]
    print("Friction in full contact, relative error against the closed form:")
    print(f"Tamaas with 1024 and 2048 steps a period {coarse / exact - 1:+.1e}, {fine / exact - 1:+.1e},")
    extrapolated = 2 * fine - coarse
    print(f"extrapolated to step 0 {extrapolated / exact - 1:+.1e}; asperity {ours / exact - 1:+.1e}\n")
    if abs(extrapolated / exact - 1) > 1e-4:
        raise RuntimeError("not the same problem")


def compare(binary, points, pressure, converged):
    seconds, whole = [], []
    for _ in range(ROUNDS):
        ours, process = run_asperity(binary, points, pressure)
        seconds.append(ours["seconds"])
        whole.append(process)
    ours_error = ours["friction_coefficient"] / converged - 1
    median = statistics.median(seconds)

    start = time.perf_counter()
    march, steps = March(points, pressure), FIRST_STEPS
    while True:
        error = march.settle(steps, abs(ours_error) / 4) / converged - 1
        spent = time.perf_counter() - start
        ratio = f"{spent:.2f} s | {spent / median:.0f}"
        print(f"| {points} | Tamaas, {steps} steps a period | {error:+.1e} | {ratio} |", flush=True)
        if abs(error) <= 2 * abs(ours_error) or spent > LIMIT_SECONDS:
            break
        steps *= 2
    print(f"| {points} | asperity | {ours_error:+.1e} | {median:.5f} s | 1 |")
    print(f"| {points} | asperity, whole process | | {statistics.median(whole):.4f} s | |", flush=True)


def extrapolated(pressure):
    """Tamaas' friction without the first two orders of the step, by Richardson's rule."""
    march = March(EXTRAPOLATED_POINTS, pressure, 1e-9)
    coarse, middle, fine = (march.settle(steps, 1e-6) for steps in (256, 512, 1024))
    return (8 * fine - 6 * middle + coarse) / 3


def main():
    binary = build_asperity()
    full = math.pi * RELAXED_MODULUS_MPA / (1 - POISSON**2) * AMPLITUDE_MM / PERIOD_MM
    # Far above what the stiffest, unrelaxed rubber needs to touch everywhere.
    check_in_full_contact(binary, 50 * full)
    pressure = PRESSURE * full
    converged = run_asperity(binary, CONVERGED_POINTS, pressure)[0]["friction_coefficient"]
    print(f"One thread, Tamaas {VERSIONS['tamaas']} with tolerance {TOLERANCE:.0e}, asperity 1e-10;")
    print(f"friction on {CONVERGED_POINTS} points {converged:.8f}")
    print("| points | | error of friction | seconds | ratio |\n|---|---|---|---|---|")
    for points in map(int, sys.argv[1:] or SIZES):
        compare(binary, points, pressure, converged)
    apart = extrapolated(pressure) / converged - 1
    print(f"\nTamaas on {EXTRAPOLATED_POINTS} points, extrapolated to steps of no length: {apart:+.1e} from asperity's friction")


if __name__ == "__main__":
    inside_environment()
    main()
