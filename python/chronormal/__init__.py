"""Exact normals of triangle meshes that deform.

    import chronormal as cn

    curves = cn.curves(p0, p1, faces)        # once for two arrays of positions
    normals = curves.unit_normals(0.5)       # (V, 3) float32, exact at every t

Arrays   Positions are (V, 3) float32, C-contiguous: such arrays, also read-only ones, are read in place and not kept.
         Other arrays and lists of numbers are converted once, to the nearest float32 (float64 too).
Faces    (F, k) of int32, int64, uint32 or any other integers; a list of lists for polygons of different sizes; or a tuple
         (offsets, corners) of two rows: face f has corners[offsets[f]:offsets[f + 1]]. A tuple of two faces is two faces.
Errors   ValueError names the place: "face 3, corner 1: ...". OSError is for files.
Threads  Everything that takes long releases the GIL. One object works for one thread at a time; others wait.
Signals  Handlers of signals run during a long call. If a handler raises an exception, as for Ctrl-C, it ends the call.
Forks    A child of fork() may use all objects of its parent; if the parent used several threads, the child uses one.
"""

from __future__ import annotations

import dataclasses as _dataclasses
import json as _json
import os as _os
from collections.abc import Iterable, Sequence
from typing import Any, Literal, Union

import numpy as _np
from numpy.typing import ArrayLike, NDArray

from ._chronormal import Blend, Curves, Motion, __version__
from . import _chronormal

__all__ = ["Blend", "Curves", "ErrorTable", "Motion", "audit", "bake", "blend", "certify", "collapse", "compare",
           "cones", "contain", "curves", "cut", "errors", "facing", "inspect", "interpolate", "motion", "read", "schemes",
           "shutter"]

_Path = Union[str, "_os.PathLike[str]"]
_Source = Union[_Path, Iterable[_Path], bytes, bytearray, memoryview, Motion, None]
_Faces = Union[ArrayLike, Sequence[Sequence[int]], "tuple[ArrayLike, ArrayLike]"]
_Elements = Literal["vertices", "faces", "corners"]
_Weighting = Literal["area", "angle", "uniform", "area-angle", "max", "inverse-edges", "inverse-roots"]


def _vectors(array, place):
    """Return the array itself if it is C-contiguous float32, or else a copy in this form."""
    array = _np.asarray(array)
    if array.dtype == _np.float32 and array.flags.c_contiguous and array.flags.aligned:
        return array
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{place}: the array must hold real numbers, best as float32, but its type is {array.dtype}")
    # numbers that are too large become infinite; the library refuses infinite numbers, and names their place
    with _np.errstate(over="ignore"):
        return _np.ascontiguousarray(array, dtype=_np.float32)


def _indices(array, place):
    """Return a flat array of uint32."""
    array = _np.asarray(array)
    if array.size == 0 and array.dtype.kind == "f":  # numpy makes an empty list an array of floats
        array = array.astype(_np.uint32)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{place}: the type must be int32, int64 or uint32, but is {array.dtype}")
    if array.size > 0 and (array.min() < 0 or array.max() > 0xFFFFFFFF):
        where = _np.argwhere((array < 0) | (array > 0xFFFFFFFF))[0]
        position = ", ".join(str(i) for i in where)
        raise ValueError(f"{place}[{position}]: {array[tuple(where)]} cannot be an index; an index is a whole number from 0 to "
                         "4,294,967,295")
    return _np.ascontiguousarray(array, dtype=_np.uint32).reshape(-1)


def _are_offsets(faces):
    """Return True if a tuple is (offsets, corners), and False if it is two faces.

    Offsets begin with 0, end with the number of corners, and rise by at least 3 each time. Two faces of equal size
    never do so. Arrays that are long enough for offsets are read as (offsets, corners) even if they break this rule,
    and are then refused with the place of the mistake, so that a mistake does not make two large faces.
    """
    if not isinstance(faces, tuple) or len(faces) != 2 or not all(_np.ndim(part) == 1 for part in faces):
        return False
    offsets, corners = faces
    if len(offsets) == 0:
        return True
    if any(isinstance(part, _np.ndarray) for part in faces):
        return len(corners) >= 3 * (len(offsets) - 1)
    steps = [b - a for a, b in zip(offsets[:-1], offsets[1:])]
    return offsets[0] == 0 and offsets[-1] == len(corners) and all(step >= 3 for step in steps)


def _polygons(faces):
    """Return (offsets, corners) in uint32; offsets are empty for triangles."""
    if _are_offsets(faces):
        offsets = _indices(faces[0], "offsets")
        if offsets.size == 0:
            raise ValueError("offsets: there must be one more offset than faces, but the array is empty; give (0,) for no faces")
        return offsets, _indices(faces[1], "corners")
    if not isinstance(faces, _np.ndarray):
        faces = list(faces)
        sizes = [_np.size(face) for face in faces]
        if len(set(sizes)) > 1:
            corners = _np.concatenate([_indices(face, f"faces[{f}]") for f, face in enumerate(faces)])
            return _np.cumsum([0] + sizes, dtype=_np.uint32), corners
        faces = _np.asarray(faces) if faces else _np.empty((0, 3), _np.uint32)
    if faces.ndim != 2:
        raise ValueError(f"faces: the shape must be (F, k), k corners for each of F faces, but is {faces.shape}")
    count, size = faces.shape
    corners = _indices(faces, "faces")
    if size == 3:
        return _np.empty(0, _np.uint32), corners
    if size < 3:
        raise ValueError(f"faces: the shape is {faces.shape}, but a face must have at least 3 corners")
    return _np.arange(0, (count + 1) * size, size, dtype=_np.uint32), corners


def _text(value, place):
    """Return a string that can be passed to the library, or raise an error for other values."""
    if not isinstance(value, str):
        raise TypeError(f"{place}: the value must be a string, not {type(value).__name__}")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{place}: {value!r} cannot be written as UTF-8") from None
    return value


def _file(name, place):
    """Return the name of a file as the system stores it: bytes, which need not be UTF-8."""
    try:
        name = _os.fsencode(name)
    except UnicodeEncodeError:
        raise ValueError(f"{place}: {name!r} cannot be the name of a file, since some characters cannot be encoded") from None
    except TypeError:
        raise TypeError(f"{place}: the value must be the name of a file, not {type(name).__name__}") from None
    if b"\0" in name:
        raise ValueError(f"{place}: {_os.fsdecode(name)!r} cannot be the name of a file, since the name contains a zero byte")
    return name


def _float(value, place):
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{place}: the number is too large for a float; give a smaller number") from None
    except TypeError:
        raise TypeError(f"{place}: the value must be a number, not {type(value).__name__}") from None


def _floats(array, place):
    """Return a C-contiguous array of float64."""
    array = _np.asarray(array)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{place}: the array must hold real numbers, best as float64, but its type is {array.dtype}")
    return _np.ascontiguousarray(array, dtype=_np.float64)


def _source(source, sample=None, base=None, fps=1.0, animation=None, world=False, path="linear", velocities=False,
            loop=False, strict=False):
    """Return the arguments that describe an input as a dict, as the extension module expects them."""
    if (source is None) == (sample is None):
        raise ValueError("source: give either files, bytes or a Motion as the source, or the name of a built-in morph as sample")
    data, files, motion = None, [], None
    if isinstance(source, Motion):
        motion = source
        for name, given in {"base": base is not None, "fps": fps != 1, "animation": animation is not None,
                            "world": world, "path": path != "linear", "loop": loop, "strict": strict}.items():
            if given:
                raise ValueError(f"{name}: this option is only for reading files, and the source is a Motion; leave the option out"
                                 + (" and call cut(), which makes straight pieces" if name == "path" else ""))
    elif isinstance(source, (bytes, bytearray, memoryview)):
        data = bytes(source)
    elif isinstance(source, (str, _os.PathLike)):
        files = [_file(source, "source")]
    elif source is not None:
        try:
            files = list(source)
        except TypeError:
            raise TypeError(f"source: the value must be files, bytes or a Motion, not {type(source).__name__}") from None
        if not files:
            raise ValueError("source: the list has no files; give at least one file")
        files = [_file(file, f"source[{i}]") for i, file in enumerate(files)]
    return {"files": files, "bytes": data, "motion": motion,
            "samples": [_text(sample, "sample")] if sample is not None else [],
            "base": _file(base, "base") if base is not None else b"", "fps": _float(fps, "fps"),
            "animation": _text(str(animation), "animation") if animation is not None else "", "world": bool(world),
            "path": _text(path, "path"), "velocities": bool(velocities), "loop": bool(loop), "strict": bool(strict)}


def _names(given):
    return given if isinstance(given, str) else ",".join(given)


def curves(p0: ArrayLike, p1: ArrayLike, faces: _Faces, elements: _Elements = "vertices", crease: float | None = None,
           weighting: _Weighting = "area", tolerance: float = 1e-6, weld: bool = True, threads: int = 0) -> Curves:
    """Prepare the unit normals between two arrays of positions; return Curves.

    p0, p1     (V, 3) positions at t = 0 and t = 1; vertices move on straight lines between them
    faces      (F, 3) vertices of each face, counted from 0; polygons as the package says
    elements   the elements that have a normal: "vertices", "faces" or "corners", in the order of faces
    crease     degrees, for corners: edges that are sharper at t = 0 are hard; None: no edge is
    weighting  how the faces around a vertex count: "area" (exact), or fitted: "angle", "uniform", "area-angle", "max",
               "inverse-edges", "inverse-roots"
    tolerance  radians: the largest error of a normal; 1e-3 takes a third of the memory
    weld       True: vertices that are at one point both at t = 0 and at t = 1 share a normal, so that seams do not show
    threads    0: all cores; k: at most k
    """
    offsets, corners = _polygons(faces)
    return Curves(_vectors(p0, "p0"), _vectors(p1, "p1"), offsets, corners, elements, crease, weighting, tolerance, weld,
                  threads)


def cut(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, path: str = "catmull-rom",
        velocities: ArrayLike | None = None) -> tuple[NDArray[_np.float32], NDArray[_np.float64]]:
    """Cut curves through keyframes into straight pieces; return the positions (P, V, 3) and times (P,) of their ends.

    positions   (T, V, 3), the keyframes
    faces       as for curves()
    times       (T,) seconds, ascending; None: 0, 1, 2 ...
    path        "catmull-rom": velocities follow from the keyframes; "hermite": they are the argument `velocities`;
                "linear": nothing is cut
    velocities  (T, V, 3) per second

    Normals of the pieces are within 0.01 degrees of the curve's normals, plus the effect of rounding positions to
    float32; "catmull-rom:0.1" allows 0.1 degrees. The error may be larger for a face that nearly vanishes between
    two keyframes.
    """
    if velocities is not None:
        velocities = _vectors(velocities, "velocities")
    return _chronormal.cut(*_keyframes(positions, faces, times), _text(path, "path"), velocities)


def blend(base: ArrayLike, deltas: ArrayLike | Sequence[ArrayLike | tuple[ArrayLike, ArrayLike]], faces: _Faces,
          elements: _Elements = "vertices", crease: float | None = None, weld: bool = True) -> Blend:
    """Prepare the unit normals of blend shapes, base + sum of weights times deltas; return Blend.

    base    (V, 3) positions
    deltas  (K, V, 3), or a list with an entry for each target: (V, 3), or (vertices, deltas) of the vertices that
            move, with the vertices ascending
    faces, elements, crease, weld  as for curves()
    """
    targets = []
    for k, target in enumerate(deltas):
        vertices = _np.empty(0, _np.uint32)
        if isinstance(target, tuple) and len(target) == 2:
            vertices, target = _indices(target[0], f"deltas[{k}][0]"), target[1]
        targets.append((vertices, _vectors(target, f"deltas[{k}]")))
    offsets, corners = _polygons(faces)
    return Blend(_vectors(base, "base"), targets, offsets, corners, elements, crease, weld)


def certify(p0: ArrayLike, p1: ArrayLike, faces: _Faces, scheme: str = "linear",
            threads: int = 0) -> dict[str, NDArray[_np.float64]]:
    """Bound the largest error of a scheme over the whole of a segment, for each face; return a dict of arrays (F,).

    p0, p1, faces, threads  as for curves()
    scheme   a name that compare() knows

    The arrays of the result are:
    lower    degrees; the error reaches this value at the local time `at`
    upper    degrees; the error is never larger at any time from 0 to 1, rounding included; 180 if a normal
             vanishes on the way
    from, to  local times: the piece of the segment on which the upper bound is reached, if anywhere
    """
    offsets, corners = _polygons(faces)
    return _chronormal.certify(_vectors(p0, "p0"), _vectors(p1, "p1"), offsets, corners, scheme, threads)


def read(source: _Source = None, *, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
         animation: str | int | None = None, world: bool = False, path: str = "linear", loop: bool = False, strict: bool = False) -> Motion:
    """Read a motion; return Motion, whose arrays curves() takes.

    source     a file, a pattern, a folder, a list of these, or the bytes of one file, of every format of the program
    sample     a built-in morph instead: "twist", "bend", "cloth", "eversion", "soup", "bumps"
    base       the base mesh, if the source is morph targets
    fps        keyframes per second where a format has no times
    animation  of a glTF file, by name or index; None: its morph targets
    world      True: the nodes of a glTF file move its vertices to their places in the scene
    path       how vertices of a sequence move: "linear", "catmull-rom" or "hermite", as `--path` of the program. Curves are
               cut into straight pieces: the keyframes of the motion are the ends of these pieces, as cut() makes them
    loop       True: the first keyframe of a sequence follows its last one
    strict     True: an input that can only be read in part raises ValueError
    """
    return Motion(_source(source, sample, base, fps, animation, world, path, velocities=True, loop=loop, strict=strict))


def motion(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None) -> Motion:
    """Make a Motion from arrays, which all functions that read files accept in place of files.

    positions  (T, V, 3), two keyframes or more; between two of them vertices move on straight lines
    faces      as for curves()
    times      (T,) seconds, ascending; None: 0, 1, 2 ...
    """
    return Motion(*_keyframes(positions, faces, times))


def _motion_of_state(state):
    made = Motion.__new__(Motion)
    made.__setstate__(state)
    return made


# Protocols 0 and 1 of pickle would make an object of the base class, and the extension module would then end the
# process.
Motion.__reduce_ex__ = lambda self, protocol: (_motion_of_state, (self.__getstate__(),))
Motion.__reduce__ = lambda self: self.__reduce_ex__(0)


def schemes() -> dict[str, str]:
    """Return the names of the schemes that interpolate(), compare() and certify() know, with a line about each."""
    return _chronormal.schemes()


def interpolate(scheme: str, p0: ArrayLike, p1: ArrayLike, faces: _Faces, t: float | ArrayLike,
                elements: _Elements = "faces", crease: float = 180.0, weld: bool = True) -> NDArray[_np.float32]:
    """Return the unit normals of a scheme that interpolates between the exact normals at t = 0 and t = 1. The result is
    (n, 3) for one t, or (T, n, 3) for T values of t.

    scheme  a name of schemes()
    p0, p1, faces, elements, crease, weld  as for curves(), but faces by default, as in compare(): the schemes of the paper
            are about faces, and some schemes need faces
    t       in [0, 1]
    """
    times = _floats(t, "t")
    normals = motion([_vectors(p0, "p0"), _vectors(p1, "p1")], faces, [0, 1]).unit_normals(
        times.reshape(-1) if times.ndim == 0 else times, elements=elements, crease=crease, weld=weld, scheme=scheme)
    return normals[0] if _np.ndim(t) == 0 else normals


def inspect(source: _Source = None, *, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
            animation: str | int | None = None, world: bool = False, loop: bool = False, strict: bool = False) -> dict[str, Any]:
    """Return the dict of `chronormal inspect --json`: what a file contains, and possible causes of wrong normals.

    source  as for read(), or a Motion; sample, base, fps, animation, world, loop, strict: as for read()
    """
    return _json.loads(_chronormal.inspect(_source(source, sample, base, fps, animation, world, loop=loop, strict=strict)))


def audit(source: _Source = None, *, rule: str | None = None, weighting: _Weighting | None = None,
          viewers: str | Iterable[str] | None = None, samples: int | None = None, tolerance: float | None = None,
          weld: bool = True, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
          animation: str | int | None = None, path: str = "linear", loop: bool = False, strict: bool = False) -> dict[str, Any]:
    """Return the dict of `chronormal audit --json`: the errors of the normals that viewers render from a file.

    rule, weighting, viewers, samples, tolerance  as the options of the program; viewers may be a list
    source  as for read(); or a Motion, which has no stored normals: viewers compute them at keyframes
    sample, base, fps, animation, path, loop, strict  as for read()
    """
    opened = _source(source, sample, base, fps, animation, path=path, loop=loop, strict=strict)
    text, _ = _chronormal.audit(opened, rule or "", weighting or "", _names(viewers or ""), samples, tolerance, weld, False)
    return _json.loads(text)


def compare(source: _Source = None, *, schemes: str | Iterable[str] = (), samples: int = 21,
            access: Literal["random", "sequential"] = "random", elements: _Elements = "faces", crease: float = 180.0,
            weld: bool = True, times: bool = False, certify: bool = False, tolerance: float | None = None,
            face: int | tuple[int, int] | None = None, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
            animation: str | int | None = None,
            world: bool = False, path: str = "linear", loop: bool = False, strict: bool = False) -> dict[str, Any]:
    """Compare ways to interpolate normals with the exact normals; return the dict of `chronormal compare --json`.

    schemes    names of schemes; empty: the default schemes of `chronormal compare`
    samples    moments in each segment at which normals are compared, at least 2
    access     "random": each normal is computed from t alone; "sequential": each from the one before, as in playback
    elements   whose normals are compared: "faces", "vertices" or "corners"
    crease     degrees: an edge whose faces differ by more is hard, so that its corners share no normal
    weld       True: vertices at the same positions share a normal
    times      True: include measured times, which differ from run to run
    certify    True: bound the largest error of each scheme at any time
    tolerance  degrees: certify, and find the cheapest scheme whose error never exceeds the tolerance
    face       one face, in segment 0, or (face, segment): return the dict of `--face`, with the normals that each scheme makes
               for this face; of the options of this function, only schemes and samples can be
               combined with it
    source     as for read(), or a Motion; sample, base, fps, animation, world, path, loop, strict: as for read()
    """
    if access not in ("random", "sequential"):
        raise ValueError("access: the value must be random or sequential")
    opened = _source(source, sample, base, fps, animation, world, path, loop=loop, strict=strict)
    schemes = schemes.split(",") if isinstance(schemes, str) and schemes else list(schemes)
    if face is not None:
        for name, given in {"access": access != "random", "elements": elements != "faces", "crease": crease != 180, "weld": not weld,
                            "times": times, "certify": certify, "tolerance": tolerance is not None}.items():
            if given:
                raise ValueError(f"{name}: this option cannot be used with face, which examines a single face; leave this option "
                                 "or face out")
        number, segment = face if isinstance(face, tuple) else (face, 0)
        return _json.loads(_chronormal.figure_of_face(opened, schemes, samples, number, segment))
    text, _ = _chronormal.compare(opened, schemes, samples, access == "sequential", elements, crease, weld, times,
                                  False, certify, tolerance)
    return _json.loads(text)


def bake(source: _Source = None, *, encode: Literal["smallest", "harmless", "exact", "endpoint", "keys"] | None = None,
         viewers: str | Iterable[str] | None = None, weighting: _Weighting | None = None, tolerance: float | None = None,
         smooth: bool = False, recompute_base: bool = False, sample: str | None = None,
         fps: float = 1.0, path: str = "linear", loop: bool = False, strict: bool = False) -> tuple[bytes, dict[str, Any]]:
    """Write true normals into a glTF file, or make a glTF file from a sequence; return (glb, report).

    viewers   the viewers to bake for; None: all viewers that add up deltas, and no other viewer becomes worse
    source  as for read(), or a Motion that is a sequence; sample, fps, path, loop, strict: as for read()
    glb     bytes of a GLB
    report  the dict of `chronormal bake --json` without its audit, which audit(glb) returns
    """
    opened = _source(source, sample, None, fps, path=path, loop=loop, strict=strict)
    glb, text = _chronormal.bake(opened, encode or "", _names(viewers or ""), weighting or "", tolerance, smooth, recompute_base)
    return glb, _json.loads(text)


@_dataclasses.dataclass(frozen=True, repr=False)
class ErrorTable:
    """The errors of one mesh, with a row for each sample and a column for each vertex (or face, or corner)."""

    name: str  #: "mesh0" of a glTF file, else ""
    errors: _np.ndarray  # : (rows, columns) float32, degrees; NaN for samples that were not judged
    subjects: _np.ndarray  #: (rows,) int64: the index of the subject of the audit, or of the segment of the motion
    times: _np.ndarray  # : (rows,) float64, seconds; NaN in rows that belong to targets
    weights: _np.ndarray  # : (rows,) float64; NaN in rows that belong to animations and sequences
    positions: _np.ndarray  # : (V, 3) float32, at the first keyframe or in the base
    primitives: _np.ndarray = None  # : (V,) int64, the primitive of each vertex of a glTF mesh
    vertices: _np.ndarray = None  # : (V,) int64, the index of each vertex in its primitive

    def __repr__(self):
        rows, columns = self.errors.shape
        judged = self.errors[~_np.isnan(self.errors)]
        worst = f"{judged.max():.4g} degrees at worst" if judged.size > 0 else "nothing judged"
        return f"<chronormal.ErrorTable {self.name}: {rows} sample{'s' if rows != 1 else ''} of {columns}, {worst}>".replace(" :", ":")


def errors(source: _Source = None, *, scheme: str | None = None, samples: int | None = None,
           elements: _Elements = "vertices", rule: str | None = None, weighting: _Weighting | None = None,
           weld: bool = True, sample: str | None = None, base: _Path | None = None, fps: float = 1.0,
           animation: str | int | None = None, path: str = "linear", loop: bool = False, strict: bool = False) -> list[ErrorTable]:
    """Return every error, for each vertex at each sample: a list of ErrorTable, one for each mesh.

    scheme  None: the errors of the stored normals, as in an audit; or the name of a scheme of interpolation, such as
            "linear": the errors of this scheme, for any elements
    source  as for audit() and compare(); sample, base, fps, animation, path, loop, strict: as for read()
    """
    opened = _source(source, sample, base, fps, animation, path=path, loop=loop, strict=strict)
    if scheme is None:
        if elements != "vertices":
            raise ValueError("elements: errors of stored normals are known for vertices only; leave elements out, or name a "
                             "scheme")
        _, tables = _chronormal.audit(opened, rule or "", weighting or "", "", samples, None, weld, True)
    else:
        _, tables = _chronormal.compare(opened, [scheme], 21 if samples is None else samples, False, elements, 180.0,
                                        weld, False, True, False, None)
    return [ErrorTable(**table) for table in tables]


def _keyframes(positions, faces, times):
    """Return what the extension module needs for a query: positions (T, V, 3), offsets and corners, times (T,)."""
    positions = _vectors(positions, "positions")
    if positions.ndim != 3 or positions.shape[2] != 3:
        raise ValueError(f"positions: the shape must be (T, V, 3), T keyframes of V vertices, but is {positions.shape}")
    times = _np.arange(len(positions), dtype=_np.float64) if times is None else _floats(times, "times")
    return positions, *_polygons(faces), times


def collapse(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, start: float | None = None,
             end: float | None = None) -> dict[str, NDArray[Any]]:
    """Return when faces have no area, decided exactly, as a dict of arrays with a row for each collapse.

    positions   (T, V, 3) keyframes; between two of them vertices move on straight lines
    faces       as for curves()
    times       (T,) of the keyframes; None: 0, 1, 2 ...
    start, end  the interval of time to search; None: the whole motion

    The arrays of the result are:
    segment, face   the place of the collapse
    lower, upper    bounds of t at the collapse, in [0, 1]
    time            the time of the collapse in the motion
    turns_over      True if the normal after the collapse is opposite to the normal before
    before, after   (rows, 3) the unit normal just before and just after the collapse
    always_segment, always_face   faces that have no area in a whole segment
    """
    return _chronormal.query_collapse(*_keyframes(positions, faces, times), start, end)


def facing(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, direction: ArrayLike | None = None,
           eye: ArrayLike | None = None, eye_to: ArrayLike | None = None, silhouettes: bool = False,
           start: float | None = None, end: float | None = None, elements: _Elements = "faces", crease: float | None = None,
           weld: bool = True) -> dict[str, NDArray[Any]]:
    """Return when faces show their front to a camera, as a dict of arrays with a row for each interval.

    positions, faces, times, start, end   as for collapse()
    direction    (3,) the camera is infinitely far away in this direction; or
    eye, eye_to  (3,) the camera is at eye, and moves straight to eye_to over all times; None: stands still
    silhouettes  True: also list silhouette edges, between a face that shows its front and one that shows its back
    elements, crease, weld   as for curves(): "vertices" and "corners" are judged by their own normals, seen from their places

    The arrays of the result are:
    segment, face             the place; vertex or corner in place of face for these elements
    from, from_upper          bounds of t in the segment at the beginning of the interval
    to_lower, to              bounds of t in the segment at the end of the interval
    silhouette_vertices, silhouette_faces   (rows, 2), with silhouette_segment, silhouette_from, ... as above
    """
    if (direction is None) == (eye is None):
        raise ValueError("direction: there must be one camera; give either direction or eye")
    if eye_to is not None and eye is None:
        raise ValueError("eye_to: the option eye is missing; give as eye the place from which the camera moves to eye_to")
    first = _floats(eye, "eye") if direction is None else _floats(direction, "direction")
    last = first if eye_to is None else _floats(eye_to, "eye_to")
    if first.shape != (3,) or last.shape != (3,):
        raise ValueError("direction: direction, eye and eye_to must be arrays of 3 numbers")
    return _chronormal.query_facing(*_keyframes(positions, faces, times), start, end, eye is not None, first, last,
                                    silhouettes, elements, crease, weld)


def contain(positions: ArrayLike, faces: _Faces, points: ArrayLike, times: ArrayLike | None = None, *,
            start: float | None = None, end: float | None = None) -> dict[str, NDArray[Any]]:
    """Return as a dict of arrays which points are inside a closed mesh that deforms, and when each crosses its surface.

    positions, faces, times, start, end   as for collapse(); a mesh that is not closed is a ValueError
    points   (P, 3) points that rest, or (P, 2, 3): each point moves straight from its first
             position to its second, over all times

    The arrays of the result are:
    inside           (P,) True for points that are inside at the first instant
    crossing_point   the index of the point; crossings are ordered by point and time
    crossing_time, crossing_segment, crossing_face, crossing_normal (rows, 3)   the time and place of the crossing
    crossing_inward  True if the winding number rises, False if it falls
    """
    return _chronormal.query_contain(*_keyframes(positions, faces, times), start, end, _floats(points, "points"))


def cones(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, meshlets: int | None = None,
          start: float | None = None, end: float | None = None) -> dict[str, NDArray[Any]]:
    """Return cones that contain every normal of a face, as a dict of arrays with a row for each segment and face.

    positions, faces, times, start, end   as for collapse()
    meshlets   the largest number of triangles in a meshlet (a multiple of 4); None: make no meshlets

    The arrays of the result are:
    segment, face     the place
    axis, sine        (rows, 3) and (rows,) float32: the unit vector of the axis, and the sine of the half-angle. If
                      d @ axis >= sine for a unit vector d from the eye to the face, the eye cannot see the front of the
                      face. A cone that covers the whole sphere has the axis 0 and the sine 1. A face that never has an
                      area has the axis 0 and the sine 0
    half_angle        degrees
    meshlet_segment, meshlet_index, meshlet_center, meshlet_radius, meshlet_cone_apex, meshlet_cone_axis, ...
                      bounds as in meshoptimizer, valid at every instant of the interval within the segment
    member_meshlet, member_face   the faces of each meshlet
    """
    return _chronormal.query_cones(*_keyframes(positions, faces, times), start, end, meshlets)


def shutter(positions: ArrayLike, faces: _Faces, times: ArrayLike | None = None, *, start: float | None = None,
            end: float | None = None, elements: _Elements = "faces", crease: float | None = None, weld: bool = True) -> dict[str, NDArray[Any]]:
    """Return average normals while a shutter is open, as a dict of arrays with a row for each segment and face.

    positions, faces, times, start, end   as for collapse()
    elements, crease, weld   as for curves()

    The arrays of the result are:
    segment, face   the place; vertex or corner in place of face for these elements
    mean            (rows, 3) mean of n(t), whose length is twice the area of a triangle
    mean_unit       (rows, 3) mean of the unit normal
    error           the largest possible length of the difference between mean_unit and the exact mean
    length          the length of mean_unit: 1 where normals stay the same, 0 where they cancel
    half_angle      degrees, the half-angle of a cone that contains all normals
    ends, ends_off  (rows, 3) the mean direction of interpolation between the end normals, and its error in degrees
    span_face, span_mean ...   the same means over all segments together, if there are several
    """
    return _chronormal.query_shutter(*_keyframes(positions, faces, times), start, end, elements, crease, weld)
