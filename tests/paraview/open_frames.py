"""open_frames.py RESULT...: what ParaView's own reader finds in the frames of a run, against what the run
has written elsewhere: series.csv and summary.json."""
import csv
import json
import os
import sys

import numpy
from paraview import simple
from vtkmodules.numpy_interface import dataset_adapter
from vtkmodules.util.numpy_support import vtk_to_numpy

ALWAYS = {
    "body": 1, "density_kg_per_m3": 1, "pressure_Pa": 1, "mises_Pa": 1, "shear_rate_per_s": 1,
    "volume_strain": 1, "point": 1, "velocity_m_per_s": 3, "displacement_m": 3, "stress_Pa": 6,
}
GRAINS = {"specific_volume": 1, "inertial_number": 1}
MORE = {
    "clay": {"p_c_Pa": 1, "rho_sep_kg_per_m3": 1, "specific_volume": 1},
    "grains": {**GRAINS, "shear_strain": 1},
    "both": {**GRAINS, "ln_p_c_rest": 1, "rho_sep_kg_per_m3": 1},
    "water": {},
    "space": GRAINS,
}


def require(holds, what):
    if not holds:
        sys.exit(f"{result}: {what}")


def opened(series, rows):
    source = simple.OpenDataFile(series)
    times = list(source.TimestepValues)
    require(numpy.allclose(times, [row["time_s"] for row in rows], rtol=0.0, atol=1e-12), f"times {times}")
    return source


def open_grid(series, rows, summary, in_space):
    """The frames of the grid: an image of the box whose nodes hold the mass and momentum of the points."""
    source = opened(series, rows)
    h, size = summary["input"]["grid"]["h"], summary["input"]["domain"]["size"]
    nodes = [round(length / h) + 1 for length in size]
    nodes = nodes if in_space else [1, *nodes]  # in the plane the image's axes are z, x, y
    mass_name, row_name = ("mass_kg", "mass_kg") if in_space else ("mass_kg_per_m", "mass_kg_per_m")
    for row in rows:
        source.UpdatePipeline(row["time_s"])
        image = simple.servermanager.Fetch(source)
        require(image.IsA("vtkImageData"), f"the grid is a {image.GetClassName()}")
        require(list(image.GetDimensions()) == nodes, f"{image.GetDimensions()} nodes, not {nodes}")
        require(image.GetOrigin() == (0.0, 0.0, 0.0) and image.GetSpacing() == (h, h, h), "where the grid lies")
        data = image.GetPointData()
        fields = {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
        shapes = {name: field.shape[1:] for name, field in fields.items()}
        require(shapes == {mass_name: (), "velocity_m_per_s": (3,)}, f"fields of the grid {shapes}")
        mass, velocity = fields[mass_name], fields["velocity_m_per_s"]
        require(numpy.all(velocity[mass == 0.0] == 0.0), "velocity without mass")
        if row["time_s"] == 0.0:
            require(not mass.any(), "mass before the first step")
            continue
        # sums of fewer than 2e5 positive terms each, in another order
        require(abs(mass.sum() / row[row_name] - 1.0) <= 2e5 * 2.0**-52, f"mass {mass.sum()}")
        # x runs fastest: what has mass lies in front of the front, within the two cells of a node's reach
        places = numpy.array([image.GetPoint(i) for i in numpy.flatnonzero(mass)])
        far = numpy.hypot(places[:, 0], places[:, 2]) if in_space else places[:, 0]
        reach = 2.0 * h * (numpy.sqrt(2.0) if in_space else 1.0)
        require(0.0 <= row["front_max_m"] + reach - far.max() <= 2.0 * reach, f"grid up to {far.max()}")


for result in sys.argv[1:]:
    kind = os.path.basename(result)
    with open(os.path.join(result, "series.csv"), encoding="utf-8") as file:
        rows = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    with open(os.path.join(result, "summary.json"), encoding="utf-8") as file:
        summary = json.load(file)
    frames = os.path.join(result, "frames")
    series = sorted(name for name in os.listdir(frames) if name.endswith(".hdf.series"))
    name = summary["name"]
    require(series == [f"{name}.hdf.series", f"{name}_grid.hdf.series"], f"has the series {series}")
    source = opened(os.path.join(frames, series[0]), rows)
    times = list(source.TimestepValues)
    for time, row in zip(times, rows):
        source.UpdatePipeline(time)
        data = dataset_adapter.WrapDataObject(simple.servermanager.Fetch(source))
        places = vtk_to_numpy(data.VTKObject.GetPoints().GetData())
        require(len(places) == summary["points"], f"{len(places)} points at {time}")
        require(data.VTKObject.GetNumberOfCells() == len(places), "a cell for every point")
        fields = {name: numpy.asarray(data.PointData[name]) for name in data.PointData.keys()}
        shapes = {name: 1 if field.ndim == 1 else field[0].size for name, field in fields.items()}
        require(shapes == {**ALWAYS, **MORE[kind]}, f"fields {shapes}")
        # the program writes text that reads back as the same number, and positions as they are
        far = numpy.hypot(places[:, 0], places[:, 2]) if kind == "space" else places[:, 0]
        require(abs(far.max() - row["front_max_m"]) <= 1e-12, f"front {far.max()} at {time}")
        density = fields["density_kg_per_m3"]
        require(density.min() == row["density_min"] and density.max() == row["density_max"], f"density at {time}")
        require(sorted(fields["point"]) == list(range(len(places))), "numbers of points")
        for name, field in fields.items():
            undefined = fields["pressure_Pa"] <= 0.0 if name == "inertial_number" else numpy.zeros(len(places), bool)
            require(numpy.all(numpy.isfinite(field[~undefined])), f"{name} is not finite at {time}")
        if time == 0.0:
            start = {int(p): (place, d) for p, place, d in zip(fields["point"], places, density)}
        moved = numpy.array([start[int(p)][0] for p in fields["point"]]) + fields["displacement_m"]
        require(numpy.abs(moved - places).max() <= 1e-15, f"displacement at {time}")
        denser = numpy.log(density / numpy.array([start[int(p)][1] for p in fields["point"]]))
        require(numpy.abs(denser - fields["volume_strain"]).max() <= 1e-14, f"volume strain at {time}")
        trace = -fields["stress_Pa"].reshape(len(places), -1)
        axes = [0, 1, 2] if trace.shape[1] == 6 else [0, 4, 8]
        p = trace[:, axes].mean(axis=1)
        require(numpy.abs(p - fields["pressure_Pa"]).max() <= 1e-12 * numpy.abs(trace).max(), f"p at {time}")
    open_grid(os.path.join(frames, series[1]), rows, summary, kind == "space")
    print(f"{kind}: {len(times)} frames, {len(places)} points, {len(fields)} fields")
