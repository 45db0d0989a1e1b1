"""Computes from a GLB the normals that a viewer renders at given weights of its morph targets.

The rule is that of glTF 2.0, which three.js, Babylon.js, PlayCanvas and Bevy follow: the normal of the base plus
the weighted deltas of all targets, normalised.
"""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy

_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


class Unreadable(Exception):
    """The error that is raised if the file has no morph targets, or uses a feature that this reader does not know."""


def _chunks(data: bytes) -> tuple[dict[str, Any], bytes]:
    found: dict[int, bytes] = {}
    offset = 12
    while offset + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, offset)
        found[kind] = data[offset + 8:offset + 8 + length]
        offset += 8 + length
    return json.loads(found[_JSON_CHUNK]), found.get(_BINARY_CHUNK, b"")


class _Arrays:
    """Reads the arrays of a glTF document. An array is named by the index of its accessor."""

    def __init__(self, document: dict[str, Any], binary: bytes) -> None:
        self.document, self.binary = document, binary

    def _view(self, view_index: int, offset: int, kind: str, count: int, width: int) -> numpy.ndarray:
        view = self.document["bufferViews"][view_index]
        start = view.get("byteOffset", 0) + offset
        item = numpy.dtype(kind).itemsize * width
        stride = view.get("byteStride", item)
        return numpy.ndarray((count, width), kind, self.binary, start, (stride, numpy.dtype(kind).itemsize))

    def read(self, index: int) -> numpy.ndarray:
        accessor = self.document["accessors"][index]
        kind, width, count = _TYPES[accessor["componentType"]], _WIDTHS[accessor["type"]], accessor["count"]
        values = numpy.zeros((count, width), kind)
        if "bufferView" in accessor:
            values[:] = self._view(accessor["bufferView"], accessor.get("byteOffset", 0), kind, count, width)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            at, new = sparse["indices"], sparse["values"]
            rows = self._view(at["bufferView"], at.get("byteOffset", 0), _TYPES[at["componentType"]], sparse["count"], 1)
            values[rows[:, 0]] = self._view(new["bufferView"], new.get("byteOffset", 0), kind, sparse["count"], width)
        if accessor.get("normalized"):
            values = numpy.maximum(values.astype("f4") / numpy.iinfo(kind).max, -1)
        return values


@dataclass
class Track:
    """The weights of all targets over time. The values are (n, targets) for n times, or (n, 3, targets) for a cubic
    spline."""

    times: numpy.ndarray
    values: numpy.ndarray
    interpolation: str

    def at(self, time: float) -> numpy.ndarray:
        times, values = self.times, self.values
        is_spline = self.interpolation == "CUBICSPLINE"
        own = values[:, 1] if is_spline else values
        if time <= times[0]:
            return own[0]
        if time >= times[-1]:
            return own[-1]
        k = int(numpy.searchsorted(times, time, side="right")) - 1
        if self.interpolation == "STEP":
            return own[k]
        gap = times[k + 1] - times[k]
        t = (time - times[k]) / gap
        if not is_spline:
            return (1 - t) * own[k] + t * own[k + 1]
        return ((2 * t**3 - 3 * t**2 + 1) * own[k] + gap * (t**3 - 2 * t**2 + t) * values[k, 2]
                + (-2 * t**3 + 3 * t**2) * own[k + 1] + gap * (t**3 - t**2) * values[k + 1, 0])


@dataclass
class Shown:
    """The data of one mesh of a file: positions and normals, their deltas for each target, and the animation of the
    weights."""

    positions: numpy.ndarray        # (vertices, 3)
    normals: numpy.ndarray          # (vertices, 3)
    position_deltas: numpy.ndarray  # (targets, vertices, 3)
    normal_deltas: numpy.ndarray    # (targets, vertices, 3)
    mark: dict[str, Any] | None     # extras.chronormal of a baked mesh (docs/formats.md)
    track: Track | None

    def weights(self, own: numpy.ndarray, time: float | None = None) -> numpy.ndarray:
        """Returns the weights of all targets if the author's keys have the weights `own`.

        The weights of correction targets come from the animation of the file if `time` is given, in seconds. Otherwise
        they come from the formulas in `mark`.
        """
        result = numpy.zeros(len(self.normal_deltas))
        if time is not None and self.track is not None:
            result[:] = self.track.at(time)
        result[:len(own)] = own
        for extra in (self.mark or {}).get("extras", []):
            if time is not None and self.track is not None:
                break
            result[extra["target"]] = (sum(a * own[i] for i, a in extra["linear"])
                                       + sum(q * own[i] * own[j] for i, j, q in extra["quadratic"]))
        return result

    def normals_at(self, weights: numpy.ndarray) -> numpy.ndarray:
        """Returns the unit normals that a viewer renders, (vertices, 3)."""
        total = self.normals.astype(numpy.float32)
        for target in numpy.flatnonzero(weights):
            total = total + numpy.float32(weights[target]) * self.normal_deltas[target]
        return unit(total)


def unit(vectors: numpy.ndarray) -> numpy.ndarray:
    lengths = numpy.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / numpy.where(lengths > 0, lengths, 1)


def degrees_between(a: numpy.ndarray, b: numpy.ndarray) -> numpy.ndarray:
    """Returns the angles between unit vectors in degrees. Tiny angles have full precision, too."""
    return numpy.degrees(2 * numpy.arctan2(numpy.linalg.norm(a - b, axis=-1), numpy.linalg.norm(a + b, axis=-1)))


def read(path: Path) -> Shown:
    """Reads the first mesh of a GLB, and joins its primitives in their order."""
    document, binary = _chunks(path.read_bytes())
    arrays = _Arrays(document, binary)
    if not document.get("meshes"):
        raise Unreadable("The exporter wrote no mesh. Check that the object has faces.")
    mesh = document["meshes"][0]
    primitives = [p for p in mesh["primitives"] if p.get("mode", 4) == 4 and "NORMAL" in p["attributes"]]
    if not primitives or not primitives[0].get("targets"):
        raise Unreadable("The exporter wrote no shape keys. Check that the mesh has faces and keys that are not muted.")

    def whole(key: str) -> numpy.ndarray:
        return numpy.concatenate([arrays.read(p["attributes"][key]) for p in primitives])

    def deltas(key: str) -> numpy.ndarray:
        def of(primitive: dict[str, Any], target: dict[str, int]) -> numpy.ndarray:
            if key in target:
                return arrays.read(target[key])
            return numpy.zeros((document["accessors"][primitive["attributes"]["POSITION"]]["count"], 3), "f4")
        columns = [numpy.stack([of(p, target) for target in p["targets"]]) for p in primitives]
        return numpy.concatenate(columns, axis=1)

    track = None
    for animation in document.get("animations", []):
        for channel in animation["channels"]:
            if channel["target"]["path"] == "weights" and track is None:
                sampler = animation["samplers"][channel["sampler"]]
                how = sampler.get("interpolation", "LINEAR")
                times = arrays.read(sampler["input"])[:, 0]
                shape = (len(times), 3, -1) if how == "CUBICSPLINE" else (len(times), -1)
                track = Track(times, arrays.read(sampler["output"]).reshape(shape), how)
    return Shown(whole("POSITION"), whole("NORMAL"), deltas("POSITION"), deltas("NORMAL"),
                 mesh.get("extras", {}).get("chronormal"), track)
