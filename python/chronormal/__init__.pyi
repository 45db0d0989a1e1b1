# Types of what __init__.py has; the docstrings are there.
import os
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Path = str | os.PathLike[str]
_Source = _Path | Iterable[_Path] | bytes | bytearray | memoryview | None
_Faces = ArrayLike | Sequence[Sequence[int]] | tuple[ArrayLike, ArrayLike]
_Elements = Literal["vertices", "faces", "corners"]
_Weighting = Literal["area", "angle", "uniform", "area-angle", "max"]

class Curves:
    def unit_normals(self, t: float | ArrayLike, out: NDArray[np.float32] | None = None,
                     threads: int = 1) -> NDArray[np.float32]: ...
    def errors(self, t: float | ArrayLike, normals: ArrayLike, threads: int = 1) -> NDArray[np.float32]: ...
    def next(self, p0: ArrayLike, p1: ArrayLike) -> None: ...
    @property
    def bytes(self) -> int: ...
    @property
    def elements(self) -> str: ...
    @property
    def fit_bound(self) -> float: ...
    def __len__(self) -> int: ...

class Blend:
    def unit_normals(self, weights: ArrayLike, out: NDArray[np.float32] | None = None,
                     threads: int = 1) -> NDArray[np.float32]: ...
    @property
    def targets(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    def __len__(self) -> int: ...

class Motion:
    @property
    def positions(self) -> NDArray[np.float32]: ...
    @property
    def faces(self) -> NDArray[np.uint32] | tuple[NDArray[np.uint32], NDArray[np.uint32]]: ...
    @property
    def times(self) -> NDArray[np.float64]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def segments(self) -> NDArray[np.int64]: ...
    @property
    def kind(self) -> Literal["sequence", "targets", "animation", "mesh"]: ...
    def unit_normals(self, times: ArrayLike | None = None, weights: ArrayLike | None = None,
                     elements: _Elements = "vertices", crease: float = 180.0, weighting: _Weighting = "area",
                     weld: bool = True) -> NDArray[np.float32]: ...

class ErrorTable:
    name: str
    errors: NDArray[np.float32]
    subjects: NDArray[np.int64]
    times: NDArray[np.float64]
    weights: NDArray[np.float64]
    positions: NDArray[np.float32]
    primitives: NDArray[np.int64] | None
    vertices: NDArray[np.int64] | None

def curves(p0: ArrayLike, p1: ArrayLike, faces: _Faces, elements: _Elements = "vertices", crease: float | None = None,
           weighting: _Weighting = "area", tolerance: float = 1e-6, weld: bool = True, threads: int = 0) -> Curves: ...
def blend(base: ArrayLike, deltas: ArrayLike | Sequence[ArrayLike | tuple[ArrayLike, ArrayLike]], faces: _Faces,
          elements: _Elements = "vertices", crease: float | None = None, weld: bool = True) -> Blend: ...
def certify(p0: ArrayLike, p1: ArrayLike, faces: _Faces, scheme: str = "linear",
            threads: int = 0) -> dict[str, NDArray[np.float64]]: ...
def read(source: _Source = None, *, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
         animation: str | int | None = None, world: bool = False) -> Motion: ...
def inspect(source: _Source = None, *, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
            animation: str | int | None = None, world: bool = False) -> dict[str, Any]: ...
def audit(source: _Source = None, *, rule: str | None = None, weighting: _Weighting | None = None,
          hosts: str | Iterable[str] | None = None, samples: int | None = None, tolerance: float | None = None,
          weld: bool = True, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
          animation: str | int | None = None) -> dict[str, Any]: ...
def compare(source: _Source = None, *, schemes: Iterable[str] = (), samples: int = 21,
            access: Literal["random", "sequential"] = "random", elements: _Elements = "faces", crease: float = 180.0,
            weld: bool = True, times: bool = False, certify: bool = False, tolerance: float | None = None,
            sample: str | None = None, base: _Path | None = None, fps: float = 1.0, animation: str | int | None = None,
            world: bool = False) -> dict[str, Any]: ...
def bake(source: _Source = None, *, encode: Literal["smallest", "harmless", "exact", "endpoint", "keys"] | None = None,
         hosts: str | Iterable[str] = "all", weighting: _Weighting | None = None, tolerance: float | None = None,
         smooth: bool = False, recompute_base: bool = False, sample: str | None = None,
         fps: float = 1.0) -> tuple[bytes, dict[str, Any]]: ...
def errors(source: _Source = None, *, scheme: str | None = None, samples: int | None = None,
           elements: _Elements = "vertices", rule: str | None = None, weighting: _Weighting | None = None,
           weld: bool = True, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
           animation: str | int | None = None) -> list[ErrorTable]: ...
def collapse(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, start: float | None = None,
             end: float | None = None) -> dict[str, NDArray[Any]]: ...
def facing(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, direction: ArrayLike | None = None,
           eye: ArrayLike | None = None, eye_to: ArrayLike | None = None, silhouettes: bool = False,
           start: float | None = None, end: float | None = None) -> dict[str, NDArray[Any]]: ...
