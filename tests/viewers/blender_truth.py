"""Makes models with shape keys, exports them, and writes beside them the normals that Blender evaluates.
blender_truth.test.mjs runs this inside Blender:

    blender --background --factory-startup --python-exit-code 1 --python blender_truth.py -- FOLDER SEED [NAME...]

Writes NAME.glb, NAME.json and NAME.bin for each model, or for the models named. NAME.json lists the `instants`:
the base, each key alone, and times of the animation, all with the `weights` of the keys. NAME.bin holds, instant
by instant, the position and normal of each of the `loops` (the corners of the polygons): six float32 in glTF's
axes.
"""
import json
import math
import os
import random
import sys

import numpy

# Blender 3.4's glTF add-on uses numpy.bool, which NumPy 1.24 does not have. Debian 12 has these versions of Blender and
# NumPy.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

import bmesh  # noqa: E402 (its add-on needs the lines above)
import bpy  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

FRAMES_PER_SECOND = 24
KEYFRAMES = [0, 12, 24, 36, 48]
INSTANTS = [0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 33, 36, 39, 42, 45, 48]


# The next functions make deformations. Each function draws parameters, and returns a function that moves the position
# of a vertex.

def bend(draw, _):
    across, along = draw.sample(range(3), 2)
    axis = Vector([float(i == across) for i in range(3)])
    speed = draw.choice((-1, 1)) * draw.uniform(0.5, 0.9)
    return lambda co: Matrix.Rotation(speed * co[along], 3, axis) @ co


def bulge(draw, _):
    along, speed, phase, size = draw.randrange(3), draw.uniform(1, 2), draw.uniform(-1, 1), draw.uniform(0.3, 0.5)
    return lambda co: co * (1 + size * math.cos(speed * co[along] + phase))


def wave(draw, _):
    to, along, size, phase = *draw.sample(range(3), 2), draw.uniform(0.15, 0.25), draw.uniform(0, 6)
    return lambda co: co + Vector([size * math.sin(3 * co[along] + phase) * (i == to) for i in range(3)])


def dent(draw, places):
    """Returns a function that moves only some of the vertices."""
    center, radius, size = draw.choice(places), draw.uniform(0.5, 0.8), draw.choice((-1, 1)) * draw.uniform(0.15, 0.3)
    way = center.normalized() if center.length > 0.1 else Vector((0, 0, 1))
    return lambda co: co + way * (size * max(0, 1 - (co - center).length_squared / radius**2) ** 2)


# The next functions make the models: objects with a mesh that is about two units wide and has no shape keys.

def edit(mesh, change):
    """Calls change() with a BMesh of a mesh, and writes the changed BMesh back."""
    editable = bmesh.new()
    editable.from_mesh(mesh)
    change(editable)
    editable.to_mesh(mesh)
    editable.free()


def shade(o, smooth=lambda polygon: True):
    for polygon in o.data.polygons:
        polygon.use_smooth = smooth(polygon)
    return o


def cut_in_rows(editable, cuts):
    bmesh.ops.subdivide_edges(editable, edges=editable.edges[:], cuts=cuts, use_grid_fill=True)


def apply(o, kind, **settings):
    """Adds a modifier of a type, such as BEVEL, with these settings to an object, and applies the modifier."""
    modifier = o.modifiers.new(kind, kind)
    for name, value in settings.items():
        setattr(modifier, name, value)
    bpy.ops.object.modifier_apply(modifier=modifier.name)


def split_at_sharp_edges(o, is_sharp):
    """Marks every BMesh edge as sharp for which is_sharp(edge) is true. Normals are then split at exactly
    these edges, in every pose."""
    def mark(editable):
        for edge in editable.edges:
            edge.smooth = not is_sharp(edge)
    edit(o.data, mark)
    o.data.use_auto_smooth = True
    o.data.auto_smooth_angle = math.pi


def tube(draw, rows):
    """Makes a closed cylinder: rows of quads, and a polygon with many corners as each cap."""
    bpy.ops.mesh.primitive_cylinder_add(vertices=draw.randrange(11, 17), radius=0.7)
    o = bpy.context.object

    def cut(editable):
        upright = [e for e in editable.edges if abs(e.verts[0].co.z - e.verts[1].co.z) > 1]
        bmesh.ops.subdivide_edges(editable, edges=upright, cuts=rows - 1)
    edit(o.data, cut)
    return shade(o)


def head(_):
    bpy.ops.mesh.primitive_monkey_add()
    apply(bpy.context.object, "SUBSURF", levels=1)
    return shade(bpy.context.object)


def sharp_cylinder(draw):
    o = tube(draw, 6)
    split_at_sharp_edges(o, lambda edge: edge.calc_face_angle() > 1)
    return o


def polygons(draw):
    """Makes a mesh of polygons with many corners, by dissolving edges."""
    o = tube(draw, 8)

    def dissolve(editable):
        edges = [e for e in editable.edges if e.calc_face_angle() < 1]
        bmesh.ops.dissolve_edges(editable, edges=draw.sample(edges, len(edges) // 6), use_verts=False)
    edit(o.data, dissolve)
    return shade(o)


def weighted(draw):
    """Makes a bevelled block with the custom normals of Blender's modifier for weighted normals."""
    bpy.ops.mesh.primitive_cube_add(size=1.4)
    o = bpy.context.object
    edit(o.data, lambda editable: cut_in_rows(editable, 3))
    apply(o, "BEVEL", width=draw.uniform(0.1, 0.2), segments=2, limit_method="ANGLE")
    shade(o)
    split_at_sharp_edges(o, lambda edge: all(v.co.z > 0.6 for v in edge.verts) and edge.calc_face_angle() > 0.3)
    apply(o, "WEIGHTED_NORMAL", keep_sharp=True)
    assert o.data.has_custom_normals
    return o


def ball(draw):
    """Makes rows of quads between two poles of triangles. The texture coordinates have a seam. Blender's own sphere is
    not used, since the order of its vertices changes from run to run.
    """
    rows, columns = draw.randrange(9, 13), draw.randrange(14, 19)

    def number(row, column):
        return 0 if row == 0 else 1 if row == rows else 2 + (row - 1) * columns + column % columns

    def place(row, column):
        up, around = math.pi * row / rows, 2 * math.pi * column / columns
        return math.sin(up) * math.cos(around), math.sin(up) * math.sin(around), math.cos(up)

    places = [place(0, 0), place(rows, 0), *(place(row, column) for row in range(1, rows) for column in range(columns))]
    corners = []
    for row in range(rows):
        for column in range(columns):
            quad = [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
            corners.append(quad[:3] if row == 0 else quad[:2] + quad[3:] if row == rows - 1 else quad)
    mesh = bpy.data.meshes.new("ball")
    mesh.from_pydata(places, [], [[number(*corner) for corner in polygon] for polygon in corners])
    coordinates = [(column / columns, row / rows) for polygon in corners for row, column in polygon]
    mesh.uv_layers.new().data.foreach_set("uv", numpy.ravel(coordinates))
    o = bpy.data.objects.new("ball", mesh)
    bpy.context.collection.objects.link(o)
    bpy.context.view_layer.objects.active = o
    return o


def mixed(draw):
    """Makes triangles, quads and flat-shaded faces. Flat-shaded faces also contribute to the normals of smooth
    corners."""
    o = ball(draw)

    def cut(editable):
        bmesh.ops.triangulate(editable, faces=draw.sample(editable.faces[:], len(editable.faces) // 3))
    edit(o.data, cut)
    return shade(o, lambda polygon: draw.random() < 0.7)


def mixed_split(draw):
    """Makes triangles, quads and flat-shaded faces. The normals of smooth faces are split where they meet flat-shaded
    faces."""
    o = mixed(draw)
    split_at_sharp_edges(o, lambda edge: False)
    return o


def mirrored(draw):
    """Makes two halves that meet at a seam, in an object with a negative scale."""
    bpy.ops.mesh.primitive_cube_add(size=2)
    o = bpy.context.object
    roundness = draw.uniform(0.3, 0.7)

    def halve(editable):
        cut_in_rows(editable, 3)
        bmesh.ops.delete(editable, geom=[v for v in editable.verts if v.co.x < -0.1], context="VERTS")
        for vertex in editable.verts:
            vertex.co = vertex.co.lerp(vertex.co.normalized(), roundness)
    edit(o.data, halve)
    apply(o, "MIRROR")
    o.scale = (-1, 1.2, 0.8)
    return shade(o)


def materials(draw):
    """Makes a smooth ball with bands of materials and a seam of its texture coordinates."""
    o = ball(draw)
    for name in "red", "green", "blue":
        o.data.materials.append(bpy.data.materials.new(name))
    for polygon in o.data.polygons:
        polygon.material_index = min(2, int(1.5 * (polygon.center.z + 1)))
    return shade(o)


def facets(_):
    """Makes a flat-shaded cube with planar sides. Edges inside a side become hard only in shape keys."""
    bpy.ops.mesh.primitive_cube_add(size=1.6)
    o = bpy.context.object
    edit(o.data, lambda editable: cut_in_rows(editable, 2))
    return shade(o, lambda polygon: False)


def grid(draw, height):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=draw.randrange(9, 14), y_subdivisions=draw.randrange(9, 14))
    o = bpy.context.object
    for vertex in o.data.vertices:
        vertex.co.z = height * math.sin(3 * vertex.co.x + 1) * math.cos(2 * vertex.co.y)
    return shade(o)


def triangles(draw):
    """Makes a grid of triangles, which are cut as an exporter cuts quads."""
    o = grid(draw, 0.3)
    edit(o.data, lambda editable: bmesh.ops.triangulate(editable, faces=editable.faces[:], quad_method="FIXED"))
    return o


def sheet(draw):
    """Makes a planar grid of quads. In the base, all weightings give the same normals; in the shape keys, they give
    different normals."""
    return grid(draw, 0)


def darts(draw):
    """Makes a grid of uneven quads. Some quads are concave, so Blender cuts them along the other diagonal."""
    o = grid(draw, 0.2)
    for vertex in o.data.vertices:
        vertex.co += Vector([draw.uniform(-size, size) for size in (0.1, 0.1, 0.02)])
    return o


def authored(draw):
    """Makes a mesh with custom normals that lean away from the normals of the surface."""
    o = shade(ball(draw))
    lean = Vector([draw.uniform(-1, 1) for _ in range(3)])
    o.data.use_auto_smooth, o.data.auto_smooth_angle = True, math.pi
    o.data.normals_split_custom_set_from_vertices([vertex.co + 0.4 * lean for vertex in o.data.vertices])
    return o


# The models: the name, the function that makes the model, the functions that deform its shape keys, and the
# interpolation of its animation.
LINEAR, CUBIC, SAMPLED = "LINEAR", "BEZIER", "every frame"
MODELS = {
    "head": (head, (bend, bulge), LINEAR),
    "sharp_cylinder": (sharp_cylinder, (bend, bulge, wave), LINEAR),
    "polygons": (polygons, (wave, bend, dent), SAMPLED),
    "weighted": (weighted, (bend, bulge), LINEAR),
    "mixed": (mixed, (bulge, bend, dent, wave), LINEAR),
    "mixed_split": (mixed_split, (bend, dent), CUBIC),
    "mirrored": (mirrored, (dent, bend, bulge), LINEAR),
    "materials": (materials, (bend, wave, dent, bulge, dent), LINEAR),
    "facets": (facets, (bend, wave), LINEAR),
    "triangles": (triangles, (wave, bulge, dent), CUBIC),
    "sheet": (sheet, (bend, wave), SAMPLED),
    "darts": (darts, (bend, wave, dent), LINEAR),
    "authored": (authored, (bend, bulge, dent), LINEAR),
}


def add_keys(o, draw, deformations):
    places = [vertex.co.copy() for vertex in o.data.vertices]
    o.shape_key_add(name="Basis")
    for n, deformation in enumerate(deformations):
        key = o.shape_key_add(name=f"{deformation.__name__}_{n}", from_mix=False)
        key.slider_min, key.slider_max = -1, 2
        moved = deformation(draw, places)
        for point, place in zip(key.data, places):
            point.co = moved(place)
    return o.data.shape_keys.key_blocks[1:]


def animate(o, keys, draw, how):
    """Adds keyframes. The first keyframe is the base. At each later keyframe, the next key has weight 1, and all other
    keys have random weights up to 0.7."""
    for n, frame in enumerate(KEYFRAMES):
        for i, key in enumerate(keys):
            key.value = 0 if n == 0 else 1 if (n - 1) % len(keys) == i else draw.uniform(0, 0.7)
            key.keyframe_insert("value", frame=frame)
    for curve in o.data.shape_keys.animation_data.action.fcurves:
        points = curve.keyframe_points
        values = [point.co.y for point in points]
        slopes = [(after - before) / 24 for before, after in zip(values[:1] + values, values[1:] + values[-1:])]
        for point, slope in zip(points, slopes):
            point.interpolation = CUBIC if how == CUBIC else LINEAR
            # If handles are at a third of the gap between keyframes, the curve is a cubic in time, which glTF can
            # represent.
            point.handle_left_type = point.handle_right_type = "FREE"
            point.handle_left = point.co - Vector((4, 4 * slope))
            point.handle_right = point.co + Vector((4, 4 * slope))


def evaluated(o):
    """Returns the position and the normal of each loop, as Blender evaluates them at the current frame, in the axes of
    glTF."""
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    instance = o.evaluated_get(graph)
    mesh = instance.to_mesh()
    mesh.calc_normals_split()
    places, normals = (numpy.empty(3 * n, numpy.float32) for n in (len(mesh.vertices), len(mesh.loops)))
    vertices = numpy.empty(len(mesh.loops), numpy.int32)
    mesh.vertices.foreach_get("co", places)
    mesh.loops.foreach_get("normal", normals)
    mesh.loops.foreach_get("vertex_index", vertices)
    instance.to_mesh_clear()
    loops = numpy.hstack([places.reshape(-1, 3)[vertices], normals.reshape(-1, 3)])
    return loops[:, [0, 2, 1, 3, 5, 4]] * numpy.float32([1, 1, -1, 1, 1, -1])


class Truth:
    """Records what Blender evaluates for an object. note() adds the current frame of the scene as an instant."""

    def __init__(self, o, keys):
        self.object, self.keys, self.instants, self.loops = o, keys, [], []

    def note(self, **more):
        self.loops.append(evaluated(self.object))
        self.instants.append({**more, "weights": [key.value for key in self.keys]})

    def write(self, path):
        """Writes the instants to PATH.json, and the positions and normals of all loops to PATH.bin."""
        numpy.concatenate(self.loops).astype("<f4").tofile(path + ".bin")
        with open(path + ".json", "w", encoding="utf-8") as file:
            json.dump({"loops": len(self.loops[0]), "instants": self.instants}, file)


def make(seed, name):
    """Makes a model in an empty scene and records what Blender evaluates for it. Returns (truth, interpolation of the
    animation)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = FRAMES_PER_SECOND, KEYFRAMES[0], KEYFRAMES[-1]
    scene.frame_set(KEYFRAMES[0])
    make_object, deformations, how = MODELS[name]
    draw = random.Random(f"{seed} {name}")
    o = make_object(draw)
    o.name = o.data.name = name
    keys = add_keys(o, draw, deformations)
    truth = Truth(o, keys)
    for alone in [None, *keys]:
        for key in keys:
            key.value = float(key == alone)
        truth.note(key=alone.name if alone else None)
    animate(o, keys, draw, how)
    for frame in INSTANTS:
        scene.frame_set(frame)
        truth.note(time=frame / FRAMES_PER_SECOND)
    scene.frame_set(KEYFRAMES[0])
    return truth, how


def export(path, how, form="GLB"):
    bpy.ops.export_scene.gltf(filepath=path, export_format=form, export_morph_normal=True,
                              export_force_sampling=how == SAMPLED, export_nla_strips=False)


def main():
    folder, seed, *names = sys.argv[sys.argv.index("--") + 1:]
    for name in names or MODELS:
        truth, how = make(int(seed), name)
        truth.write(os.path.join(folder, name))
        export(os.path.join(folder, name + ".glb"), how)


if __name__ == "__main__":
    main()
