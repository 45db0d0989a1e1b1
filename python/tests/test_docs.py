"""Tests that the code of docs/python.md and the README runs, and prints the output that these pages show."""

import doctest
import inspect
import re
import typing
import unittest
from pathlib import Path

import numpy as np

import chronormal as cn

ROOT = Path(__file__).resolve().parent.parent.parent


def blocks(file, language):
    return re.findall(rf"^```{language}\n(.*?)^```$", (ROOT / file).read_text(), re.M | re.S)


class DocumentTest(unittest.TestCase):
    def test_the_page_prints_what_it_shows(self):
        page = "\n".join(blocks("docs/python.md", "pycon"))
        test = doctest.DocTestParser().get_doctest(page, {}, "docs/python.md", "docs/python.md", 0)
        self.assertGreater(len(test.examples), 20)
        self.maxDiff = None
        said = []
        doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test, out=said.append)
        self.assertEqual("".join(said), "")

    def test_the_readme_runs(self):
        (block,) = blocks("README.md", "python")
        p0 = np.eye(3, dtype=np.float32)
        names = {"p0": p0, "p1": p0[::-1] + 1, "faces": [[0, 1, 2]]}
        exec(compile(block, "README.md", "exec"), names)
        self.assertEqual(names["normals"].shape, (3, 3))

    def test_every_public_name_has_a_docstring(self):
        for name in cn.__all__:
            thing = getattr(cn, name)
            self.assertTrue(thing.__doc__, name)
            if isinstance(thing, type):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                        self.assertTrue(value.__doc__, f"{name}.{member}")

    def test_every_signature_has_types(self):
        for name in cn.__all__:
            thing = getattr(cn, name)
            if isinstance(thing, type):
                continue
            signature = inspect.signature(thing)
            hints = typing.get_type_hints(thing)  # fails if a hint has an unknown name
            self.assertEqual(set(hints), set(signature.parameters) | {"return"}, name)

    def test_the_stubs_name_what_the_extension_has(self):
        stubs = (Path(cn.__file__).parent / "_chronormal.pyi").read_text()
        for kind in (cn.Curves, cn.Blend, cn.Motion):
            body = re.search(rf"^class {kind.__name__}:\n((?:    .*\n)+)", stubs, re.M).group(1)
            stubbed = set(re.findall(r"def (\w+)", body)) - {"__len__"}
            there = {member for member in vars(kind) if not member.startswith("_")}
            self.assertEqual(stubbed, there, kind)


if __name__ == "__main__":
    unittest.main()
