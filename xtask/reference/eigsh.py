"""Smallest eigenpairs by SciPy's eigsh (ARPACK, shift-invert), as a reference for dgp-sparse.

    OPENBLAS_NUM_THREADS=1 python eigsh.py LAPLACIAN.mtx MASS.mtx COUNT...

reads two Matrix Market files and prints a line of JSON per count: CPU seconds, the largest residual
|L x - lambda M x| / ((lambda + sigma) |M x|), the departure from orthogonality, the last eigenvalue.
The shift is the one of dgp-sparse, 4 pi / area for a cotangent Laplacian.

Tried with the versions in eigsh.requirements.txt.
"""

import json
import sys
import time

import numpy
import scipy.io
import scipy.sparse
import scipy.sparse.linalg


def main():
    laplacian = scipy.sparse.csc_array(scipy.io.mmread(sys.argv[1]))
    mass = scipy.sparse.csc_array(scipy.io.mmread(sys.argv[2]))
    weight = laplacian.diagonal().mean() / (2 * 3**0.5)
    shift = 4 * numpy.pi * weight / mass.sum()
    for count in map(int, sys.argv[3:]):
        start = time.process_time()
        values, vectors = scipy.sparse.linalg.eigsh(laplacian, k=count, M=mass, sigma=-shift)
        seconds = time.process_time() - start
        weighted = mass @ vectors
        rest = laplacian @ vectors - weighted * values
        sizes = (abs(values) + shift) * numpy.linalg.norm(weighted, axis=0)
        residuals = numpy.linalg.norm(rest, axis=0) / sizes
        gram = vectors.T @ weighted - numpy.eye(count)
        print(json.dumps({
            "rows": laplacian.shape[0],
            "count": count,
            "cpu_seconds": seconds,
            "residual": residuals.max(),
            "orthogonality": abs(gram).max(),
            "last": max(values),
        }), flush=True)


main()
