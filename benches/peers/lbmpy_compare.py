#!/usr/bin/env python3
"""The bare fluid against lbmpy on this machine: D3Q19, TRT (magic 3/16), in place, single steps and sweeps, without
a force or, with --force, under a uniform one (second order: Guo).

    pip install lbmpy py-cpuinfo
    cargo build --release -p lbm-ibm-benches --bin speed
    python benches/peers/lbmpy_compare.py [--sizes 64 128 256] [--precision f64 f32] [--threads 1 2] [--rounds 5]
        [--streaming aa] [--force] [--json FILE]

The two run in turn, a second each, so that both see the same state of the machine; of all rounds each has its best, which a
busy machine disturbs least. lbmpy runs its kernel alone on a box with one ghost layer, without the exchange that makes it
periodic, as in its own benchmarks; ours is periodic. It has single steps only; our sweeps take eight at a time.
"""
import argparse
import json
import subprocess
import time
from pathlib import Path

import numpy as np
import pystencils as ps
from lbmpy import ForceModel, LBMConfig, LBMOptimisation, LBStencil, Method, Stencil, create_lb_update_rule
from lbmpy.advanced_streaming import Timestep

NUMPY = {"f64": np.float64, "f32": np.float32}
OURS = {False: "no force", True: "uniform force"}


def kernels(streaming, force, precision, threads):
    """The even and the odd step, compiled."""
    stencil = LBStencil(Stencil.D3Q19)
    dtype = np.dtype(NUMPY[precision]).name
    pdfs = ps.fields(f"pdfs({stencil.Q}): {dtype}[3D]", layout="fzyx")
    forced = {"force": (1e-6, 0, 0), "force_model": ForceModel.GUO} if force else {}
    for step in (Timestep.EVEN, Timestep.ODD):
        config = LBMConfig(stencil=stencil, method=Method.TRT, relaxation_rate=1 / 0.8, compressible=False,
                           zero_centered=True, streaming_pattern=streaming, timestep=step, **forced)
        rule = create_lb_update_rule(lbm_config=config,
                                     lbm_optimisation=LBMOptimisation(symbolic_field=pdfs, cse_global=True))
        target = ps.CreateKernelConfig(target=ps.Target.CurrentCPU, default_dtype=dtype)
        target.cpu.openmp.enable = True
        target.cpu.openmp.num_threads = threads
        target.cpu.vectorize.enable = True
        target.cpu.vectorize.assume_inner_stride_one = True
        yield ps.create_kernel(rule, target).compile()


def populations(n, precision):
    """A box of n^3 nodes and one ghost layer, x fastest, rows that begin on a cache line."""
    dtype = np.dtype(NUMPY[precision])
    line = 64 // dtype.itemsize
    shape = (19, n + 2, n + 2, n + 2 * line)
    count = int(np.prod(shape))
    raw = np.zeros(count + line, dtype)
    start = (-raw.ctypes.data % 64) // dtype.itemsize
    box = raw[start:start + count].reshape(shape)
    return box[..., line - 1:line + n + 1].transpose(3, 2, 1, 0)


def lbmpy_mlups(even, odd, pdfs, seconds):
    nodes = (pdfs.shape[0] - 2) ** 3
    rates, begin = [], time.perf_counter()
    while time.perf_counter() - begin < seconds or len(rates) < 5:
        start = time.perf_counter()
        even(pdfs=pdfs)
        odd(pdfs=pdfs)
        rates.append(2e-6 * nodes / (time.perf_counter() - start))
    return max(rates)


def our_mlups(binary, force, size, precision, threads, seconds):
    command = [binary, "fluid", "--size", size, "--precision", precision, "--collision", "trt", "--threads", threads,
               "--seconds", seconds, "--json", "-"]
    out = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    best = {case["case"]: case["best_mlups"] for case in json.loads(out)}
    return best[f"{OURS[force]}, steps"], best[f"{OURS[force]}, sweeps"]


def compare(options, size, precision, threads):
    even, odd = kernels(options.streaming, options.force, precision, threads)
    pdfs = populations(size, precision)
    lbmpy_mlups(even, odd, pdfs, 0.0)
    theirs = steps = sweeps = 0.0
    for _ in range(options.rounds):
        theirs = max(theirs, lbmpy_mlups(even, odd, pdfs, options.seconds))
        ours = our_mlups(options.binary, options.force, size, precision, threads, options.seconds)
        steps, sweeps = max(steps, ours[0]), max(sweeps, ours[1])
    return {"size": size, "precision": precision, "threads": threads, "lbmpy": theirs, "steps": steps, "sweeps": sweeps,
            "ratio_steps": steps / theirs, "ratio_sweeps": sweeps / theirs}


def main():
    root = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=int, nargs="+", default=[64, 128, 256])
    parser.add_argument("--precision", nargs="+", default=["f64", "f32"], choices=["f64", "f32"])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--streaming", default="aa", choices=["aa", "esotwist", "esopull"])
    parser.add_argument("--force", action="store_true", help="a uniform force on both")
    parser.add_argument("--binary", type=Path, default=root / "target" / "release" / "speed")
    parser.add_argument("--json", type=Path, help="write the rows to a file as well")
    options = parser.parse_args()

    rows = []
    print("size  bits threads   lbmpy   steps  sweeps   MLUPS; ratio: steps sweeps")
    for precision in options.precision:
        for threads in options.threads:
            for size in options.sizes:
                row = compare(options, size, precision, threads)
                rows.append(row)
                print("{size:4}  {precision}  {threads:7} {lbmpy:7.1f} {steps:7.1f} {sweeps:7.1f}"
                      "          {ratio_steps:10.2f} {ratio_sweeps:6.2f}".format(**row), flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
