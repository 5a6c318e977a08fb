"""The matrices of `cargo bench --bench factor -- --export FOLDER`, factored by SciPy's SuperLU.

    python3 factor.py FOLDER

Needs scipy. Processor time of one factorisation and three right sides, one thread; of three runs the least.
"""

import os
import sys
import time

for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ[name] = "1"

import numpy
import scipy
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu


def matrix(path):
    counts = numpy.fromfile(path, dtype="<u8", count=2)
    size, entries = (int(count) for count in counts)
    whole = numpy.fromfile(path, dtype="<u8")
    starts = whole[2 : 3 + size].astype(numpy.int64)
    columns = whole[3 + size : 3 + size + entries].astype(numpy.int64)
    values = whole[3 + size + entries :].view("<f8")
    lower = csr_matrix((values, columns, starts), shape=(size, size))
    diagonal = scipy.sparse.diags(lower.diagonal())
    return (lower + lower.T - diagonal).tocsc()


def once(whole, right):
    start = time.process_time()
    factor = splu(whole, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    solution = numpy.column_stack([factor.solve(column) for column in right.T])
    return time.process_time() - start, factor.L.nnz, solution


def main(folder):
    print(f"SciPy {scipy.__version__}, SuperLU with minimum degree of A + A', symmetric mode")
    print("| matrix | unknowns | s | entries of L and U, MB | residual |\n|---|---|---|---|---|")
    names = sorted(os.listdir(folder), key=lambda name: os.path.getsize(os.path.join(folder, name)))
    for name in names:
        whole = matrix(os.path.join(folder, name))
        size = whole.shape[0]
        right = numpy.sin(numpy.arange(3 * size, dtype=float)).reshape(3, size).T
        runs = [once(whole, right) for _ in range(3 if size < 50000 else 1)]
        seconds = min(run[0] for run in runs)
        _, entries, solution = runs[0]
        rest = abs(whole @ solution - right).max() / abs(right).max()
        print(f"| {name[:-4]} | {size} | {seconds:.3f} | {2 * entries * 8e-6:.0f} | {rest:.1e} |")


if __name__ == "__main__":
    main(sys.argv[1])
