#!/usr/bin/env python3
"""The bare fluid against lbmpy on this machine: D3Q19, TRT (magic 3/16), f64, in place, no force.

    pip install lbmpy py-cpuinfo
    cargo build --release -p lbm-ibm-benches --bin speed
    python benches/peers/lbmpy_compare.py [--size 128] [--threads 1] [--rounds 5] [--streaming aa]

The two run in turn, a second each, so that both see the same state of the machine. lbmpy runs its kernel alone on a box
with one ghost layer, without the exchange that makes it periodic, as in its own benchmarks; ours is periodic.
"""
import argparse
import json
import statistics
import subprocess
import time
from pathlib import Path

import numpy as np
import pystencils as ps
from lbmpy import LBMConfig, LBMOptimisation, LBStencil, Method, Stencil, create_lb_update_rule
from lbmpy.advanced_streaming import Timestep

LINE = 64 // 8  # numbers in a cache line


def kernels(streaming, threads):
    """The even and the odd step, compiled."""
    stencil = LBStencil(Stencil.D3Q19)
    pdfs = ps.fields(f"pdfs({stencil.Q}): float64[3D]", layout="fzyx")
    for step in (Timestep.EVEN, Timestep.ODD):
        config = LBMConfig(stencil=stencil, method=Method.TRT, relaxation_rate=1 / 0.8, compressible=False,
                           zero_centered=True, streaming_pattern=streaming, timestep=step)
        rule = create_lb_update_rule(lbm_config=config,
                                     lbm_optimisation=LBMOptimisation(symbolic_field=pdfs, cse_global=True))
        target = ps.CreateKernelConfig(target=ps.Target.CurrentCPU, default_dtype="float64")
        target.cpu.openmp.enable = True
        target.cpu.openmp.num_threads = threads
        target.cpu.vectorize.enable = True
        target.cpu.vectorize.assume_inner_stride_one = True
        yield ps.create_kernel(rule, target).compile()


def populations(n):
    """A box of n^3 nodes and one ghost layer, x fastest, rows that begin on a cache line."""
    shape = (19, n + 2, n + 2, n + 2 * LINE)
    count = int(np.prod(shape))
    raw = np.zeros(count + LINE)
    start = (-raw.ctypes.data % 64) // 8
    box = raw[start:start + count].reshape(shape)
    return box[..., LINE - 1:LINE + n + 1].transpose(3, 2, 1, 0)


def lbmpy_mlups(even, odd, pdfs, seconds):
    nodes = (pdfs.shape[0] - 2) ** 3
    rates, begin = [], time.perf_counter()
    while time.perf_counter() - begin < seconds or len(rates) < 5:
        start = time.perf_counter()
        even(pdfs=pdfs)
        odd(pdfs=pdfs)
        rates.append(2e-6 * nodes / (time.perf_counter() - start))
    return statistics.median(rates)


def our_mlups(binary, size, threads, seconds):
    command = [binary, "fluid", "--size", size, "--threads", threads, "--seconds", seconds, "--json", "-"]
    out = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    return next(case["mlups"] for case in json.loads(out) if case["case"] == "periodic")


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--streaming", default="aa", choices=["aa", "esotwist", "esopull"])
    parser.add_argument("--binary", type=Path, default=root / "target" / "release" / "speed")
    options = parser.parse_args()

    even, odd = kernels(options.streaming, options.threads)
    pdfs = populations(options.size)
    lbmpy_mlups(even, odd, pdfs, 0.0)
    pairs = []
    for _ in range(options.rounds):
        theirs = lbmpy_mlups(even, odd, pdfs, options.seconds)
        ours = our_mlups(options.binary, options.size, options.threads, options.seconds)
        pairs.append((ours, theirs))
        print(f"lbm-ibm {ours:7.1f} MLUPS   lbmpy {theirs:7.1f} MLUPS   ratio {ours / theirs:.2f}", flush=True)
    ratio = statistics.median(a / b for a, b in pairs)
    print(f"{options.size}^3, {options.threads} thread(s), {options.streaming}: median ratio {ratio:.2f}")


if __name__ == "__main__":
    main()
