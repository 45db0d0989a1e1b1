"""Tests pieces on several ranks; run by `mpirun -n N`. Every rank interpolates its piece of a mesh under
vtkMPIController, and compares the normals with those of the whole mesh, which it computes by itself. With the
argument `transmit`, only rank 0 has the data, and sends the pieces to the others. With `extract`, every rank reads the
data and takes its piece. The exit code is 0 if all bits are equal."""

import sys

from mpi4py import MPI  # starts MPI, which vtkMPIController expects in Python
from vtkmodules.vtkFiltersParallel import vtkExtractPolyDataPiece, vtkTransmitPolyDataPiece
from vtkmodules.vtkParallelCore import vtkMultiProcessController
from vtkmodules.vtkParallelMPI import vtkMPIController

from chronormal_vtk.vtkChronormal import vtkChronormalInterpolator
from meshes import SIDE, Steps, normals, numbers


def interpolator(port):
    result = vtkChronormalInterpolator()
    result.SetInputConnection(port)
    return result


def main(way):
    controller = vtkMPIController()
    controller.Initialize()
    vtkMultiProcessController.SetGlobalController(controller)
    rank, ranks = controller.GetLocalProcessId(), controller.GetNumberOfProcesses()

    steps, steps_of_whole = Steps(), Steps()
    pieces = vtkTransmitPolyDataPiece() if way == "transmit" else vtkExtractPolyDataPiece()
    pieces.SetInputConnection(steps.GetOutputPort())
    mine = interpolator(pieces.GetOutputPort())
    whole = interpolator(steps_of_whole.GetOutputPort())
    wrong, seen = 0, 0
    for time in (0.0, 0.25, 0.5, 1.0, 1.9):
        mine.UpdateTimeStep(time, rank, ranks, 0)
        whole.UpdateTimeStep(time)
        piece = mine.GetOutputDataObject(0)
        points = numbers(piece)
        wrong += int((normals(piece) != normals(whole.GetOutputDataObject(0))[points]).any(axis=1).sum())
        seen = len(points)
    reads = "all" if steps.asked else "nothing"
    print(f"rank {rank} of {ranks}: {seen} points, {wrong} normals with other bits, read {reads}", flush=True)
    controller.Finalize()
    return wrong > 0 or seen >= SIDE * SIDE and ranks > 1


sys.exit(main(sys.argv[1]))
