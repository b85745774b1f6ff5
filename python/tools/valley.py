#!/usr/bin/env python3
"""The maps of data/scenes/valley.toml: a made-up valley that bends once and ends on a flat fan.

python3 python/tools/valley.py [--cell 10] [--depth 8] [FOLDER], writes valley.asc (elevations, m),
valley_release.asc (vertical depths, m) and valley_release.geojson (a region of one depth).
"""

import argparse
import math
import pathlib

LENGTH, WIDTH = 1200.0, 600.0  # m, to the east and to the north
WEST, SOUTH = 640000.0, 5200000.0  # of the lower left corner, as of a metric grid


def centre(x):
    """Northing of the valley's floor."""
    return 300.0 + 60.0 * math.sin(2.0 * math.pi * min(x, 900.0) / 900.0)


def smooth(x):
    t = min(max(x, 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def elevation(x, y):
    # 39 degrees at its head, 2 degrees on the fan
    floor = 350.0 * max(0.0, 1.0 - x / 900.0) ** 2 + 0.035 * (LENGTH - x)
    curvature = (1.0 - smooth((x - 600.0) / 350.0)) / 250.0
    rough = 0.8 * math.sin(x / 11.0) * math.cos(y / 13.0)
    return 1000.0 + floor + 0.5 * curvature * (y - centre(x)) ** 2 + rough


def release(x, y, depth):
    r2 = ((x - 130.0) / 70.0) ** 2 + ((y - centre(130.0)) / 50.0) ** 2
    return depth * max(0.0, 1.0 - r2)


def write(path, cell, value, digits):
    columns, rows = round(LENGTH / cell), round(WIDTH / cell)
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {WEST:.0f}", f"yllcorner {SOUTH:.0f}",
             f"cellsize {cell:g}", "NODATA_value -9999"]
    for row in range(rows):
        y = WIDTH - (row + 0.5) * cell
        lines.append(" ".join(f"{value((i + 0.5) * cell, y):.{digits}f}" for i in range(columns)))
    path.write_text("\n".join(lines) + "\n")


def outline(depth):
    """The same release as a region of one depth, with the same volume but for its corners."""
    corners = [[WEST + 130.0 + 70.0 * math.cos(a), SOUTH + centre(130.0) + 50.0 * math.sin(a)]
               for a in (2.0 * math.pi * k / 32 for k in range(32))]
    ring = ", ".join(f"[{x:.1f}, {y:.1f}]" for x, y in corners + corners[:1])
    return (f'{{"type": "Feature", "properties": {{"depth": {depth / 2:g}}}, '
            f'"geometry": {{"type": "Polygon", "coordinates": [[{ring}]]}}}}\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", default="data/scenes", type=pathlib.Path)
    parser.add_argument("--cell", type=float, default=10.0, help="of the maps, m")
    parser.add_argument("--depth", type=float, default=8.0, help="largest of the release, m")
    given = parser.parse_args()
    write(given.folder / "valley.asc", given.cell, elevation, 2)
    write(given.folder / "valley_release.asc", given.cell,
          lambda x, y: release(x, y, given.depth), 2)
    (given.folder / "valley_release.geojson").write_text(outline(given.depth))


if __name__ == "__main__":
    main()
