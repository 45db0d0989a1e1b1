"""Tests vtkChronormalInterpolator against vtkTemporalInterpolator and exact normals: times, data, pieces and errors."""

import unittest

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.util.vtkConstants import VTK_DOUBLE
from vtkmodules.vtkCommonCore import VTK_STRING, vtkLogger, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkDataSetAttributes, vtkImageData, vtkMultiBlockDataSet,
                                           vtkPolyData, vtkUnstructuredGrid)
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkFiltersHybrid import vtkTemporalInterpolator
from vtkmodules.vtkFiltersParallel import vtkExtractPolyDataPiece

from chronormal_vtk.vtkChronormal import vtkChronormalInterpolator
from meshes import (TIMES, Steps, areas, between, cells, degrees, mesh, named, normals, numbers, on_curve, point_normals,
                    positions, quads, triangles)

ANY_TIME = (-3.0, 0.0, 0.1, 0.5, 0.99, 1.0, 1.3, 2.2, 2.5, 7.0)


def connected(filter_class, source):
    result = filter_class()
    result.SetInputConnection(source.GetOutputPort())
    return result


def at(interpolator, time, *piece):
    interpolator.UpdateTimeStep(time, *piece)
    return interpolator.GetOutputDataObject(0)


def stock_and_ours(make, time, kind="vtkPolyData"):
    source = Steps(make, kind)
    return [at(connected(c, source), time) for c in (vtkTemporalInterpolator, vtkChronormalInterpolator)]


def cell_normals(data):
    return vtk_to_numpy(data.GetCellData().GetNormals())


def places(data):
    return vtk_to_numpy(data.GetPoints().GetData())


class RightTest(unittest.TestCase):
    def test_normals_are_those_of_the_mesh_at_any_time_in_range_and_beyond(self):
        source = Steps()
        stock, ours = connected(vtkTemporalInterpolator, source), connected(vtkChronormalInterpolator, source)
        ours.ComputeCellNormalsOn()
        worst_of_stock = 0
        for time in ANY_TIME:
            data, truth = at(ours, time), between(time)
            self.assertLess(degrees(normals(data), point_normals(truth, triangles())).max(), 1e-5)
            self.assertLess(degrees(cell_normals(data), areas(truth, triangles())).max(), 1e-5)
            self.assertLess(np.abs(places(data) - truth).max(), 1e-6)
            for lengths in (np.linalg.norm(n, axis=1) for n in (normals(data), cell_normals(data))):
                self.assertLess(np.abs(lengths - 1).max(), 1e-6)
            worst_of_stock = max(worst_of_stock, degrees(normals(at(stock, time)), point_normals(truth, triangles())).max())
        self.assertGreater(worst_of_stock, 30)

    def test_positions_and_other_arrays_are_those_of_the_stock_filter(self):
        stock, ours = stock_and_ours(lambda time: mesh(positions(time), triangles()), 1.3)
        np.testing.assert_array_equal(places(ours), places(stock))
        for name in ("amount", "number"):
            np.testing.assert_array_equal(*(vtk_to_numpy(d.GetPointData().GetArray(name)) for d in (ours, stock)))
        self.assertEqual(ours.GetFieldData().GetArray("OriginalTimeSteps").GetNumberOfTuples(), 2)

    def test_polygons_have_the_normals_of_their_vector_areas(self):
        source = Steps(lambda time: mesh(positions(time), quads()))
        ours = connected(vtkChronormalInterpolator, source)
        ours.ComputeCellNormalsOn()
        data, truth = at(ours, 0.7), between(0.7)
        self.assertLess(degrees(normals(data), point_normals(truth, quads())).max(), 1e-5)
        self.assertLess(degrees(cell_normals(data), areas(truth, quads())).max(), 1e-5)

    def test_positions_in_double_keep_their_digits_far_from_the_origin(self):
        far = np.array([4e6, -7e6, 1e6])
        source = Steps(lambda time: mesh(positions(time) + far, triangles()))
        data = at(connected(vtkChronormalInterpolator, source), 0.5)
        self.assertEqual(data.GetPointData().GetNormals().GetDataType(), VTK_DOUBLE)
        p0, p1 = ((positions(time) + far) for time in TIMES[:2])
        truth = 0.5 * (p0 - far) + 0.5 * (p1 - far)  # exact up to the last bit of the positions in the steps
        self.assertLess(degrees(normals(data), point_normals(truth, triangles())).max(), 1e-5)

    def test_strips_lines_and_vertices_are_cells_too(self):
        def make(time):
            data = mesh(positions(time, 3), triangles(3)[:1])
            for cells, corners in ((vtkCellArray(), [8]), (vtkCellArray(), [6, 7]), (vtkCellArray(), [0, 3, 1, 4, 2, 5])):
                cells.InsertNextCell(len(corners), corners)
                {1: data.SetVerts, 2: data.SetLines, 6: data.SetStrips}[len(corners)](cells)
            return data

        source = Steps(make)
        ours = connected(vtkChronormalInterpolator, source)
        ours.ComputeCellNormalsOn()
        data, truth = at(ours, 0.4), between(0.4, 3)
        strip = np.array([[0, 3, 1], [1, 3, 4], [1, 4, 2], [2, 4, 5]])
        found = cell_normals(data)
        np.testing.assert_array_equal(found[:2], np.zeros((2, 3)))
        of_cells = [areas(truth, triangles(3)[:1])[0], areas(truth, strip).sum(axis=0)]
        self.assertLess(degrees(found[2:], of_cells).max(), 1e-5)
        of_points = point_normals(truth, np.concatenate([strip, triangles(3)[:1]]))
        self.assertLess(degrees(normals(data)[:6], of_points[:6]).max(), 1e-5)
        np.testing.assert_array_equal(normals(data)[[6, 7, 8]], np.zeros((3, 3)))

    def test_a_face_that_starts_as_a_point_has_a_normal_at_the_start(self):
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
        source = Steps(lambda time: mesh(time * corners, np.array([[0, 1, 2]])))
        found = normals(at(connected(vtkChronormalInterpolator, source), 0.0))
        np.testing.assert_array_equal(found, [[0, 0, 1]] * 3)

    def test_bits_do_not_depend_on_the_order_of_points_and_cells(self):
        random = np.random.default_rng(7)
        in_double = lambda time: positions(time).astype(float)  # float would hide most of the rounding errors of sums
        order, of_cells = random.permutation(400), random.permutation(len(triangles()))
        rank = np.argsort(order)
        shuffled = Steps(lambda time: mesh(in_double(time)[order], rank[triangles()[of_cells]]))
        source = Steps(lambda time: mesh(in_double(time), triangles()))
        found = normals(at(connected(vtkChronormalInterpolator, shuffled), 0.3))
        whole = normals(at(connected(vtkChronormalInterpolator, source), 0.3))
        np.testing.assert_array_equal(found, whole[order])


class PathTest(unittest.TestCase):
    TIMES = (0.0, 0.4, 1.0, 1.3, 2.0, 2.5)

    def curved(self, times=TIMES, make=lambda time: mesh(positions(time), triangles()), kind="vtkPolyData"):
        source = Steps(make, kind, times=times)
        ours = connected(vtkChronormalInterpolator, source)
        ours.SetPathToCatmullRom()
        ours.ComputeCellNormalsOn()
        return source, ours

    def test_points_and_normals_are_those_of_the_curve_through_the_steps(self):
        for times in (self.TIMES, self.TIMES[:4], self.TIMES[:3], self.TIMES[:2]):
            _, ours = self.curved(times)
            for time in (-1.0, 0.0, 0.1, 0.4, 0.7, 1.1, 1.3, 1.9, 2.4, 2.5, 9.0):
                data, truth = at(ours, time), on_curve(time, times)
                self.assertLess(np.abs(places(data) - truth).max(), 1e-6)
                self.assertLess(degrees(normals(data), point_normals(truth, triangles())).max(), 1e-5)
                self.assertLess(degrees(cell_normals(data), areas(truth, triangles())).max(), 1e-5)
        self.assertGreater(np.abs(on_curve(0.7, self.TIMES) - on_curve(0.7, self.TIMES[1:3])).max(), 0.01)

    def test_points_in_double_stay_in_double(self):
        _, ours = self.curved(make=lambda time: mesh(positions(time).astype(float), triangles()))
        data = at(ours, 0.8)
        self.assertEqual((data.GetPoints().GetDataType(), data.GetPointData().GetNormals().GetDataType()), 2 * (VTK_DOUBLE,))
        self.assertLess(np.abs(places(data) - on_curve(0.8, self.TIMES)).max(), 1e-14)

    def test_other_arrays_are_those_of_the_stock_filter(self):
        source, ours = self.curved()
        stock = at(connected(vtkTemporalInterpolator, source), 0.8)
        for name in ("amount", "number"):
            np.testing.assert_array_equal(*(vtk_to_numpy(d.GetPointData().GetArray(name)) for d in (at(ours, 0.8), stock)))

    def test_four_steps_are_asked_of_the_input_and_kept(self):
        source, ours = self.curved()
        for asked, times in (([0.0, 0.4, 1.0, 1.3], (0.1, 0.3)), ([0.4, 1.0, 1.3, 2.0], (1.1, 1.2)),
                             ([1.0, 1.3, 2.0, 2.5], (1.5, 2.4))):
            source.asked.clear()
            for time in times:
                at(ours, time)
            self.assertEqual(source.asked, asked)
        ours.SetPathToLinear()
        data = at(ours, 1.5)
        truth = (1 - 2 / 7) * positions(1.3).astype(float) + 2 / 7 * positions(2.0)
        self.assertLess(degrees(normals(data), point_normals(truth, triangles())).max(), 1e-5)

    def test_blocks_and_grids_move_on_curves_too(self):
        def make(time):
            blocks = vtkMultiBlockDataSet()
            grid = vtkUnstructuredGrid()
            grid.SetPoints(mesh(positions(time), triangles()).GetPoints())
            for k, block in enumerate((mesh(positions(time), quads()), grid)):
                blocks.SetBlock(k, block)
            return blocks

        _, ours = self.curved(make=make, kind="vtkMultiBlockDataSet")
        data, truth = at(ours, 0.6), on_curve(0.6, self.TIMES)
        self.assertLess(degrees(normals(data.GetBlock(0)), point_normals(truth, quads())).max(), 1e-5)
        for block in (0, 1):
            self.assertLess(np.abs(places(data.GetBlock(block)) - truth).max(), 1e-6)

    def test_bits_depend_neither_on_the_order_of_points_and_cells_nor_on_pieces(self):
        random = np.random.default_rng(8)
        in_double = lambda time: positions(time).astype(float)
        order, of_cells = random.permutation(400), random.permutation(len(triangles()))
        _, shuffled = self.curved(make=lambda time: mesh(in_double(time)[order], np.argsort(order)[triangles()[of_cells]]))
        _, plain = self.curved(make=lambda time: mesh(in_double(time), triangles()))
        np.testing.assert_array_equal(normals(at(shuffled, 0.7)), normals(at(plain, 0.7))[order])

        source, source_of_whole = Steps(times=self.TIMES), Steps(times=self.TIMES)
        pieces = connected(vtkExtractPolyDataPiece, source)
        ours, reference = connected(vtkChronormalInterpolator, pieces), connected(vtkChronormalInterpolator, source_of_whole)
        for interpolator in (ours, reference):
            interpolator.SetPathToCatmullRom()
        whole = normals(at(reference, 0.7))
        for piece in range(3):
            data = at(ours, 0.7, piece, 3, 0)
            np.testing.assert_array_equal(normals(data), whole[numbers(data)])

    def test_a_step_beside_the_two_that_has_other_cells_is_an_error(self):
        def make(time):
            return mesh(positions(time), triangles()[::-1] if time == 1.3 else triangles())

        _, ours = self.curved(make=make)
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
        self.assertEqual(at(ours, 0.7).GetNumberOfPoints(), 0)
        ours.SetPathToLinear()
        self.assertEqual(at(ours, 0.7).GetNumberOfPoints(), 400)


class ArraysTest(unittest.TestCase):
    def test_normals_are_made_as_asked_and_always_where_the_input_has_some(self):
        def bare(time):
            data = mesh(positions(time), triangles())
            data.GetPointData().SetNormals(None)
            return data

        source = Steps(bare)
        ours = connected(vtkChronormalInterpolator, source)
        self.assertIsNotNone(at(ours, 0.5).GetPointData().GetNormals())
        self.assertIsNone(at(ours, 0.5).GetCellData().GetNormals())
        ours.ComputePointNormalsOff()
        self.assertIsNone(at(ours, 0.5).GetPointData().GetNormals())

        def stored(time):
            data = mesh(positions(time), triangles())
            data.GetPointData().GetNormals().SetName("n")
            data.GetCellData().SetNormals(named(areas(positions(time), triangles()), "of cells"))
            return data

        source = Steps(stored)
        ours = connected(vtkChronormalInterpolator, source)
        ours.ComputePointNormalsOff()
        data = at(ours, 0.5)
        self.assertEqual((data.GetPointData().GetNormals().GetName(), data.GetCellData().GetNormals().GetName()),
                         ("n", "of cells"))
        self.assertLess(degrees(normals(data), point_normals(between(0.5), triangles())).max(), 1e-5)
        self.assertLess(degrees(cell_normals(data), areas(between(0.5), triangles())).max(), 1e-5)

    def test_ids_are_names_and_not_mixed(self):
        source = Steps()
        data = at(connected(vtkChronormalInterpolator, source), 0.3)
        for attributes in (data.GetPointData(), data.GetCellData()):
            ids = vtk_to_numpy(attributes.GetGlobalIds())
            np.testing.assert_array_equal(ids, np.arange(len(ids)))

    def test_texts_are_those_of_the_step_before(self):
        def make(time):
            data = mesh(positions(time, 2), triangles(2))
            for name in ("names", "notes"):
                texts = vtkStringArray()
                texts.SetName(name)
                for k in range(4):
                    texts.InsertNextValue(f"{k} at {time}")
                data.GetPointData().AddArray(texts)
            data.GetPointData().SetActivePedigreeIds("names")
            return data

        source = Steps(make)
        found = at(connected(vtkChronormalInterpolator, source), 0.7).GetPointData()
        self.assertEqual(found.GetPedigreeIds().GetName(), "names")
        for name in ("names", "notes"):
            texts = found.GetAbstractArray(name)
            self.assertEqual([texts.GetValue(k) for k in range(4)], [f"{k} at 0.0" for k in range(4)])

    def test_blocks_of_composite_data_are_interpolated_each(self):
        def make(time):
            inner, outer = vtkMultiBlockDataSet(), vtkMultiBlockDataSet()
            inner.SetBlock(0, mesh(positions(time), triangles()))
            inner.SetBlock(2, mesh(positions(time), quads()))
            image = vtkImageData()
            image.SetDimensions(2, 2, 2)
            image.GetPointData().SetScalars(named(np.full(8, 10 * time), "heat"))
            outer.SetBlock(0, inner)
            outer.SetBlock(1, image)
            return outer

        stock, ours = stock_and_ours(make, 0.3, "vtkMultiBlockDataSet")
        for block, faces in ((0, triangles()), (2, quads())):
            data = ours.GetBlock(0).GetBlock(block)
            self.assertLess(degrees(normals(data), point_normals(between(0.3), faces)).max(), 1e-5)
            np.testing.assert_array_equal(places(data), places(stock.GetBlock(0).GetBlock(block)))
        self.assertIsNone(ours.GetBlock(0).GetBlock(1))
        np.testing.assert_allclose(vtk_to_numpy(ours.GetBlock(1).GetPointData().GetScalars()), 3)

    def test_an_empty_mesh_stays_empty(self):
        source = Steps(lambda time: vtkPolyData())
        self.assertEqual(at(connected(vtkChronormalInterpolator, source), 0.5).GetNumberOfPoints(), 0)


class RequestsTest(unittest.TestCase):
    def test_two_steps_are_asked_of_the_input_and_kept(self):
        source = Steps()
        ours = connected(vtkChronormalInterpolator, source)
        for time in (0.2, 0.4, 1.0, 0.0):
            at(ours, time)
        self.assertEqual(source.asked, [0.0, 1.0])
        at(ours, 1.5)
        self.assertEqual(source.asked[-1], 2.5)

    def test_the_output_has_a_range_of_times_or_the_steps_that_were_set(self):
        source = Steps()
        ours = connected(vtkChronormalInterpolator, source)
        ours.UpdateInformation()
        info = ours.GetOutputInformation(0)
        self.assertFalse(info.Has(Pipeline.TIME_STEPS()))
        self.assertEqual(info.Get(Pipeline.TIME_RANGE()), (TIMES[0], TIMES[-1]))
        ours.SetResampleFactor(4)
        ours.UpdateInformation()
        self.assertEqual(info.Get(Pipeline.TIME_STEPS())[:3], (0.0, 0.25, 0.5))


class PiecesTest(unittest.TestCase):
    def test_normals_of_pieces_have_the_bits_of_the_whole(self):
        source, source_of_whole = Steps(), Steps()
        pieces = connected(vtkExtractPolyDataPiece, source)
        ours = connected(vtkChronormalInterpolator, pieces)
        ours.ComputeCellNormalsOn()
        reference = connected(vtkChronormalInterpolator, source_of_whole)
        for time in (0.5, 1.7):
            whole = normals(at(reference, time))
            for ghosts in (0, 1, 2):
                owned = 0
                for piece in range(3):
                    data = at(ours, time, piece, 3, ghosts)
                    np.testing.assert_array_equal(normals(data), whole[numbers(data)])
                    flags = data.GetCellData().GetArray(vtkDataSetAttributes.GhostArrayName())
                    self.assertEqual(flags is not None, ghosts > 0)
                    owned += data.GetNumberOfCells() - (np.count_nonzero(vtk_to_numpy(flags)) if flags else 0)
                    self.assertLess(data.GetNumberOfPoints(), 400)
                self.assertEqual(owned, len(triangles()))
            data = at(ours, time, 0, 1, 0)
            np.testing.assert_array_equal(normals(data), whole[numbers(data)])
            self.assertEqual(data.GetNumberOfPoints(), 400)

    def test_sources_that_cut_pieces_in_any_order_keep_ids_and_bits_in_double(self):
        def make(time):
            """Returns the whole mesh in a different order, with about two in three of its cells marked as ghosts."""
            piece, _ = source.piece
            random = np.random.default_rng(piece)
            order, of_cells = random.permutation(400), random.permutation(len(triangles()))
            data = mesh(positions(time).astype(float)[order], np.argsort(order)[triangles()[of_cells]])
            for attributes, ids in ((data.GetPointData(), order), (data.GetCellData(), of_cells)):
                vtk_to_numpy(attributes.GetGlobalIds())[:] = ids
            flags = np.where(of_cells * 3 // len(of_cells) == piece, 0, vtkDataSetAttributes.DUPLICATECELL)
            data.GetCellData().AddArray(named(flags.astype(np.uint8), vtkDataSetAttributes.GhostArrayName()))
            return data

        source = Steps(make, cuts=True)
        source_of_whole = Steps(lambda time: mesh(positions(time).astype(float), triangles()))
        whole = normals(at(connected(vtkChronormalInterpolator, source_of_whole), 1.7))
        ours = connected(vtkChronormalInterpolator, source)
        cells = []
        for piece in range(3):
            data = at(ours, 1.7, piece, 3, 0)
            self.assertEqual(source.piece, (piece, 1))
            np.testing.assert_array_equal(normals(data), whole[vtk_to_numpy(data.GetPointData().GetGlobalIds())])
            cells += vtk_to_numpy(data.GetCellData().GetGlobalIds()).tolist()
        self.assertEqual(sorted(cells), list(range(len(triangles()))))


class ErrorsTest(unittest.TestCase):
    def setUp(self):
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)

    def tearDown(self):
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_INFO)

    def error_of(self, make, kind="vtkPolyData"):
        source = Steps(make, kind)
        ours = connected(vtkChronormalInterpolator, source)
        said = []

        def note(_, __, text):
            said.append(text)

        note.CallDataType = VTK_STRING
        ours.AddObserver("ErrorEvent", note)
        data = at(ours, 0.5)
        self.assertEqual(len(said), 1)
        if kind == "vtkPolyData":
            self.assertEqual(data.GetNumberOfPoints(), 0)
        return said[0]

    def test_a_mesh_whose_topology_changes_is_an_error_and_not_interpolated(self):
        def other_size(time):
            return mesh(positions(time, 4 + int(time)), triangles(4 + int(time)))

        self.assertIn("the two steps have 16 and 25 points, so there is no motion between the steps at times 0 and 1",
                      self.error_of(other_size))

        def other_cell(time):
            faces = triangles(4)
            if time > 0:
                faces[5] = np.roll(faces[5], 1)
            return mesh(positions(time, 4), faces)

        self.assertIn("cell 5: the cell has different points in the two steps", self.error_of(other_cell))
        self.assertIn("the two steps have different numbers of vertices, lines, polygons or strips",
                      self.error_of(lambda time: mesh(positions(time, 4), triangles(4)[int(time):])))

    def test_a_cell_of_points_that_are_not_there_is_an_error(self):
        def broken(time):
            faces = triangles(4)
            data = mesh(positions(time, 4), faces)
            faces[3, 1] = 16
            data.SetPolys(cells(faces))
            return data

        self.assertIn("cell 3: the cell refers to point 16, which the mesh does not have", self.error_of(broken))

    def test_a_point_that_is_nowhere_is_an_error(self):
        def lost(time):
            points = positions(time, 4)
            points[9, 1] = np.nan if time > 0 else 0
            return mesh(points, triangles(4))

        self.assertIn("point 9: a coordinate of the point is NaN or infinite", self.error_of(lost))

    def test_errors_in_composite_data_name_the_block(self):
        def make(time, block):
            blocks = vtkMultiBlockDataSet()
            blocks.SetBlock(0, mesh(positions(time, 4), triangles(4)))
            block(blocks, time)
            return blocks

        def changes(blocks, time):
            blocks.SetBlock(1, mesh(positions(time, 4 + int(time)), triangles(4 + int(time))))

        def goes(blocks, time):
            blocks.SetNumberOfBlocks(2)
            if time == 0:
                blocks.SetBlock(1, mesh(positions(time, 4), triangles(4)))

        def grows(blocks, time):
            blocks.SetNumberOfBlocks(2 + int(time))

        def volume(blocks, time):
            grid = vtkUnstructuredGrid()
            grid.SetPoints(vtkPoints())
            grid.GetPoints().SetNumberOfPoints(1)
            grid.GetPointData().SetNormals(named(np.ones((1, 3)), "Normals"))
            blocks.SetBlock(1, grid)

        no_motion = "block 2: the two steps have 16 and 25 points, so there is no motion between the steps at times 0 and 1."
        for block, text in ((changes, no_motion),
                            (goes, "block 2: This block is in only one of the two steps. Give all steps the same blocks."),
                            (grows, "The two steps have different numbers of blocks. Give all steps the same blocks."),
                            (volume, "block 2: The normals of a vtkUnstructuredGrid are those of its surface")):
            self.assertIn(text, self.error_of(lambda time: make(time, block), "vtkMultiBlockDataSet"))


if __name__ == "__main__":
    unittest.main()
