"""Recognises meshes that were baked before they were imported.

A bake adds correction targets, which move no vertex, and lists them in `extras.chronormal` (docs/formats.md).
Blender makes shape keys of them. The keys have no effect, since Blender computes normals by itself. This module
makes the keys idle: it renames them, removes their animation and mutes them, so that the exporter leaves them out.
It also removes the mark in the extras, so that the next export bakes the author's keys anew.
"""
# SPDX-License-Identifier: MIT

from __future__ import annotations

from typing import Any, Iterable

import bpy

from .say import say

MARK = "chronormal"
IDLE = "idle correction"


def mark_of(thing: bpy.types.ID) -> dict[str, Any] | None:
    """Returns the mark that a bake left on a mesh or an object, or None if there is no mark."""
    value = thing.get(MARK)
    if hasattr(value, "to_dict"):
        value = value.to_dict()
    return value if isinstance(value, dict) and "version" in value and "extras" in value else None


def _moves_nothing(key: bpy.types.ShapeKey) -> bool:
    return all(a.co == b.co for a, b in zip(key.data, key.relative_key.data))


def _actions_of(keys: bpy.types.Key) -> Iterable[bpy.types.Action]:
    data = keys.animation_data
    if data is None:
        return
    if data.action is not None:
        yield data.action
    for track in data.nla_tracks:
        for strip in track.strips:
            if strip.action is not None:
                yield strip.action


def make_idle(mesh: bpy.types.Mesh, names: list[str | None] | None = None) -> int:
    """Makes the correction keys of a baked mesh idle, and removes the mesh's mark. Returns the number of these keys.

    `names` are the names of the keys that the importer made from the targets, with None for a target without a key.
    """
    mark = mark_of(mesh)
    if mark is None:
        return 0
    count = 0
    keys = mesh.shape_keys
    blocks = list(keys.key_blocks) if keys else []
    for extra in mark["extras"]:
        target = int(extra["target"])
        if names is not None:
            key = keys.key_blocks.get(names[target]) if keys and target < len(names) and names[target] else None
        else:
            key = blocks[target + 1] if target + 1 < len(blocks) else None
        if key is None or not _moves_nothing(key):
            continue
        path = f'key_blocks["{bpy.utils.escape_identifier(key.name)}"].value'
        for action in set(_actions_of(keys)):
            for curve in [curve for curve in action.fcurves if curve.data_path == path]:
                action.fcurves.remove(curve)
        count += 1
        key.name = f"{IDLE} {count} (chronormal)"
        key.value = 0
        key.mute = True
    for thing in [mesh, *(o for o in bpy.data.objects if o.data == mesh)]:
        if mark_of(thing) is not None:
            del thing[MARK]
    return count


def _names_of_keys(gltf: Any, node: Any) -> list[str | None] | None:
    """Returns the names of the keys that the importer made from the targets of a node's mesh. Returns None if this
    version of the importer does not record the names."""
    index = getattr(node, "mesh_node_idx", None)
    if index is None:
        return None
    return getattr(gltf.data.meshes[gltf.data.nodes[index].mesh], "shapekey_names", None)


class RecogniseBakedFiles:
    """The class whose hooks Blender's importer of glTF calls. The importer ignores exceptions of hooks, so a file is
    imported even if a hook fails."""

    def gather_import_scene_after_animation_hook(self, _gltf_scene: Any, _blender_scene: Any, gltf: Any) -> None:
        meshes = count = 0
        objects = [(node, getattr(node, "blender_object", None)) for node in gltf.vnodes.values()]
        for node, o in objects:
            if o is not None and o.type == "MESH" and mark_of(o.data) is not None:
                meshes += 1
                count += make_idle(o.data, _names_of_keys(gltf, node))
        # gltfpack moves a mesh into a new node below the old one, so the mark may be on an object above the mesh.
        for _, o in objects:
            if o is not None and mark_of(o) is not None:
                del o[MARK]
        if meshes:
            what = "1 mesh was" if meshes == 1 else f"{meshes} meshes were"
            say("INFO", f"{what} baked by chronormal. The correction keys ({count}) are muted and named \"{IDLE} ...\": export with "
                        "the option Right normals for shape keys to bake the author's keys again.")


class CHRONORMAL_OT_make_idle(bpy.types.Operator):
    """Mute the correction keys of this mesh, which was baked and imported without the add-on"""

    bl_idname = "chronormal.make_idle"
    bl_label = "Mute correction keys"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type == "MESH" and mark_of(context.object.data) is not None

    def execute(self, context: bpy.types.Context) -> set[str]:
        count = make_idle(context.object.data)
        self.report({"INFO"}, f"{count} correction key{' is' if count == 1 else 's are'} muted and named \"{IDLE} ...\"")
        return {"FINISHED"}


def register() -> None:
    bpy.utils.register_class(CHRONORMAL_OT_make_idle)


def unregister() -> None:
    bpy.utils.unregister_class(CHRONORMAL_OT_make_idle)
