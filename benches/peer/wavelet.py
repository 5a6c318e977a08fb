"""The fast wavelet transform of PyWavelets over the lengths of `cargo bench --bench wavelet`.

    python3 wavelet.py

Needs numpy and PyWavelets. All levels of three columns of numbers, periodic, by the biorthogonal splines `bior3.9`, a
filter bank of fixed coefficients for evenly spaced samples; processor time of one thread, of five runs the least.
"""

import os
import time

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import numpy
import pywt


def once(columns):
    start = time.process_time()
    for column in columns:
        pywt.wavedec(column, "bior3.9", mode="periodization")
    return time.process_time() - start


def main():
    print(f"PyWavelets {pywt.__version__}")
    for log in (10, 12, 14, 16, 18, 20):
        i = numpy.arange(1 << log, dtype=float)
        columns = (i, numpy.sin(i), numpy.cos(1.7 * i))
        repeats = max(1, (1 << 16) >> log)
        least = min(sum(once(columns) for _ in range(repeats)) / repeats for _ in range(5))
        print(f"{1 << log:8d}  {1e3 * least:9.3f} ms  {1e9 * least / (1 << log):7.1f} ns a point")


main()
