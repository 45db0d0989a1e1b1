"""Makes a sheet that bends, turns and folds, as a source with time steps. Computes its normals from positions alone, by
cross products in double, with which the results of the filter are compared."""

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkIdTypeArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkDataObject, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

SIDE = 20
TIMES = (0.0, 1.0, 2.5)


def positions(time, side=SIDE):
    """Returns positions (n, 3) in float32 of a sheet that twists about its middle line while waves run through it."""
    u, v = (x.reshape(-1) for x in np.meshgrid(*2 * [np.linspace(0, 1, side)], indexing="ij"))
    height = 0.3 * np.sin(3 * u + 2 * v + 2 * time) + time * u * v
    angle = 2 * time * v
    x, z = u - 0.5, height
    return np.stack([x * np.cos(angle) - z * np.sin(angle), v, x * np.sin(angle) + z * np.cos(angle)],
                    axis=-1).astype(np.float32)


def quads(side=SIDE):
    i = np.arange(side * side).reshape(side, side)
    return np.stack([i[:-1, :-1], i[1:, :-1], i[1:, 1:], i[:-1, 1:]], axis=-1).reshape(-1, 4)


def triangles(side=SIDE):
    q = quads(side)
    return np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]])


def between(time, side=SIDE):
    """Returns the positions at any time, in double. Points move on straight lines between the steps."""
    time = min(max(time, TIMES[0]), TIMES[-1])
    k = min(int(np.searchsorted(TIMES, time, side="right")), len(TIMES) - 1)
    t = (time - TIMES[k - 1]) / (TIMES[k] - TIMES[k - 1])
    return (1 - t) * positions(TIMES[k - 1], side).astype(float) + t * positions(TIMES[k], side).astype(float)


def on_curve(time, times, side=SIDE, shape=positions):
    """Returns the positions at a time on the cubics through the steps, in double. The slope at a step is the slope of
    the polynomial through the step and its neighbours or, at both ends, of the polynomial through the nearest four
    steps."""
    def slope(k):
        nearest = slice(0, 4) if k == 0 else slice(max(k - 3, 0), k + 1) if k == len(times) - 1 else slice(k - 1, k + 2)
        steps = np.array([shape(t, side).reshape(-1).astype(float) for t in times[nearest]])
        return np.polyfit(np.array(times[nearest]) - times[k], steps, len(steps) - 1)[-2].reshape(-1, 3)

    time = min(max(time, times[0]), times[-1])
    k = min(int(np.searchsorted(times, time, side="right")), len(times) - 1) - 1
    h = times[k + 1] - times[k]
    t = (time - times[k]) / h
    return ((2 * t**3 - 3 * t**2 + 1) * shape(times[k], side).astype(float) + h * (t**3 - 2 * t**2 + t) * slope(k)
            + (3 * t**2 - 2 * t**3) * shape(times[k + 1], side).astype(float) + h * (t**3 - t**2) * slope(k + 1))


def areas(points, faces):
    """Returns twice the vector areas of polygons, by Newell's method."""
    corners = points[faces] - points[faces[:, :1]]
    return np.cross(corners, np.roll(corners, -1, axis=1)).sum(axis=1)


def unit(vectors):
    """Returns vectors scaled to length 1; zero vectors stay zero."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(lengths == 0, 1, lengths)


def point_normals(points, faces):
    """Returns the unit normals of points, from the sums of the vector areas of the faces around each point."""
    sums = np.zeros((len(points), 3))
    for corner in faces.T:
        np.add.at(sums, corner, areas(points, faces))
    return unit(sums)


def degrees(a, b):
    a, b = unit(np.asarray(a, dtype=float)), unit(np.asarray(b, dtype=float))
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))


def cells(faces):
    offsets, corners = vtkIdTypeArray(), vtkIdTypeArray()
    offsets.DeepCopy(numpy_to_vtk(np.arange(len(faces) + 1) * faces.shape[1], array_type=offsets.GetDataType()))
    corners.DeepCopy(numpy_to_vtk(faces.reshape(-1).astype(np.int64), array_type=corners.GetDataType()))
    result = vtkCellArray()
    result.SetData(offsets, corners)
    return result


def named(values, name):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    return array


def mesh(points, faces):
    """Makes a vtkPolyData with stored normals of points, an array of amounts, which filters interpolate, and ids."""
    data = vtkPolyData()
    held = vtkPoints()
    held.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=1))
    data.SetPoints(held)
    data.SetPolys(cells(faces))
    data.GetPointData().SetNormals(named(point_normals(points.astype(float), faces).astype(np.float32), "Normals"))
    data.GetPointData().AddArray(named(points[:, 0] * 2, "amount"))
    # Every filter of VTK keeps the array "number", so the array identifies points in the result.
    data.GetPointData().AddArray(named(np.arange(len(points), dtype=float), "number"))
    for attributes, count in ((data.GetPointData(), len(points)), (data.GetCellData(), len(faces))):
        ids = vtkIdTypeArray()
        ids.DeepCopy(named(np.arange(count), "ids"))
        ids.SetName("ids")
        attributes.SetGlobalIds(ids)
    return data


class Steps(VTKPythonAlgorithmBase):
    """A source with time steps; `make(time)` returns the data of each step. The source records the times, pieces and
    ghost levels that it was asked for. If `cuts` is false, the source cannot cut pieces, and VTK requests only the
    first piece."""

    def __init__(self, make=lambda time: mesh(positions(time), triangles()), kind="vtkPolyData", cuts=False, times=TIMES):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)
        self.make, self.cuts, self.times, self.asked, self.piece = make, cuts, times, [], None

    def RequestInformation(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        info.Set(Pipeline.TIME_STEPS(), self.times, len(self.times))
        info.Set(Pipeline.TIME_RANGE(), (self.times[0], self.times[-1]), 2)
        if self.cuts:
            info.Set(vtkAlgorithm.CAN_HANDLE_PIECE_REQUEST(), 1)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        time = info.Get(Pipeline.UPDATE_TIME_STEP())
        self.asked.append(time)
        self.piece = (info.Get(Pipeline.UPDATE_PIECE_NUMBER()), info.Get(Pipeline.UPDATE_NUMBER_OF_GHOST_LEVELS()))
        output = vtkDataObject.GetData(info)
        output.ShallowCopy(self.make(time))
        output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
        return 1


def numbers(data):
    """Returns the numbers that the points of a piece have in the whole mesh."""
    return np.rint(vtk_to_numpy(data.GetPointData().GetArray("number"))).astype(int)


def normals(data):
    return vtk_to_numpy(data.GetPointData().GetNormals())
