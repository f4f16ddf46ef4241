"""Smallest eigenpairs by SciPy's eigsh (ARPACK, shift-invert), as a reference for dgp-sparse.

    python eigsh.py eigenpairs-COUNT INPUT [--repeat N]

INPUT is a raw mesh of triangles; see protocol.hpp. L has cotangent weights, M is lumped: a third of the
area around each vertex. Prints one JSON object: milliseconds of wall time and of processors, the largest
residual |L x - lambda M x| / ((lambda + sigma) |M x|), the departure from orthogonality, the last
eigenvalue. The shift is the one of dgp-sparse, 4 pi / area for a cotangent Laplacian.

Tried with the versions in eigsh.requirements.txt.
"""

import json
import resource
import sys
import time

import numpy
import scipy.sparse
import scipy.sparse.linalg


def read(path):
    """Points and triangles."""
    data = open(path, "rb").read()
    vertices, faces, corners = numpy.frombuffer(data, "<u8", 3).astype(int)
    if corners != 3 * faces:
        raise SystemExit("not only triangles")
    points = numpy.frombuffer(data, "<f8", 3 * vertices, 24).reshape(-1, 3)
    start = 24 + 24 * vertices + 4 * (faces + 1)
    return points, numpy.frombuffer(data, "<u4", corners, start).reshape(-1, 3).astype(int)


def assemble(points, triangles):
    """The cotangent Laplacian and the lumped mass."""
    n = len(points)
    normal = numpy.cross(
        points[triangles[:, 1]] - points[triangles[:, 0]],
        points[triangles[:, 2]] - points[triangles[:, 0]],
    )
    double_area = numpy.linalg.norm(normal, axis=1)
    laplacian = scipy.sparse.csc_array((n, n))
    for corner in range(3):
        a, b, c = (triangles[:, (corner + i) % 3] for i in range(3))
        dot = ((points[b] - points[a]) * (points[c] - points[a])).sum(axis=1)
        half = 0.5 * dot / double_area
        rows, columns = numpy.concatenate([b, c, b, c]), numpy.concatenate([c, b, b, c])
        values = numpy.concatenate([-half, -half, half, half])
        laplacian = laplacian + scipy.sparse.coo_array((values, (rows, columns)), (n, n)).tocsc()
    masses = numpy.bincount(triangles.ravel(), numpy.repeat(double_area / 6, 3), n)
    return laplacian, scipy.sparse.diags_array(masses).tocsc()


def main():
    count = int(sys.argv[1].removeprefix("eigenpairs-"))
    repeat = int(sys.argv[4]) if sys.argv[3:4] == ["--repeat"] else 1
    laplacian, mass = assemble(*read(sys.argv[2]))
    weight = laplacian.diagonal().mean() / (2 * 3**0.5)
    shift = 4 * numpy.pi * weight / mass.sum()
    wall, processor = [], []
    for _ in range(repeat):
        start = time.perf_counter(), time.process_time()
        values, vectors = scipy.sparse.linalg.eigsh(laplacian, k=count, M=mass, sigma=-shift)
        wall.append(1e3 * (time.perf_counter() - start[0]))
        processor.append(1e3 * (time.process_time() - start[1]))
    weighted = mass @ vectors
    rest = laplacian @ vectors - weighted * values
    sizes = (abs(values) + shift) * numpy.linalg.norm(weighted, axis=0)
    print(json.dumps({
        "ms": wall,
        "cpu_ms": processor,
        "residual": (numpy.linalg.norm(rest, axis=0) / sizes).max(),
        "orthogonality": abs(vectors.T @ weighted - numpy.eye(count)).max(),
        "last": max(values),
        "peak_bytes": 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss,
    }))


main()
