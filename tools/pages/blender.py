"""Draws the pictures of docs/artists.md, in a window of Blender with the add-on. tools/make_page blender runs it:

    blender --factory-startup --enable-event-simulate --python blender.py -- PROGRAM MODELS FOLDER

FOLDER gets blender_export.jpg and blender_check.jpg, which are pictures of the window, and
blender_before_after.jpg, which renders a mesh at one moment with the normals of the plain file, of the corrected
file, and of Blender. MODELS is an empty folder, which the file browser shows.
"""
import math
import os
import sys
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests/viewers"))
import blender_truth  # noqa: E402 (this first: it mends NumPy for the exporter)

import bpy  # noqa: E402
import numpy  # noqa: E402
from mathutils import Matrix, Vector  # noqa: E402

ADDON = "chronormal_blender"
PROGRAM, MODELS, FOLDER = sys.argv[sys.argv.index("--") + 1:]
FRAMES = 48
PAUSE = 1.5  # seconds that the window gets to draw itself between two steps


def bend(co):
    return Matrix.Rotation(0.9 * co.x, 3, "Z") @ co


def puff(co):
    return co * (1 + 0.5 * math.cos(2 * co.z)) + Vector((0, 0.3 * co.x * co.x, 0))


def make_head():
    """Makes a head with two shape keys and an animation, in an otherwise empty scene."""
    for o in list(bpy.data.objects):
        bpy.data.objects.remove(o)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 24, 0, FRAMES
    o = blender_truth.head(None)
    o.name = o.data.name = "head"
    o.shape_key_add(name="Basis")
    for name, moved in (("bend", bend), ("puff", puff)):
        key = o.shape_key_add(name=name, from_mix=False)
        for point, vertex in zip(key.data, o.data.vertices):
            point.co = moved(vertex.co)
        for frame, value in ((0, 0.0), (FRAMES // 2, 1.0 if name == "bend" else 0.0), (FRAMES, 1.0)):
            key.value = value
            key.keyframe_insert("value", frame=frame)
    for curve in o.data.shape_keys.animation_data.action.fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene.frame_set(FRAMES)
    return o


def window():
    return bpy.context.window_manager.windows[0]


def view():
    return next(area for area in window().screen.areas if area.type == "VIEW_3D")


def in_view():
    area = view()
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window(), area=area, region=region, space_data=area.spaces[0])


def save(image, name):
    """Saves an image as JPEG, with the colours that it has on the screen."""
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.quality = "JPEG", 88
    bpy.context.scene.view_settings.view_transform = "Standard"
    image.save_render(os.path.join(FOLDER, name))


def save_window(name):
    path = os.path.join(MODELS, "window.png")
    with bpy.context.temp_override(window=window()):
        bpy.ops.screen.screenshot(filepath=path)
    save(bpy.data.images.load(path), name)
    os.remove(path)


def wait():
    """Requests that the window is drawn again. As one of `steps`, also gives regions of the window time to slide in."""
    for area in window().screen.areas:
        area.tag_redraw()


def check():
    view().spaces[0].show_region_ui = True
    with in_view():
        bpy.ops.chronormal.look(over="TIME")
        bpy.ops.view3d.view_axis(type="FRONT")
        bpy.ops.view3d.view_selected()


def open_tab():
    """Clicks the tab of the add-on's panel, which is below the tabs Item, Tool and View."""
    region = next(region for region in view().regions if region.type == "UI")
    at = {"x": region.x + region.width - 12, "y": region.y + region.height - 166}
    window().event_simulate("MOUSEMOVE", "NOTHING", **at)
    window().event_simulate("LEFTMOUSE", "PRESS", **at)
    window().event_simulate("LEFTMOUSE", "RELEASE", **at)


def open_export():
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    bpy.context.preferences.addons[ADDON].preferences.use = True
    with in_view():
        bpy.ops.export_scene.gltf("INVOKE_DEFAULT", filepath=os.path.join(MODELS, "head.glb"))


def shown_heads(o):
    """Returns three meshes at the current frame: with the normals of the plain file, of the corrected file, and of
    Blender."""
    look, truth = sys.modules[f"{ADDON}.look"], sys.modules[f"{ADDON}.truth"]
    scene = bpy.context.scene
    frames, now = look.frames_of(scene), truth.values_now(o)
    values = look.play(scene, o, frames)
    with truth.Subject(o) as subject:
        judge = look.Judge(subject, True, frames, values)
        time = judge.time_of(scene.frame_current)
        normals = [file.normals_at(file.weights(now, time))[judge.vertices] for file in (judge.plain, judge.file)]
        normals.append(subject.normals(now))
    meshes = []
    for in_gltf in normals:
        mesh = bpy.data.meshes.new_from_object(o.evaluated_get(bpy.context.evaluated_depsgraph_get()))
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi
        mesh.normals_split_custom_set((in_gltf[:, [0, 2, 1]] * numpy.float32([1, -1, 1])).tolist())
        meshes.append(mesh)
    return meshes


def render(o):
    """Renders the three meshes side by side, with the same lights for each."""
    meshes = shown_heads(o)
    bpy.ops.chronormal.clear()
    scene = bpy.context.scene
    bpy.data.objects.remove(o)
    material = bpy.data.materials.new("glossy")
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value, inputs["Roughness"].default_value = (0.04, 0.12, 0.18, 1), 0.3
    for n, mesh in enumerate(meshes):
        mesh.materials.clear()
        mesh.materials.append(material)
        head = bpy.data.objects.new("shown", mesh)
        head.location.x = 2.9 * (n - 1)
        head.rotation_euler.z = math.radians(-15)
        scene.collection.objects.link(head)
    for energy, turn in ((2.5, (50, 0, 30)), (1.2, (60, 0, -50))):
        sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
        sun.data.energy, sun.rotation_euler = energy, [math.radians(angle) for angle in turn]
        scene.collection.objects.link(sun)
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.25, 0.25, 0.25, 1)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", 8.8
    camera.location, camera.rotation_euler = (0, -20, 0.1), (math.radians(90), 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "BLENDER_EEVEE"
    scene.eevee.taa_render_samples = 16
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 1260, 330, 100
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 88
    scene.render.filepath = os.path.join(FOLDER, "blender_before_after.jpg")
    bpy.ops.render.render(write_still=True)


bpy.ops.preferences.addon_enable(module=ADDON)
bpy.context.preferences.addons[ADDON].preferences.program = PROGRAM
bpy.context.preferences.view.show_splash = False
subject = make_head()
steps = [check, open_tab, wait, lambda: save_window("blender_check.jpg"), open_export, wait, wait, lambda: save_window("blender_export.jpg"),
         lambda: bpy.ops.screen.back_to_previous(), lambda: render(subject), bpy.ops.wm.quit_blender]


def go_on():
    try:
        steps.pop(0)()
    except Exception:  # pylint: disable=broad-except
        import traceback
        traceback.print_exc()
        os._exit(1)
    return PAUSE


bpy.app.timers.register(go_on, first_interval=PAUSE)
