"""The usual picture of a run in ParaView: points as large as the material that they carry, coloured by a
field, seen from the front in the plane and from above the corner in space, with the time beside them.

    pvpython scripts/paraview_view.py results/flat_mu_i                      an interactive window
    pvbatch  scripts/paraview_view.py results/flat_mu_i -o end.png          the last frame as a picture
    pvbatch  scripts/paraview_view.py results/flat_mu_i -c shear_strain -t 0.3 -o strain.png
    paraview --script=scripts/paraview_view.py                               on the series that is open

In a session where a series of frames is open already (File, Open, NAME.hdf.series; Tools, Python Shell, Run
Script), it arranges that one.
"""
import argparse
import glob
import os
import sys

from paraview import simple
from vtkmodules.numpy_interface import dataset_adapter
from vtkmodules.util.numpy_support import vtk_to_numpy
import numpy


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("result", nargs="?", help="result folder of `repose run`, or a .hdf.series file")
    parser.add_argument("-c", "--colour", default="velocity_m_per_s", help="field to colour by")
    parser.add_argument("-t", "--time", type=float, help="of the picture [s]; the nearest frame; default: the last")
    parser.add_argument("-o", "--output", help="picture (.png) to write")
    return parser.parse_args(sys.argv[1:])


def series_of(result):
    if result.endswith(".series"):
        return result
    found = glob.glob(os.path.join(glob.escape(result), "frames", "*.hdf.series"))
    grids = {name.replace(".hdf.series", "_grid.hdf.series") for name in found}
    found = [name for name in found if name not in grids]  # what is drawn is the points
    if len(found) != 1:
        sys.exit(f"{result}: there is no frames/NAME.hdf.series; the run has output.frame_interval = 0?")
    return found[0]


def opened(given):
    """The frames as a source of the pipeline."""
    if given.result is None:
        source = simple.GetActiveSource()
        if source is None:
            sys.exit("name a result folder, or open a .hdf.series first and select it")
        return source
    # reads one VTKHDF file per moment, all that the series names
    return simple.OpenDataFile(os.path.abspath(series_of(given.result)))


def arrays(source):
    data = dataset_adapter.WrapDataObject(simple.servermanager.Fetch(source))
    return vtk_to_numpy(data.VTKObject.GetPoints().GetData()), data.PointData


def spacing(places):
    """Distance between neighbouring points at the start: of the first point to the nearest."""
    away = numpy.linalg.norm(places[1:] - places[0], axis=1)
    return float(away.min()) if len(away) else 0.01


def arrange(source, given):
    scene = simple.GetAnimationScene()
    scene.UpdateAnimationUsingDataTimeSteps()
    times = list(source.TimestepValues)
    view = simple.GetActiveViewOrCreate("RenderView")
    scene.AnimationTime = times[0]
    source.UpdatePipeline(times[0])
    start, fields = arrays(source)
    if given.colour not in fields.keys():
        sys.exit(f"the frames have no field {given.colour}; there are {', '.join(sorted(fields.keys()))}")
    in_space = bool(numpy.ptp(start[:, 2]) > 0.0)

    points = simple.Show(source, view)
    points.SetRepresentationType("Point Gaussian")
    points.ShaderPreset = "Sphere" if in_space else "Plain circle"
    points.GaussianRadius = 0.6 * spacing(start)
    simple.ColorBy(points, ("POINTS", given.colour))
    moment = times[-1] if given.time is None else min(times, key=lambda t: abs(t - given.time))
    scene.AnimationTime = moment
    source.UpdatePipeline(moment)
    places, fields = arrays(source)
    lookup = simple.GetColorTransferFunction(given.colour)
    lookup.ApplyPreset("Viridis (matplotlib)", True)
    lookup.RescaleTransferFunction(*colour_range(fields[given.colour]))

    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = int(in_space)
    view.ViewSize = [1400, 700]
    bar = simple.GetScalarBar(lookup, view)
    bar.Orientation = "Horizontal"
    bar.WindowLocation = "Any Location"
    bar.Position, bar.ScalarBarLength = [0.55, 0.86], 0.4
    bar.TitleFontSize, bar.LabelFontSize = 18, 16
    bar.RangeLabelFormat = bar.LabelFormat = "%.3g"
    bar.TitleColor = bar.LabelColor = [0.0, 0.0, 0.0]
    points.SetScalarBarVisibility(view, True)
    stamp = simple.AnnotateTimeFilter(source)
    stamp.Format = "t = {time:.3f} s"
    text = simple.Show(stamp, view)
    text.Color, text.FontSize = [0.0, 0.0, 0.0], 18
    text.WindowLocation, text.Position = "Any Location", [0.02, 0.92]
    look_at(view, places, in_space)
    return view, moment


def colour_range(values):
    """All but half a per cent at each end, so that a few points do not bleach the rest; from zero where
    zero is near."""
    values = numpy.asarray(values, dtype=float)
    if values.ndim == 2:
        values = numpy.linalg.norm(values, axis=1)
    values = values[numpy.isfinite(values)]
    if len(values) == 0:
        return 0.0, 1.0
    low, high = numpy.percentile(values, [0.5, 99.5])
    if values.min() >= 0.0 and low < 0.25 * high:
        low = 0.0
    return (float(low), float(high)) if high > low else (float(low), float(low) + 1.0)


def look_at(view, places, in_space):
    low, high = places.min(axis=0), places.max(axis=0)
    centre, extent = 0.5 * (low + high), high - low
    view.CameraFocalPoint = centre
    view.CameraViewUp = [0.0, 1.0, 0.0]
    if in_space:
        view.CameraParallelProjection = 0
        away = 2.2 * float(numpy.linalg.norm(extent))
        view.CameraPosition = centre + away * numpy.array([0.5, 0.45, 0.74])
        return
    view.InteractionMode = "2D"
    view.CameraParallelProjection = 1
    view.CameraPosition = centre + numpy.array([0.0, 0.0, 1.0])
    width, height = view.ViewSize
    # room for the time and the bar above it
    view.CameraParallelScale = 0.5 * max(1.1 * extent[0] * height / width, 1.5 * extent[1])


def main():
    given = options()
    source = opened(given)
    view, moment = arrange(source, given)
    if given.output:
        simple.SaveScreenshot(os.path.abspath(given.output), view, ImageResolution=[1400, 700])
        print(f"{given.output}: t = {moment:g} s")
    elif given.result is not None and "pvpython" in os.path.basename(sys.executable):
        simple.Interact(view)
    else:
        simple.Render(view)


main()
