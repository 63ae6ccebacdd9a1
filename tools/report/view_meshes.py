"""Surfaces small enough for a page: fewer triangles, coordinates of 16 bits, text that a script unpacks in the browser."""
import base64
import concurrent.futures
import ctypes
import dataclasses
import functools
import multiprocessing
import pathlib
import signal
import typing

import numpy as np

MOST_TRIANGLES = 16000  # of one surface: what a laptop draws at ease, finer than a window shows
BUDGET = 7.5e6  # characters of all surfaces together
CHARACTERS_A_TRIANGLE = (3 * 2 + 0.5 * 3 * 2) * 4 / 3  # three indices, half a point, base64
FEWEST_OF_A_BODY, ENOUGH_OF_A_BODY = 16, 60


def chosen_frames(count, most):
    """Evenly spread, first and last among them."""
    if count <= most:
        return list(range(count))
    return sorted({round(k * (count - 1) / (most - 1)) for k in range(most)})


def triangles_each(surfaces):
    """Share of the budget of one surface of so many."""
    return int(min(MOST_TRIANGLES, BUDGET / CHARACTERS_A_TRIANGLE / max(1, surfaces)))


@dataclasses.dataclass(frozen=True)
class Surface:
    """Points [mm] in the order of their bodies, triangles of three numbers of points."""

    points: np.ndarray
    triangles: np.ndarray
    bodies: list  # (number of the object, or of the body; points)
    all_bodies: int  # of the file


def ended_with_its_parent():
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)


def read_bodies(path, name):
    """Number -> polydata of that object or body."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    if data.GetNumberOfPolys() == 0:
        return []
    points = vtk_to_numpy(data.GetPoints().GetData()).astype(np.float64)
    triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    number = vtk_to_numpy(data.GetCellData().GetArray(name))
    order = np.argsort(number, kind="stable")
    cuts = np.flatnonzero(np.diff(number[order])) + 1
    return [(int(number[rows[0]]), points, triangles[rows]) for rows in np.split(order, cuts)]


def decimated(points, triangles, wanted):
    """Fewer triangles of nearly the same shape (quadric error, vtkQuadricDecimation), closed where they were closed."""
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkQuadricDecimation

    used, corners = np.unique(triangles, return_inverse=True)
    points, triangles = points[used], corners.reshape(-1, 3)
    if len(triangles) <= wanted:
        return points, triangles
    corners = np.ascontiguousarray(np.column_stack([np.full(len(triangles), 3), triangles]).ravel(), dtype=np.int64)
    cells = vtkCellArray()
    cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(corners, deep=True))
    place = vtkPoints()
    place.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    data = vtkPolyData()
    data.SetPoints(place)
    data.SetPolys(cells)
    filter_ = vtkQuadricDecimation()
    filter_.SetInputData(data)
    filter_.SetTargetReduction(1 - wanted / len(triangles))
    filter_.Update()
    result = filter_.GetOutput()
    points = vtk_to_numpy(result.GetPoints().GetData()).astype(np.float64)
    triangles = vtk_to_numpy(result.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    used, corners = np.unique(triangles, return_inverse=True)
    return points[used], corners.reshape(-1, 3)


def small_surface(wanted, name, path):
    """The surface of a file, each body with its share of the wanted triangles; of very many bodies the largest."""
    bodies = read_bodies(path, name)
    all_bodies = len(bodies)
    if (most := wanted // FEWEST_OF_A_BODY) < len(bodies):
        largest = sorted(range(len(bodies)), key=lambda k: -len(bodies[k][2]))[:most]
        bodies = [bodies[k] for k in sorted(largest)]
    all_triangles = sum(len(triangles) for _, _, triangles in bodies)
    points, triangles, counts, first = [np.empty((0, 3))], [np.empty((0, 3), int)], [], 0
    for number, its_points, its_triangles in bodies:
        share = max(FEWEST_OF_A_BODY, min(ENOUGH_OF_A_BODY, wanted // len(bodies)), round(wanted * len(its_triangles) / all_triangles))
        its_points, its_triangles = decimated(its_points, its_triangles, share)
        points.append(its_points)
        triangles.append(its_triangles + first)
        counts.append((number, len(its_points)))
        first += len(its_points)
    return Surface(np.concatenate(points), np.concatenate(triangles), counts, all_bodies)


def small_surfaces(paths, wanted, name, threads):
    """One for each path, in their order."""
    job = functools.partial(small_surface, wanted, name)
    if threads == 1 or len(paths) == 1:
        return [job(path) for path in paths]
    with concurrent.futures.ProcessPoolExecutor(
            min(threads, len(paths)), multiprocessing.get_context("fork"), ended_with_its_parent) as pool:
        return list(pool.map(job, paths))


@dataclasses.dataclass
class Layer:
    """One thing to show or to hide, in each frame; a path is missing where it could not be made."""

    kind: str  # sample, objects, phase, pores
    name: str
    colour_of: typing.Callable[[int], str]  # of a body
    paths: dict[int, pathlib.Path]
    numbers: str = "body"  # what distinguishes its triangles


def packed(surface, low, high):
    """Coordinates as 16-bit steps between low and high."""
    step = np.where(high > low, high - low, 1) / 65535
    points = np.clip(np.rint((surface.points - low) / step), 0, 65535).astype("<u2")
    wide = len(points) > 65535
    triangles = surface.triangles.astype("<u4" if wide else "<u2")
    return {
        "points": base64.b64encode(points.tobytes()).decode(),
        "triangles": base64.b64encode(triangles.tobytes()).decode(),
        "wide": wide,
        "bodies": [list(one) for one in surface.bodies],
    }


class View:
    """The layers as the viewer reads them, in the frames in which there is something to show.

    @note  layers, frames, bounds [mm], triangles; notes: sentences about what is not shown
    """

    def __init__(self, layers, frames, threads):
        self.frames = [frame for frame in frames if any(frame in layer.paths for layer in layers)]
        wanted = triangles_each(sum(len(layer.paths) for layer in layers))
        surfaces = {
            id(layer): dict(zip(layer.paths, small_surfaces(list(layer.paths.values()), wanted, layer.numbers, threads)))
            for layer in layers
        }
        everything = [one.points for of_layer in surfaces.values() for one in of_layer.values() if len(one.points)]
        low = np.min([points.min(axis=0) for points in everything], axis=0) if everything else np.zeros(3)
        high = np.max([points.max(axis=0) for points in everything], axis=0) if everything else np.ones(3)
        self.bounds = [low.tolist(), high.tolist()]
        self.layers, self.triangles, self.notes = [], 0, []
        for layer in layers:
            of_layer = surfaces[id(layer)]
            self.triangles += sum(len(one.triangles) for one in of_layer.values())
            bodies = sorted({number for one in of_layer.values() for number, _ in one.bodies})
            if not bodies:
                continue
            if max(one.all_bodies for one in of_layer.values()) > max(len(one.bodies) for one in of_layer.values()):
                self.notes.append(f"Of the {layer.name} the {wanted // FEWEST_OF_A_BODY} largest of each frame are shown.")
            self.layers.append({
                "kind": layer.kind,
                "name": layer.name,
                "swatch": layer.colour_of(bodies[0]),
                "colours": {number: layer.colour_of(number) for number in bodies},
                "frames": [packed(of_layer[frame], low, high) if frame in of_layer else None for frame in self.frames],
            })
