#!/usr/bin/env python3
"""Draws the vertices of refined meshes side by side, circumcentre insertion, the paper's rule and ours, like
Figures 6 and 7 of the paper.

    figure.py FOLDER FIGURE.png

FOLDER holds NAME-RULE.vtu for the data sets cube1, helix, ellipsoid and the rules circumcenter, paper, sparse.
"""
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import meshio
import numpy as np
from matplotlib.colors import LinearSegmentedColormap

RULES = {"circumcenter": "circumcentre insertion", "paper": "the paper's rule", "sparse": "sparse, the default"}
INPUT = "#111111"
# Steiner points from near to far.
DEPTH = LinearSegmentedColormap.from_list("depth", ["#b5300e", "#e8743b", "#f3c3a1"])


def rotation(azimuth, elevation):
    """Rows: right, up, towards the viewer."""
    a, e = np.radians([azimuth, elevation])
    right = [-np.sin(a), np.cos(a), 0]
    towards = [np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)]
    return np.array([right, np.cross(towards, right), towards])


def log_radius(p):
    """Draws the distance from the centre on a logarithmic scale: all sizes of a wide grading can be seen."""
    r = np.linalg.norm(p, axis=1)[:, None]
    return p / np.maximum(r, 1e-300) * np.log2(1 + r)


def cube1(points):
    return log_radius(points), np.ones(len(points), bool)


def helix(points):
    return points, (np.abs(points[:, 2]) < 0.24) & (np.abs(points[:, :2]).max(axis=1) < 0.42)


def ellipsoid(points):
    return points, np.all(np.abs(points) < [0.95, 0.07, 0.55], axis=1)


VIEWS = {
    "cube1": ("Cube1: two points at distance 1 in a cube of side 100,000\n(distance from the centre on a log scale)",
              cube1, (25, 20), 26),
    "helix": ("Helix: two near strands,\nzoomed in on three of ten turns", helix, (20, 24), 9),
    "ellipsoid": ("Ellipsoid: 10,000 points,\na slice through the middle", ellipsoid, (-90, 0), 9),
}


def draw(axes, points, steiner, view, size):
    _, place, (azimuth, elevation), _ = view
    placed, shown = place(points)
    x, y, depth = rotation(azimuth, elevation) @ placed[shown].T
    added = steiner[shown].astype(bool)
    near = (depth - depth.min()) / max(np.ptp(depth), 1e-300)
    order = np.argsort(depth)
    for layer, colour in ((added, None), (~added, INPUT)):
        chosen = order[layer[order]]
        axes.scatter(x[chosen], y[chosen], s=size * (0.5 + 0.5 * near[chosen]), linewidths=0,
                     c=colour if colour else DEPTH(1 - near[chosen]))
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color("#cccccc")
    return x, y


def main():
    folder, figure = Path(sys.argv[1]), sys.argv[2]
    heights = [1, 0.75, 0.6]
    plot, grid = plt.subplots(len(VIEWS), len(RULES), figsize=(14, 12.6), gridspec_kw={"height_ratios": heights})
    for row, (name, view) in zip(grid, VIEWS.items()):
        limits = []
        for axes, (rule, title) in zip(row, RULES.items()):
            mesh = meshio.read(folder / f"{name}-{rule}.vtu")
            steiner = mesh.point_data["steiner"]
            limits.append(draw(axes, mesh.points, steiner, view, view[3]))
            count = sum(len(cells.data) for cells in mesh.cells)
            axes.set_title(f"{title}\n{steiner.sum():,} Steiner points, {count:,} tetrahedra", fontsize=10)
        x, y = (np.concatenate(parts) for parts in zip(*limits))
        for axes in row:
            axes.set_xlim(x.min() - 0.03 * np.ptp(x), x.max() + 0.03 * np.ptp(x))
            axes.set_ylim(y.min() - 0.03 * np.ptp(y), y.max() + 0.03 * np.ptp(y))
        row[0].set_ylabel(view[0], fontsize=9)
    plot.suptitle("Output vertices at radius-edge bound 4: input black, Steiner points orange", fontsize=13)
    plot.tight_layout(rect=(0, 0, 1, 0.985))
    plot.savefig(figure, dpi=110)


if __name__ == "__main__":
    main()
