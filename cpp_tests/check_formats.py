#!/usr/bin/env python3
"""Checks that all files of one mesh say the same: .msh and .mesh as meshio reads them, and TetGen's .node, .ele, .face and .edge, against the .vtu
and against the domain. Markers and regions must come back as they were given, the volume of each region too.

    check_formats.py path/to/wellspaced
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import meshio
import numpy as np

SIDES = [(0, 1), (1, 2), (2, 3), (3, 0)]


def boxes(markers, regions):
    """Unit boxes upon each other, as many as there are regions or one, with these markers in turn: the .poly file, its points, its facets."""
    floors = max(len(regions), 1) + 1
    points = [(x, y, z) for z in range(floors) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    facets = [tuple(range(4 * z, 4 * z + 4)) for z in range(floors)]
    facets += [(4 * z + i, 4 * z + j, 4 * z + 4 + j, 4 * z + 4 + i) for z in range(floors - 1) for i, j in SIDES]
    marked = [(corners, markers[i % len(markers)]) for i, corners in enumerate(facets)]
    lines = [f"{len(points)} 3 0 1"]
    lines += [f"{i} {x} {y} {z} {-i}" for i, (x, y, z) in enumerate(points)]
    lines += [f"{len(marked)} 1"]
    lines += [f"1 0 {marker}\n4 {' '.join(map(str, corners))}" for corners, marker in marked]
    lines += ["0", str(len(regions))]
    lines += [f"{i} .5 .5 {i + .5} {attribute} 0.01" for i, attribute in enumerate(regions)]
    return "\n".join(lines) + "\n", np.array(points, dtype=float), marked


def table(path):
    """The header and the rows of a file of TetGen's, whose first column counts from 0."""
    header, *rows = [line.split() for line in path.read_text().splitlines()]
    rows = np.array(rows, dtype=float)
    assert len(rows) == int(header[0]), f"{path.name}: count"
    assert np.array_equal(rows[:, 0], np.arange(len(rows))), f"{path.name}: numbers"
    return [int(field) for field in header], rows[:, 1:]


def elements(corners, numbers):
    """Elements whatever their order and that of their corners."""
    return sorted((*sorted(map(int, c)), int(n)) for c, n in zip(corners, numbers, strict=True))


def read_back(mesh, kind, key, number=lambda dimension, tag: tag):
    """All elements of one kind that meshio read, with the numbers that `key` has of them."""
    dimension = {"line": 1, "triangle": 2, "tetra": 3}[kind]
    found = []
    for i, block in enumerate(mesh.cells):
        if block.type == kind:
            numbers = [number(dimension, tag) for tag in mesh.cell_data[key][i]] if key in mesh.cell_data else [0] * len(block.data)
            found += elements(block.data, numbers)
    return sorted(found)


def volumes(points, tetrahedra, references):
    p = points[tetrahedra]
    each = np.sum((p[:, 1] - p[:, 0]) * np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 0]), axis=1) / 6
    assert np.all(each > 0), "orientation"
    return {int(r): each[references == r].sum() for r in np.unique(references)}


def check_points(vtu, corners, facets):
    """The point arrays of the .vtu file are true of the coordinates: what is said to lie on a facet or segment does."""
    kind, element, marker = (vtu.point_data[name] for name in ("kind", "element", "marker"))
    n = len(corners)
    assert np.array_equal(vtu.points[:n], corners) and np.all(kind[:n] == 1), "input points"
    assert np.array_equal(marker[:n], -np.arange(n)), "markers of input points"
    assert np.array_equal(element >= 0, kind >= 2) and np.all(element[kind < 2] == -1), "elements"
    assert (kind == 3).sum() > 10 and (kind == 2).sum() > 3, "points on facets and segments"
    for point, facet, own in zip(vtu.points[kind == 3], element[kind == 3], marker[kind == 3]):
        box = corners[list(facets[facet][0])]
        assert np.all(point >= box.min(axis=0) - 1e-9) and np.all(point <= box.max(axis=0) + 1e-9), "a point is off its facet"
        assert own == facets[facet][1], "marker of a point on a facet"
    for segment in np.unique(element[kind == 2]):
        on = vtu.points[(kind == 2) & (element == segment)]
        # Sides are parallel to the axes, and no two of them have these two coordinates in common and the third in one floor.
        assert np.sum(np.ptp(on, axis=0) < 1e-9) >= 2 and np.all(np.ptp(on, axis=0) < 1), "a point is off its segment"
    return marker


def check(command, folder, name, markers, regions, references):
    text, corners, facets = boxes(markers, regions)
    (folder / "in.poly").write_text(text)
    outputs = [f"--output={name}" for name in ("m.vtu", "m.msh", "m.mesh", "m.edge")]
    arguments = [command, "refine", "in.poly", "-b", "1.5", "--max-edge", "0.4", "--json", *outputs]
    done = subprocess.run(arguments, cwd=folder, check=True, capture_output=True)
    report = json.loads(done.stdout)
    vtu, msh, mesh = (meshio.read(folder / f"m.{ending}") for ending in ("vtu", "msh", "mesh"))

    (cells,) = vtu.cells
    (region,) = vtu.cell_data["region"]
    assert (len(vtu.points), len(cells.data)) == (report["vertices"], report["tetrahedra"])
    marker = check_points(vtu, corners, facets)
    assert set(region) == (set(range(1, len(regions) + 1)) or {0}), "regions"
    by_region = volumes(vtu.points, cells.data, region)
    assert all(abs(volume - 1) < 1e-12 for volume in by_region.values()), by_region
    assert ("attribute" in vtu.cell_data) == bool(regions), "attribute"
    attribute = np.array([0, *regions])[region]

    # TetGen's files.
    header, nodes = table(folder / "m.node")
    assert header[1:] == [3, 0, 1] and np.array_equal(nodes, np.column_stack((vtu.points, marker))), ".node"
    header, rows = table(folder / "m.ele")
    assert header[1:] == [4, int(bool(regions))] and np.array_equal(rows[:, :4], cells.data), ".ele"
    if regions:
        assert np.array_equal(vtu.cell_data["attribute"][0], attribute), "attribute in .vtu"
        assert np.array_equal(rows[:, 4], attribute), "attribute in .ele"
    (_, faces), (_, edges) = table(folder / "m.face"), table(folder / "m.edge")
    faces, edges = elements(faces[:, :3], faces[:, 3]), elements(edges[:, :2], edges[:, 2])
    area = {}
    for *triangle, own in faces:
        a, b, c = vtu.points[triangle]
        area[own] = area.get(own, 0) + np.linalg.norm(np.cross(b - a, c - a)) / 2
    for own, found in area.items():
        assert abs(found - sum(m == own for _, m in facets)) < 1e-9, "area of the facets of a marker"
    assert set(area) == {m for _, m in facets}, "markers of faces"

    # Medit's and gmsh's, in which one number stands for the region.
    tetrahedra = elements(cells.data, np.array([0, *references])[region])
    expected = {"line": edges, "triangle": faces, "tetra": tetrahedra}
    for other, ending in ((mesh, ".mesh"), (msh, ".msh")):
        assert np.array_equal(other.points, vtu.points), f"points of {ending}"
    assert np.array_equal(mesh.point_data["medit:ref"], marker), "markers of points in .mesh"
    names = {(dimension, tag): name for name, (tag, dimension) in msh.field_data.items()}
    assert all(("marker" in name) == (dimension < 3) for (dimension, _), name in names.items()), names

    def marker_of(dimension, tag):
        assert tag > 0, "an element without a physical group"
        name = names.get((dimension, tag))
        return tag if name is None else 0 if name == "no region" else int(name.split()[-1])

    for kind, found in expected.items():
        assert read_back(mesh, kind, "medit:ref") == found, f"{kind} in .mesh"
        assert read_back(msh, kind, "gmsh:physical", marker_of) == found, f"{kind} in .msh"
    grouped = "gmsh:physical" in msh.cell_data
    assert grouped == (any(markers) or bool(regions)), "physical groups"
    print(f"{name}: {len(vtu.points)} points, {len(cells.data)} tetrahedra, {len(faces)} faces and {len(edges)} edges are the same in all files")


def main():
    command = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        for case in (
            ("one box, no markers", [0], [], []),
            ("one box, some markers", [1, 5, 7, 0, 0, 0], [], []),
            ("two boxes, attributes", [-5, 0, 7], [30, 40], [30, 40]),
            ("two boxes, descending attributes", [0], [40, 30], [40, 30]),
            ("two boxes of one attribute", [3], [30, 30], [1, 2]),
            ("two boxes, fractions", [2, -2147483648], [0.5, 2], [1, 2]),
        ):
            check(command, Path(folder), *case)


if __name__ == "__main__":
    main()
