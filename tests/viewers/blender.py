"""Imports a glTF file into Blender, reports the result, and exports it again. blender.test.mjs runs this inside
Blender:

    blender --background --factory-startup --python-exit-code 1 --python blender.py -- IN.glb REPORT.json OUT.glb

REPORT.json has for each mesh, in the order of names: `keys`, the names of its shape keys without the basis; and
`positions`, the positions of all vertices at ten instants of the animation, in Blender's axes.
"""
import json
import sys

import numpy

# Blender 3.4's glTF add-on uses numpy.bool, which NumPy 1.24 does not have. Debian 12 has these versions of Blender and
# NumPy.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

import bpy  # noqa: E402 (its add-on needs the lines above)

INSTANTS = 10

source, report, target = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=source)

scene = bpy.context.scene
objects = sorted((o for o in bpy.data.objects if o.type == "MESH"), key=lambda o: o.name)
ends = [tuple(action.frame_range) for action in bpy.data.actions]
first, last = min(begin for begin, _ in ends), max(end for _, end in ends)
positions = {o.name: [] for o in objects}
for n in range(INSTANTS):
    frame = first + (last - first) * n / (INSTANTS - 1)
    scene.frame_set(int(frame), subframe=frame % 1)
    evaluated = bpy.context.evaluated_depsgraph_get()
    for o in objects:
        mesh = o.evaluated_get(evaluated).data
        flat = numpy.empty(3 * len(mesh.vertices), numpy.float32)
        mesh.vertices.foreach_get("co", flat)
        positions[o.name].extend(flat.tolist())

meshes = [{"name": o.name, "keys": [key.name for key in o.data.shape_keys.key_blocks][1:], "positions": positions[o.name]}
          for o in objects]
with open(report, "w", encoding="utf-8") as file:
    json.dump({"version": bpy.app.version_string, "meshes": meshes}, file)
scene.frame_set(0)
bpy.ops.export_scene.gltf(filepath=target, export_format="GLB", export_morph_normal=True, export_extras=True)
