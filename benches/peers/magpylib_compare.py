#!/usr/bin/env python3
"""Fields of magnetic sources against magpylib on this machine, one thread each.

    pip install magpylib
    cargo build --release -p lbm-ibm-benches --bin speed
    python benches/peers/magpylib_compare.py [--points 1000000] [--rounds 3]

Points are scattered over a cube of 6 mm about a magnet of 2 x 1.2 x 1.6 mm, a loop or a ball of radius 1 mm. magpylib gives B
alone, so two things are compared: B against its getB, and B with its gradient against getB at seven points, the point and one
step to each side along each axis. A charged sheet is two of magpylib's triangles. The two run in turn, so that both see the same
state of the machine; magpylib is given its points in one call.
"""
import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import statistics
import subprocess
import time
from pathlib import Path

import magpylib as magpy
import numpy as np

MM = 1e-3
STEP = 1e-6


def sheet():
    """A charged rectangle of half edges 1 and 0.6 mm as two triangles."""
    a, b = 1.0 * MM, 0.6 * MM
    corners = np.array([[-a, -b, 0], [a, -b, 0], [a, b, 0], [-a, b, 0]])
    triangle = magpy.misc.Triangle
    return magpy.Collection(triangle(vertices=corners[[0, 1, 2]], polarization=(0, 0, 1)),
                            triangle(vertices=corners[[0, 2, 3]], polarization=(0, 0, 1)))


SIZE = (2.0 * MM, 1.2 * MM, 1.6 * MM)
SOURCES = {
    "sheet": sheet,
    "cuboid along z": lambda: magpy.magnet.Cuboid(dimension=SIZE, polarization=(0, 0, 1)),
    "cuboid": lambda: magpy.magnet.Cuboid(dimension=SIZE, polarization=(0.3, -0.4, 1)),
    "dipole": lambda: magpy.misc.Dipole(moment=(0, 0, 1e-3)),
    "sphere": lambda: magpy.magnet.Sphere(diameter=2 * MM, polarization=(0, 0, 1)),
    "loop": lambda: magpy.current.Circle(diameter=2 * MM, current=MM / (4e-7 * np.pi)),
}


def ns_per_point(source, points):
    start = time.perf_counter()
    source.getB(points)
    return 1e9 * (time.perf_counter() - start) / len(points)


def ns_with_gradient(source, points):
    start = time.perf_counter()
    steps = np.concatenate([np.zeros((1, 3)), STEP * np.eye(3), -STEP * np.eye(3)])
    field = source.getB((points[None] + steps[:, None]).reshape(-1, 3)).reshape(7, -1, 3)
    (field[1:4] - field[4:7]) / (2 * STEP)
    return 1e9 * (time.perf_counter() - start) / len(points)


def ours(binary, points, seconds):
    command = [binary, "field", "--points", points, "--threads", 1, "--seconds", seconds, "--json", "-"]
    out = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    return {(row["source"], row["gradient"]): row["ns_per_point"] for row in json.loads(out)}


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=0.2)
    parser.add_argument("--binary", type=Path, default=root / "target" / "release" / "speed")
    options = parser.parse_args()

    points = np.random.default_rng(1).uniform(-3 * MM, 3 * MM, (options.points, 3))
    # Seven times the points at once would not fit a small machine's cache or memory: a tenth of them, in one call.
    fewer = points[: max(1, options.points // 10)]
    pairs = {(name, gradient): [] for name in SOURCES for gradient in (False, True)}
    for _ in range(options.rounds):
        mine = ours(options.binary, options.points, options.seconds)
        for name, make in SOURCES.items():
            source = make()
            pairs[name, False].append((mine[name, False], ns_per_point(source, points)))
            pairs[name, True].append((mine[name, True], ns_with_gradient(source, fewer)))
    print(f"magpylib {magpy.__version__}, {options.points} points, medians of {options.rounds} rounds, ns a point")
    for (name, gradient), times in pairs.items():
        what = "B and gradient" if gradient else "B"
        a, b = (statistics.median(column) for column in zip(*times))
        ratio = statistics.median(theirs / our for our, theirs in times)
        print(f"{name:15} {what:15} lbm-ibm {a:8.1f}   magpylib {b:9.1f}   ratio {ratio:6.1f}", flush=True)


if __name__ == "__main__":
    main()
