#!/usr/bin/env python3
"""Checks .vtu files with another reader: meshio. What it reads must be the mesh that the command reports, and the
cell data must be what numpy makes of the coordinates.

    check_vtu.py path/to/wellspaced
"""
import json
import subprocess
import sys
import tempfile
from itertools import combinations
from pathlib import Path

import meshio
import numpy as np


def run(*arguments, **options):
    return subprocess.run(arguments, check=True, capture_output=True, text=True, **options).stdout


def radius_edge(p):
    """Circumradius over shortest edge of tetrahedra, an array of shape (n, 4, 3)."""
    u, v, w = (p[:, i] - p[:, 0] for i in (1, 2, 3))
    squares = [np.sum(x * x, axis=1)[:, None] for x in (u, v, w)]
    normal = squares[0] * np.cross(v, w) + squares[1] * np.cross(w, u) + squares[2] * np.cross(u, v)
    radius = np.linalg.norm(normal, axis=1) / (2 * np.sum(u * np.cross(v, w), axis=1))
    edges = [np.linalg.norm(p[:, i] - p[:, j], axis=1) for i, j in combinations(range(4), 2)]
    return radius / np.min(edges, axis=0)


def min_dihedral(p):
    """Smallest dihedral angle in degrees: between the planes through each edge."""
    least = np.full(len(p), np.inf)
    for i, j in combinations(range(4), 2):
        k, l = (m for m in range(4) if m not in (i, j))
        axis = p[:, j] - p[:, i]
        axis = axis / np.linalg.norm(axis, axis=1)[:, None]
        a, b = (p[:, m] - p[:, i] for m in (k, l))
        a, b = (x - np.sum(x * axis, axis=1)[:, None] * axis for x in (a, b))
        cosine = np.sum(a * b, axis=1) / (np.linalg.norm(a, axis=1) * np.linalg.norm(b, axis=1))
        least = np.minimum(least, np.degrees(np.arccos(np.clip(cosine, -1, 1))))
    return least


def check(command, folder, name, bound):
    (folder / f"{name}.poly").write_text(run(command, "dataset", name))
    report = json.loads(
        run(command, "refine", f"{name}.poly", "--radius-edge", str(bound), "--output", "mesh.vtu", "--output",
            "mesh.node", "--json", cwd=folder))
    mesh = meshio.read(folder / "mesh.vtu")
    (cells,) = mesh.cells
    assert cells.type == "tetra", cells.type
    assert len(cells.data) == report["tetrahedra"] > 100
    assert len(mesh.points) == report["vertices"]
    text = (folder / "mesh.node").read_text().split()
    points = np.array(text[4:], dtype=float).reshape(-1, 4)[:, 1:]
    assert np.array_equal(mesh.points, points), "the .node file has other points"

    steiner = mesh.point_data["steiner"]
    assert np.array_equal(steiner, np.arange(len(steiner)) >= report["input_vertices"])

    p = mesh.points[cells.data]
    volumes = np.sum((p[:, 1] - p[:, 0]) * np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0]), axis=1) / 6
    size = np.prod(mesh.points.max(axis=0) - mesh.points.min(axis=0))
    assert np.all(volumes > 0) and abs(volumes.sum() / size - 1) < 1e-12, "volumes"

    (ratios,), (angles,) = mesh.cell_data["radius_edge"], mesh.cell_data["min_dihedral_degrees"]
    assert np.allclose(ratios, radius_edge(p), rtol=1e-6), "radius_edge"
    assert ratios.max() == report["worst_radius_edge"] <= bound * (1 + 1e-12)
    assert np.allclose(angles, min_dihedral(p), rtol=1e-5, atol=1e-5), "min_dihedral_degrees"
    assert angles.min() == report["min_dihedral_degrees"]
    print(f"{name}.vtu at beta {bound}: {len(mesh.points)} points and {len(cells.data)} tetrahedra read back")


def main():
    command = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        for name, bound in (("cube1", 2), ("helix", 4)):
            check(command, Path(folder), name, bound)


if __name__ == "__main__":
    main()
