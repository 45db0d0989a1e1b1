"""Shows the error of each corner of a mesh, as attributes: a colour to look at, and a number of degrees."""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import bpy
import numpy

COLOUR = "Normal error"
DEGREES = "Normal error in degrees"

# The colours of the scale, from no error to the largest one, as they look on the screen (sRGB).
RAMP = ((0.80, 0.82, 0.84), (0.97, 0.87, 0.35), (0.96, 0.55, 0.16), (0.84, 0.15, 0.12), (0.45, 0.02, 0.25))

# The attributes that hide() has removed and show() restores, as pairs of the name of a mesh and the errors of its
# corners in degrees.
_hidden: list[tuple[str, numpy.ndarray]] = []

# The number of degrees at the end of the colour scale.
_top = 10.0

# The name of the colour attribute that was active in a mesh before paint() added its own. The key is the mesh's name.
_active_before: dict[str, str] = {}


def ramp(shares: numpy.ndarray) -> numpy.ndarray:
    """Returns the colour for each of n positions on the scale, which runs from 0 to 1, as an array (n, 4)."""
    knots = numpy.linspace(0, 1, len(RAMP))
    channels = [numpy.interp(shares, knots, [colour[c] for colour in RAMP]) for c in range(3)]
    return numpy.stack([*channels, numpy.ones_like(shares)], axis=1).astype(numpy.float32)


def paint(mesh: bpy.types.Mesh, degrees: numpy.ndarray, top: float) -> None:
    """Adds to a mesh two attributes of its corners: the error in degrees, and a colour for the error."""
    global _top
    _top = top
    clear(mesh)
    if mesh.color_attributes.active_color is not None:
        _active_before[mesh.name] = mesh.color_attributes.active_color.name
    colour = mesh.color_attributes.new(COLOUR, "BYTE_COLOR", "CORNER")
    colour.data.foreach_set("color_srgb", ramp(numpy.clip(degrees / top, 0, 1)).ravel())
    mesh.attributes.new(DEGREES, "FLOAT", "CORNER").data.foreach_set("value", degrees.astype(numpy.float32))
    mesh.color_attributes.active_color = mesh.color_attributes[COLOUR]
    mesh.update()


def clear(mesh: bpy.types.Mesh) -> bool:
    """Removes the attributes that paint() added. Returns True if there were any."""
    names = [name for name in (COLOUR, DEGREES) if name in mesh.attributes]
    for name in names:
        mesh.attributes.remove(mesh.attributes[name])
    active = mesh.color_attributes.get(_active_before.pop(mesh.name, ""))
    if names and active is not None:
        mesh.color_attributes.active_color = active
    return bool(names)


def hide() -> None:
    """Removes from all meshes the attributes that paint() added, before an export, since the exporter would write them
    into the file."""
    _hidden.clear()
    for mesh in bpy.data.meshes:
        attribute = mesh.attributes.get(DEGREES)
        if attribute is not None:
            degrees = numpy.empty(len(attribute.data), numpy.float32)
            attribute.data.foreach_get("value", degrees)
            _hidden.append((mesh.name, degrees))
        clear(mesh)


def show() -> None:
    """Restores the attributes that hide() removed."""
    for name, degrees in _hidden:
        mesh = bpy.data.meshes.get(name)
        if mesh is not None and len(mesh.loops) == len(degrees):
            paint(mesh, degrees, _top)
    _hidden.clear()
