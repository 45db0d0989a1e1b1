"""Uses the add-on of blender/ like a person, and records the results. blender_addon.test.mjs runs this inside
Blender, with the add-on in the folder for add-ons (BLENDER_USER_SCRIPTS):

    blender --background --factory-startup --python-exit-code 1 --python blender_addon.py -- TASK FOLDER
    ARGUMENT...

Each task is a function below. The results are in FOLDER/TASK.json, beside the exported files.
"""
import json
import os
import random
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import blender_truth  # noqa: E402 (this first: it mends NumPy for the exporter)

import addon_utils  # noqa: E402
import bpy  # noqa: E402
import numpy  # noqa: E402

ADDON = "chronormal_blender"


def switch_on(program):
    """Enables the add-on and sets the path of the program in its preferences. The add-on is disabled after every start
    of Blender and in every new model."""
    bpy.ops.preferences.addon_enable(module=ADDON)
    preferences = bpy.context.preferences.addons[ADDON].preferences
    preferences.program = program
    return preferences


def part(name):
    """Returns the module of the add-on with this name."""
    return sys.modules[f"{ADDON}.{name}"]


def select(o):
    bpy.context.view_layer.objects.active = o
    o.select_set(True)


def looked_at(o, over, judged):
    """Lets the panel check an object. Returns the average and the worst error in degrees, the largest error that the
    mesh stores as colour, and the rows of the panel's list."""
    select(o)
    state = bpy.context.window_manager.chronormal
    state.judged = judged
    found = part("look").look(bpy.context, o, over)
    assert bpy.ops.chronormal.look(over=over) == {"FINISHED"}
    degrees = numpy.empty(len(o.data.loops), numpy.float32)
    o.data.attributes["Normal error in degrees"].data.foreach_get("value", degrees)
    return {"mean": found.mean, "worst": max(pose.worst for pose in found.poses),
            "painted": float(degrees.max()), "average": state.average, "poses": len(found.poses),
            "findings": [[f.kind, f.label, f.degrees] for f in state.findings]}


def everything():
    """Returns the names of all data in the Blender file."""
    kinds = ("scenes", "objects", "meshes", "actions", "shape_keys", "materials")
    return {kind: sorted(one.name for one in getattr(bpy.data, kind)) for kind in kinds}


def models(folder, program, seed):
    """Exports every model four times: without the add-on, with the add-on switched off, with the add-on switched off
    after the panel has checked the model, and with the add-on switched on."""
    result = {}
    for name in blender_truth.MODELS:
        truth, how = blender_truth.make(int(seed), name)
        path = os.path.join(folder, name)
        truth.write(path)
        blender_truth.export(path + ".glb", how)
        before = everything()
        preferences = switch_on(program)
        assert not preferences.use
        blender_truth.export(path + ".off.glb", how)
        preferences.viewers, preferences.tolerance = {"three"}, 0.01
        o = truth.object
        found = {"over_time": looked_at(o, "TIME", "PLAIN"), "baked_over_time": looked_at(o, "TIME", "BAKED"),
                 "keys": looked_at(o, "KEYS", "PLAIN")}
        found["leaves"] = everything() == before
        blender_truth.export(path + ".looked_at.glb", how)
        found["colours_are_back"] = "Normal error" in o.data.color_attributes
        preferences.use = True
        blender_truth.export(path + ".right.glb", how)
        found["report"] = part("say").last
        if name == "head":
            blender_truth.export(path + ".right.gltf", how, "GLTF_SEPARATE")
        o.data.shape_keys.animation_data_clear()
        draw = random.Random(f"{seed} poses of {name}")
        posed = blender_truth.Truth(o, truth.keys)
        found["posed"] = []
        for _ in range(3):
            for key in truth.keys:
                key.value = draw.uniform(-0.5, 1.2)
            posed.note()
            found["posed"].append(looked_at(o, "NOW", "PLAIN"))
        posed.write(path + ".posed")
        found["jumps"] = jumps(o)
        result[name] = found
    return result


def jumps(o):
    """Makes the panel jump to the first pair of shape keys in its list. Returns the error that the list states, the
    largest error after the jump, both in degrees, and the number of shape keys at weight 1. Returns None if no pair is
    listed."""
    state = bpy.context.window_manager.chronormal
    if looked_at(o, "KEYS", "PLAIN")["findings"] == []:
        return None
    pairs = [n for n, finding in enumerate(state.findings) if finding.kind == "PAIR"]
    if not pairs:
        return None
    said = state.findings[pairs[0]].degrees
    assert bpy.ops.chronormal.jump(index=pairs[0]) == {"FINISHED"}
    degrees = numpy.empty(len(o.data.loops), numpy.float32)
    o.data.attributes["Normal error in degrees"].data.foreach_get("value", degrees)
    return {"said": said, "there": float(degrees.max()), "ones": sum(key.value == 1 for key in o.data.shape_keys.key_blocks[1:])}


def failures(folder, program):
    """Exports once as usual, then in cases in which a bake fails or may fail. `folder` contains programs that fail."""
    truth, how = blender_truth.make(1, "triangles")
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    blender_truth.export(path("plain.glb"), how)
    preferences = switch_on(program)
    preferences.use = True
    result = {}

    def export(case, file=None):
        part("say").last = ("", "")
        blender_truth.export(path(file or case + ".glb"), how)
        result[case] = part("say").last

    export("right")
    export("umlauts", "Köpfe und Löcher/Größe 1 – äöü.glb")
    export("read_only", "read_only/there.glb")
    for case in ("missing", "failing", "silent", "no_program"):
        preferences.program = path(case)
        export(case)
    preferences.program = ""
    search, os.environ["PATH"] = os.environ["PATH"], folder + "/nowhere"
    export("none")
    os.environ["PATH"] = search

    preferences.program = program
    from io_scene_gltf2.io.exp import gltf2_io_export
    original = gltf2_io_export.save_gltf
    other = gltf2_io_export.save_gltf = lambda *anything: original(*anything)
    export("unknown")
    assert gltf2_io_export.save_gltf is other
    gltf2_io_export.save_gltf = original
    return result


def leaves(folder, program):
    """Returns the state of Blender before the add-on is enabled, while the add-on is in use, and after it is disabled.
    """
    from io_scene_gltf2.io.exp import gltf2_io_export

    def state():
        return {"types": sorted(dir(bpy.types)), "wm": sorted(bpy.types.WindowManager.bl_rna.properties.keys()),
                "operators": [name for name in dir(bpy.ops.chronormal)], "addons": sorted(bpy.context.preferences.addons.keys()),
                "handlers": [len(getattr(bpy.app.handlers, name)) for name in dir(bpy.app.handlers)
                             if isinstance(getattr(bpy.app.handlers, name), list)],
                "attributes": [sorted(mesh.attributes.keys()) for mesh in bpy.data.meshes],
                "writer": gltf2_io_export.save_gltf.__module__ + " " + gltf2_io_export.save_gltf.__name__,
                "data": everything()}

    truth, how = blender_truth.make(1, "triangles")
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    before = state()
    preferences = switch_on(program)
    preferences.use = True
    looked_at(truth.object, "NOW", "BAKED")
    blender_truth.export(os.path.join(folder, "left.glb"), how)
    # Imitates an export that fails before it writes a file, and therefore leaves a function of the add-on in the
    # exporter.
    part("export").before_export({})
    part("colours").show()
    during = state()
    bpy.ops.preferences.addon_disable(module=ADDON)
    return {"before": before, "during": during, "after": state()}


def by_hand(path, program):
    """Imports a file without the add-on, and mutes its correction keys by the button of the add-on. Returns the number
    of muted keys."""
    bpy.ops.preferences.addon_disable(module=ADDON)
    bpy.ops.import_scene.gltf(filepath=path)
    switch_on(program)
    o = bpy.context.object
    if bpy.ops.chronormal.make_idle.poll():
        assert bpy.ops.chronormal.make_idle() == {"FINISHED"}
    muted = sum(key.mute for key in o.data.shape_keys.key_blocks)
    is_marked = "chronormal" in o or "chronormal" in o.data
    return [muted, is_marked]


def imports(folder, program, *names):
    """Imports each file NAME.glb and exports it again: with the add-on switched off as NAME.again_off.glb, and with the
    add-on switched on as NAME.again.glb."""
    result = {}
    for name in names:
        path = os.path.join(folder, name)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        preferences = switch_on(program)
        part("say").last = ("", "")
        bpy.ops.import_scene.gltf(filepath=path + ".glb")
        found = {"report": part("say").last}
        (o,) = [one for one in bpy.data.objects if one.type == "MESH"]
        found["keys"] = [[key.name, key.mute, key.value] for key in o.data.shape_keys.key_blocks[1:]]
        found["curves"] = [curve.data_path for action in bpy.data.actions for curve in action.fcurves]
        found["marks"] = ["chronormal" in o, "chronormal" in o.data]
        options = {"export_format": "GLB", "export_morph_normal": True, "export_extras": True, "export_nla_strips": False,
                   "export_force_sampling": False}
        bpy.ops.export_scene.gltf(filepath=path + ".again_off.glb", **options)
        preferences.use = True
        bpy.ops.export_scene.gltf(filepath=path + ".again.glb", **options)
        found["again"] = part("say").last
        found["by_hand"] = by_hand(path + ".glb", program)
        result[name] = found
    return result


def installs(folder, archive):
    """Installs the zip file of the add-on as Blender's preferences do, and exports with the program in the zip file."""
    truth, how = blender_truth.make(1, "triangles")
    bpy.ops.preferences.addon_install(filepath=archive)
    preferences = switch_on("")
    preferences.use = True
    blender_truth.export(os.path.join(folder, "installed.glb"), how)
    return {"report": part("say").last, "program": str(part("program").find("")), "place": addon_utils.paths(),
            "file": part("program").__file__}


task, output, *arguments = sys.argv[sys.argv.index("--") + 1:]
outcome = globals()[task](output, *arguments)
with open(os.path.join(output, task + ".json"), "w", encoding="utf-8") as file:
    json.dump(outcome, file)
