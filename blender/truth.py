"""Gets Blender's own normals of an object with shape keys, and exports the object by itself.

The normals and the exported file come from a copy in a separate scene, so that the user's scene does not change. The
copy has no modifiers, since the exporter leaves out modifiers of meshes with shape keys, and no animation, so that
every key can be set.
"""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
import numpy

from . import export, shown

NAME = "chronormal look"

# The axes of glTF are Blender's x, z and -y, which these indices and signs express.
_AXES, _SIGNS = [0, 2, 1], numpy.float32([1, 1, -1])

_EXPORT = {
    "export_format": "GLB", "use_active_scene": True, "export_morph": True, "export_morph_normal": True, "export_morph_tangent": False,
    "export_normals": True, "export_yup": True, "export_apply": False, "export_skins": False, "export_cameras": False,
    "export_lights": False, "export_extras": False, "export_materials": "NONE", "export_colors": False, "export_attributes": False,
    "export_force_sampling": False, "export_nla_strips": False, "export_frame_range": False, "export_current_frame": False,
    "export_animations": True, "will_save_settings": False,
}


class Refused(Exception):
    """The error that is raised if an object cannot be checked. The text says why."""


def exported_keys(mesh: bpy.types.Mesh) -> list[bpy.types.ShapeKey]:
    """Returns the keys that the exporter writes, in the exporter's order."""
    if mesh.shape_keys is None:
        return []
    return [key for key in mesh.shape_keys.key_blocks if key != key.relative_key and not key.mute]


def values_now(o: bpy.types.Object) -> numpy.ndarray:
    return numpy.array([key.value for key in exported_keys(o.data)])


class Subject:
    """A copy of an object whose keys can be set by weights. Use the copy in a `with` statement, which removes the copy
    at the end."""

    def __init__(self, o: bpy.types.Object) -> None:
        if not exported_keys(o.data):
            raise Refused("This object has no shape keys that would be exported. Add a shape key, or unmute one.")
        if not o.data.shape_keys.use_relative:
            raise Refused("Absolute shape keys are not exported to glTF. Make the shape keys relative.")
        self.original = o

    def __enter__(self) -> "Subject":
        self.mesh = self.original.data.copy()
        self.mesh.shape_keys.animation_data_clear()
        self.object = bpy.data.objects.new(NAME, self.mesh)
        self.scene = bpy.data.scenes.new(NAME)
        self.scene.collection.objects.link(self.object)
        self.scene.render.fps = bpy.context.scene.render.fps
        self.scene.render.fps_base = bpy.context.scene.render.fps_base
        self.object.show_only_shape_key = False
        self.keys = exported_keys(self.mesh)
        self.layer = self.scene.view_layers[0]
        self.folder = tempfile.TemporaryDirectory(prefix="chronormal_")
        return self

    def __exit__(self, *_: object) -> None:
        self.folder.cleanup()
        action = self.mesh.shape_keys.animation_data.action if self.mesh.shape_keys.animation_data else None
        keys = self.mesh.shape_keys
        bpy.data.scenes.remove(self.scene)
        bpy.data.objects.remove(self.object)
        bpy.data.meshes.remove(self.mesh)
        del keys
        if action is not None:
            bpy.data.actions.remove(action)

    def normals(self, weights: numpy.ndarray) -> numpy.ndarray:
        """Returns the normals that Blender evaluates at all corners, (corners, 3), in the axes of glTF."""
        for key, weight in zip(self.keys, weights):
            key.slider_min, key.slider_max = min(-10, weight), max(10, weight)
            key.value = weight
        self.mesh.update_tag()
        self.layer.update()
        instance = self.object.evaluated_get(self.layer.depsgraph)
        mesh = instance.to_mesh()
        result = numpy.empty(3 * len(mesh.loops), numpy.float32)
        if hasattr(mesh, "calc_normals_split"):
            mesh.calc_normals_split()
            mesh.loops.foreach_get("normal", result)
        else:  # for Blender 4.1 and later
            mesh.corner_normals.foreach_get("vector", result)
        instance.to_mesh_clear()
        return result.reshape(-1, 3)[:, _AXES] * _SIGNS

    def animate(self, frames: list[int], values: numpy.ndarray) -> None:
        """Animates the shape keys of the copy with linear keyframes; `values` is an array (frames, shape keys)."""
        self.mesh.shape_keys.animation_data_create().action = bpy.data.actions.new(NAME)
        curves = self.mesh.shape_keys.animation_data.action.fcurves
        for key, column in zip(self.keys, values.T):
            curve = curves.new(f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].value')
            curve.keyframe_points.add(len(frames))
            curve.keyframe_points.foreach_set("co", numpy.stack([frames, column], axis=1).ravel())
            for point in curve.keyframe_points:
                point.interpolation = "LINEAR"
            curve.update()

    def end_animation(self) -> None:
        data = self.mesh.shape_keys.animation_data
        action = data.action if data else None
        self.mesh.shape_keys.animation_data_clear()
        if action is not None:
            bpy.data.actions.remove(action)

    def export(self) -> Path:
        """Exports the copy with Blender's own exporter, and returns the path of the GLB."""
        path = Path(self.folder.name) / "plain.glb"
        known = bpy.ops.export_scene.gltf.get_rna_type().properties.keys()
        options = {name: value for name, value in _EXPORT.items() if name in known}
        export.is_paused = True
        try:
            with bpy.context.temp_override(scene=self.scene, view_layer=self.layer):
                bpy.ops.export_scene.gltf(filepath=str(path), **options)
        except RuntimeError as error:
            raise Refused(f"The exporter failed: {str(error).strip().splitlines()[-1]}. Export the object with File > Export "
                          "to see all messages.") from error
        finally:
            export.is_paused = False
        return path

    def corners_to_vertices(self, plain: shown.Shown) -> numpy.ndarray:
        """Finds for each corner of the mesh the vertex of the exported file that the corner became.

        The vertex is at the same position as the corner, in the base and in every key. If there are several such
        vertices, the one whose normals are nearest, in the base and in every key, is chosen.
        """
        mesh = self.mesh
        base = places(mesh.shape_keys.reference_key.data)
        moved = [places(key.data) - base for key in self.keys]
        in_blender = numpy.concatenate([_as_gltf(places) for places in [base, *moved]], axis=1)
        in_file = numpy.concatenate([plain.positions, *plain.position_deltas], axis=1)
        _, groups = numpy.unique(_rows(numpy.concatenate([in_blender, in_file])), return_inverse=True)
        groups = groups.ravel()
        vertices = numpy.empty(len(mesh.loops), numpy.int32)
        mesh.loops.foreach_get("vertex_index", vertices)
        of_corners, of_file = groups[vertices], groups[len(in_blender):]

        # The arrays `corner` and `vertex` list all pairs of a corner and a vertex at the same place. The pairs of
        # corner c begin at index first[c] and end before first[c + 1].
        order = numpy.argsort(of_file, kind="stable")
        begins = numpy.searchsorted(of_file[order], of_corners, side="left")
        counts = numpy.searchsorted(of_file[order], of_corners, side="right") - begins
        if (counts == 0).any():
            raise Refused("The exported file has vertices at other places than the mesh, so their normals cannot be compared. "
                          "Please report this problem of the add-on.")
        first = numpy.concatenate([[0], numpy.cumsum(counts)])
        corner = numpy.repeat(numpy.arange(len(of_corners)), counts)
        vertex = order[numpy.arange(first[-1]) - numpy.repeat(first[:-1] - begins, counts)]
        apart = numpy.zeros(len(corner), numpy.float32)
        for n in range(len(self.keys) + 1):
            weights = numpy.zeros(len(self.keys))
            weights[n - 1:n] = 1  # the first row is the base, with all weights 0
            here, there = self.normals(weights), plain.normals_at(plain.weights(weights))
            apart += ((here[corner] - there[vertex]) ** 2).sum(axis=1)
        # Sorts the pairs by corner and then by distance, so that the nearest vertex of each corner comes first.
        best = numpy.lexsort((apart, corner))
        return vertex[best[first[:-1]]]


def places(points: bpy.types.bpy_prop_collection) -> numpy.ndarray:
    result = numpy.empty(3 * len(points), numpy.float32)
    points.foreach_get("co", result)
    return result.reshape(-1, 3)


def _as_gltf(vectors: numpy.ndarray) -> numpy.ndarray:
    return vectors[:, _AXES] * _SIGNS


def _rows(table: numpy.ndarray) -> numpy.ndarray:
    """Returns one value for each row of a table of floats. Two values are equal if and only if their rows are equal.
    The rows are compared as bytes, so 0 is added to turn -0 into 0."""
    table = numpy.ascontiguousarray(table + numpy.float32(0))
    return table.view(numpy.dtype((numpy.void, table.dtype.itemsize * table.shape[1]))).ravel()
