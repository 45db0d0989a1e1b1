"""Tests that the lines of Python in docs/simulation.md run, and give true normals."""

import re
import unittest
from pathlib import Path

from vtkmodules.util.numpy_support import vtk_to_numpy

from meshes import Steps, between, degrees, point_normals, triangles

PAGE = Path(__file__).resolve().parent.parent.parent / "docs" / "simulation.md"


class DocumentTest(unittest.TestCase):
    def test_the_lines_of_the_page_give_right_normals(self):
        (block,) = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(), re.M | re.S)
        names = {"reader": Steps()}
        exec(compile(block, str(PAGE), "exec"), names)
        truth = point_normals(between(0.5), triangles())
        self.assertLess(degrees(vtk_to_numpy(names["normals"]), truth).max(), 1e-5)


if __name__ == "__main__":
    unittest.main()
