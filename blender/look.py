"""The panel "Check shape-key normals": shows where a viewer would show wrong normals, and by how many degrees.

The object is exported by itself into a temporary file, which is also baked if the user asks for this. The normals
that a viewer renders from that file (shown.py) are compared with the normals that Blender evaluates at the same
values of the keys (truth.py), for every corner of every face.
"""
# SPDX-License-Identifier: MIT

import json
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Iterable, Iterator

import bpy
import numpy
from mathutils import Vector

from . import baked, colours, program, settings, shown, truth

# The largest numbers of frames and of pairs of keys that are checked.
MOST_FRAMES, MOST_PAIRS = 250, 100
LISTED_FRAMES, LISTED_KEYS, LISTED_PAIRS, LISTED_PLACES = 3, 6, 6, 5
# The smallest distance between two vertices in the panel's list, as a share of the object's size, and between two
# frames in the list, as a share of the number of judged frames.
APART = 0.1
# Poses and vertices whose error is below this number of degrees are not in the panel's list.
VISIBLE = 0.1


@dataclass
class Pose:
    """A pose to check: the values of the shape keys, and the name of the pose."""

    kind: str  # one of the kinds of Finding.kind
    name: str
    weights: numpy.ndarray
    frame: int | None = None
    time: float | None = None  # seconds in the exported file
    mean: float = 0
    worst: float = 0


@dataclass
class Found:
    """The checked poses with their errors in degrees. For every corner, `worst` is its largest error, and `which`
    is the index of the pose in which this error occurs."""

    poses: list[Pose]
    worst: numpy.ndarray
    which: numpy.ndarray

    @property
    def mean(self) -> float:
        return sum(pose.mean for pose in self.poses) / len(self.poses)


class Judge:
    """Compares the normals that a viewer would render from an exported file with the normals that Blender shows."""

    def __init__(self, subject: truth.Subject, is_baked: bool, frames: list[int], values: numpy.ndarray) -> None:
        self.subject, self.frames = subject, frames
        self.is_animated = len(frames) > 1 and bool((values != values[0]).any())
        if self.is_animated:
            subject.animate(frames, values)
        path = subject.export()
        subject.end_animation()
        self.plain = self.file = shown.read(path)
        self.vertices = subject.corners_to_vertices(self.plain)
        if is_baked:
            self.file = shown.read(_baked(path))

    def errors(self, weights: numpy.ndarray, time: float | None = None) -> numpy.ndarray:
        """Returns the error of every corner in degrees at the given weights of the author's keys."""
        normals = self.file.normals_at(self.file.weights(weights, time))
        return shown.degrees_between(normals[self.vertices], shown.unit(self.subject.normals(weights)))

    def judge(self, poses: Iterable[Pose]) -> Found:
        """Judges poses one by one. Only the worst error of each corner is kept, since the errors of all corners in all
        poses may not fit into memory."""
        found = Found([], numpy.full(len(self.vertices), -1, numpy.float32), numpy.zeros(len(self.vertices), numpy.int32))
        for pose in poses:
            errors = self.errors(pose.weights, pose.time)
            pose.mean, pose.worst = float(errors.mean()), float(errors.max())
            is_worse = errors > found.worst
            found.worst[is_worse], found.which[is_worse] = errors[is_worse], len(found.poses)
            found.poses.append(pose)
        return found

    def time_of(self, frame: int) -> float | None:
        """Returns the time of a frame in the file, in seconds, or None if the file has no animation at this frame."""
        if not self.is_animated or self.plain.track is None or frame not in self.frames:
            return None
        return float(self.plain.track.times[self.frames.index(frame)])


def _baked(path: Path) -> Path:
    """Bakes the temporary file with the settings of the export."""
    result = path.with_name("baked.glb")
    outcome = program.bake(program.find(settings.program_path()), path, result, settings.get().options())
    if not outcome.wrote:
        raise truth.Refused("The file could not be corrected: " + " ".join(outcome.said))
    return result


def frames_of(scene: bpy.types.Scene) -> list[int]:
    """Returns the frames of the timeline and the current frame. If the timeline has more than MOST_FRAMES frames,
    returns only frames at equal steps, the last frame and the current frame."""
    step = max(1, -(-(scene.frame_end - scene.frame_start + 1) // MOST_FRAMES))
    frames = set(range(scene.frame_start, scene.frame_end + 1, step)) | {scene.frame_end, scene.frame_current}
    return sorted(frames)


def play(scene: bpy.types.Scene, o: bpy.types.Object, frames: list[int]) -> numpy.ndarray:
    """Returns the values of the keys at the given frames as an array (frames, keys). Blender evaluates the scene at
    each frame, so values that an animation or a driver sets are included."""
    current, subframe, now = scene.frame_current, scene.frame_subframe, truth.values_now(o)
    values = []
    for frame in frames:
        scene.frame_set(frame)
        values.append(truth.values_now(o))
    scene.frame_set(current, subframe=subframe)
    for key, value in zip(truth.exported_keys(o.data), now):
        if key.value != value:
            key.value = value
    return numpy.array(values)


def poses_now(judge: Judge, scene: bpy.types.Scene, now: numpy.ndarray) -> Iterator[Pose]:
    """Returns the pose that the sliders have now. The pose gets the time of the current frame if the animation of the
    file gives the same values at that frame."""
    time = judge.time_of(scene.frame_current)
    if time is not None and not numpy.allclose(judge.plain.track.at(time), now, atol=1e-4):
        time = None
    yield Pose("NOW", "the sliders now", now, scene.frame_current, time)


def poses_over_time(judge: Judge, values: numpy.ndarray) -> Iterator[Pose]:
    for frame, weights in zip(judge.frames, values):
        yield Pose("FRAME", f"frame {frame}", weights, frame, judge.time_of(frame))


def poses_of_keys(judge: Judge) -> Iterator[Pose]:
    """Returns the poses with one key alone, and with two keys that change the same normals."""
    keys = judge.subject.keys
    for k, key in enumerate(keys):
        for weight in (0.25, 0.5, 0.75, 1.0):
            weights = numpy.zeros(len(keys))
            weights[k] = weight
            yield Pose("KEY", f"{key.name} at {weight:g}", weights)
    turned = numpy.linalg.norm(judge.plain.normal_deltas, axis=2)
    shared = turned @ turned.T
    pairs = sorted((pair for pair in combinations(range(len(keys)), 2) if shared[pair] > 0), key=lambda pair: -shared[pair])
    for i, j in pairs[:MOST_PAIRS]:
        weights = numpy.zeros(len(keys))
        weights[[i, j]] = 1
        yield Pose("PAIR", f"{keys[i].name} + {keys[j].name}", weights)


class Finding(bpy.types.PropertyGroup):
    """A row of the list in the panel: a pose, or a place on the mesh."""

    kind: bpy.props.EnumProperty(items=[(name, name, "") for name in ("NOW", "FRAME", "KEY", "PAIR", "PLACE")])
    label: bpy.props.StringProperty()
    degrees: bpy.props.FloatProperty()
    weights: bpy.props.StringProperty()  # JSON; empty if weights cannot set the pose
    frame: bpy.props.IntProperty(default=-(1 << 30))
    vertex: bpy.props.IntProperty(default=-1)


NO_FRAME = -(1 << 30)


def _repaint(state: "State", context: bpy.types.Context) -> None:
    o = context.object
    if o is not None and o.type == "MESH" and colours.DEGREES in o.data.attributes:
        attribute = o.data.attributes[colours.DEGREES]
        degrees = numpy.empty(len(attribute.data), numpy.float32)
        attribute.data.foreach_get("value", degrees)
        colours.paint(o.data, degrees, state.top)


def _keep(_state: "State", _colour: object) -> None:
    """A setter that ignores changes of a colour of the scale. Without a setter, Blender would grey the colour out."""


class State(bpy.types.PropertyGroup):
    """The content of the panel, which belongs to the window manager and is never written into a file."""

    judged: bpy.props.EnumProperty(
        name="File",
        description="The file that is compared with Blender's normals",
        items=[("PLAIN", "As exported", "The file as Blender exports it"),
               ("BAKED", "Corrected", "The file with right normals, by the settings of the export panel")],
    )
    top: bpy.props.FloatProperty(
        name="Darkest at", description="The error, in degrees, that is shown in the last colour of the scale",
        min=0.01, max=180, soft_min=1, soft_max=90, default=10, precision=1, update=_repaint,
    )
    findings: bpy.props.CollectionProperty(type=Finding)
    active: bpy.props.IntProperty()
    average: bpy.props.StringProperty()
    worst: bpy.props.StringProperty()
    object: bpy.props.StringProperty()
    shading: bpy.props.StringProperty()  # JSON: the shading of the viewport before the check
    colour_0: bpy.props.FloatVectorProperty(subtype="COLOR_GAMMA", get=lambda _: colours.RAMP[0], set=_keep)
    colour_1: bpy.props.FloatVectorProperty(subtype="COLOR_GAMMA", get=lambda _: colours.RAMP[1], set=_keep)
    colour_2: bpy.props.FloatVectorProperty(subtype="COLOR_GAMMA", get=lambda _: colours.RAMP[2], set=_keep)
    colour_3: bpy.props.FloatVectorProperty(subtype="COLOR_GAMMA", get=lambda _: colours.RAMP[3], set=_keep)
    colour_4: bpy.props.FloatVectorProperty(subtype="COLOR_GAMMA", get=lambda _: colours.RAMP[4], set=_keep)


def _add(state: State, kind: str, label: str, degrees: float, weights: numpy.ndarray | None = None,
         frame: int | None = None, vertex: int = -1) -> None:
    finding = state.findings.add()
    finding.kind, finding.label, finding.degrees, finding.vertex = kind, label, degrees, vertex
    finding.frame = NO_FRAME if frame is None else frame
    finding.weights = "" if weights is None else json.dumps(weights.tolist())


def _list_poses(state: State, poses: list[Pose]) -> None:
    """Chooses the poses to list: the worst frames that are not close to each other, and the worst keys and pairs, each
    with its worst weight."""
    near = APART * sum(pose.kind == "FRAME" for pose in poses)
    for kind, most in (("FRAME", LISTED_FRAMES), ("KEY", LISTED_KEYS), ("PAIR", LISTED_PAIRS)):
        seen: set[tuple[int, ...]] = set()
        for pose in sorted((p for p in poses if p.kind == kind), key=lambda p: -p.worst):
            subject = (pose.frame,) if kind == "FRAME" else tuple(numpy.flatnonzero(pose.weights))
            if pose.worst < VISIBLE or len(seen) == most:
                break
            is_near = kind == "FRAME" and any(abs(pose.frame - frame) <= near for frame, in seen)
            if subject not in seen and not is_near:
                seen.add(subject)
                _add(state, kind, pose.name, pose.worst, None if kind == "FRAME" else pose.weights, pose.frame)


def _list_places(state: State, mesh: bpy.types.Mesh, found: Found) -> None:
    """Chooses the places to list, which are the vertices with the largest errors that are not close to each other."""
    vertices = numpy.empty(len(mesh.loops), numpy.int32)
    mesh.loops.foreach_get("vertex_index", vertices)
    places = truth.places(mesh.vertices)
    size = float(numpy.linalg.norm(places.max(axis=0) - places.min(axis=0)))
    taken: list[numpy.ndarray] = []
    for corner in numpy.argsort(-found.worst):
        if found.worst[corner] < VISIBLE or len(taken) == LISTED_PLACES:
            break
        place = places[vertices[corner]]
        if all(numpy.linalg.norm(place - other) > APART * size for other in taken):
            taken.append(place)
            pose = found.poses[found.which[corner]]
            moved = pose.weights if pose.kind in ("KEY", "PAIR") else None
            label = pose.name if len(found.poses) > 1 else f"vertex {vertices[corner]}"
            _add(state, "PLACE", label, float(found.worst[corner]), moved,
                 pose.frame if pose.kind == "FRAME" else None, int(vertices[corner]))


def look(context: bpy.types.Context, o: bpy.types.Object, over: str) -> Found:
    """Judges the poses that `over` selects. NOW selects the current pose, TIME the poses of all frames, and KEYS each
    key alone and pairs of keys."""
    state, scene = context.window_manager.chronormal, context.scene
    is_baked = state.judged == "BAKED"
    frames = frames_of(scene) if is_baked or over == "TIME" else []
    values = play(scene, o, frames) if frames else numpy.empty((0, 0))
    now = truth.values_now(o)
    with truth.Subject(o) as subject:
        judge = Judge(subject, is_baked, frames, values)
        if over == "NOW":
            return judge.judge(poses_now(judge, scene, now))
        return judge.judge(poses_over_time(judge, values) if over == "TIME" else poses_of_keys(judge))


def paint(context: bpy.types.Context, o: bpy.types.Object, found: Found) -> None:
    """Colours every corner by its worst error."""
    state = context.window_manager.chronormal
    colours.paint(o.data, found.worst, state.top)
    space = context.space_data
    if space is not None and space.type == "VIEW_3D":
        if not state.shading:
            state.shading = json.dumps([space.shading.type, space.shading.color_type])
        space.shading.type, space.shading.color_type = "SOLID", "VERTEX"


class _Looking:
    """Holds the code that the operators of the panel share."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        o = context.object
        return o is not None and o.type == "MESH" and o.mode == "OBJECT" and o.data.shape_keys is not None

    def look(self, context: bpy.types.Context, over: str) -> Found | None:
        try:
            context.window_manager.progress_begin(0, 1)
            found = look(context, context.object, over)
            paint(context, context.object, found)
            return found
        except (truth.Refused, shown.Unreadable, program.Unavailable) as error:
            self.report({"WARNING"}, str(error))
            return None
        finally:
            context.window_manager.progress_end()


class CHRONORMAL_OT_look(_Looking, bpy.types.Operator):
    """Colour the mesh by the angles between the normals of a viewer and those that Blender shows"""

    bl_idname = "chronormal.look"
    bl_label = "Check shape-key normals"

    over: bpy.props.EnumProperty(
        name="Over",
        items=[("NOW", "The sliders now", "The shape keys at their current values"),
               ("TIME", "The timeline", "The worst error of each corner over all frames of the timeline"),
               ("KEYS", "Keys and pairs", "Each key by itself, and pairs of keys that turn the same normals")],
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        found = self.look(context, self.over)
        if found is None:
            return {"CANCELLED"}
        o, state = context.object, context.window_manager.chronormal
        state.findings.clear()
        state.active, state.object = 0, o.name
        _list_poses(state, found.poses)
        _list_places(state, o.data, found)
        worst = max(found.poses, key=lambda pose: pose.worst)
        state.average = f"On average {found.mean:.2f}\N{DEGREE SIGN}"
        state.worst = f"At worst {worst.worst:.2f}\N{DEGREE SIGN}" + ("" if self.over == "NOW" else f", {worst.name}")
        self.report({"INFO"}, f"Error of the normals of {o.name}: {state.average.lower()}, {state.worst.lower()}")
        return {"FINISHED"}


class CHRONORMAL_OT_jump(_Looking, bpy.types.Operator):
    """Go to this pose or place: set the sliders or the frame, colour the mesh, and turn the view to the place"""

    bl_idname = "chronormal.jump"
    bl_label = "Go there"

    index: bpy.props.IntProperty()

    def execute(self, context: bpy.types.Context) -> set[str]:
        state, o = context.window_manager.chronormal, context.object
        if o.name != state.object or not 0 <= self.index < len(state.findings):
            self.report({"WARNING"}, "This list is about another object. Check the selected object first.")
            return {"CANCELLED"}
        state.active = self.index
        finding = state.findings[self.index]
        if finding.frame != NO_FRAME:
            context.scene.frame_set(finding.frame)
        if finding.weights:
            for key, weight in zip(truth.exported_keys(o.data), json.loads(finding.weights)):
                key.value = weight
        if finding.frame != NO_FRAME or finding.weights:
            if self.look(context, "NOW") is None:
                return {"CANCELLED"}
        if finding.vertex >= 0:
            _show_vertex(context, o, finding.vertex)
        return {"FINISHED"}


def _show_vertex(context: bpy.types.Context, o: bpy.types.Object, index: int) -> None:
    """Turns the view to a vertex at its current, deformed position."""
    view = getattr(context.space_data, "region_3d", None)
    if view is None:
        return
    instance = o.evaluated_get(context.evaluated_depsgraph_get())
    mesh = instance.to_mesh()
    if index < len(mesh.vertices):
        vertex = mesh.vertices[index]
        view.view_location = o.matrix_world @ vertex.co
        direction = o.matrix_world.to_3x3().inverted_safe().transposed() @ Vector(vertex.normal)
        view.view_rotation = direction.to_track_quat("Z", "Y")
        view.view_distance = 0.8 * max(o.dimensions)
    instance.to_mesh_clear()


class CHRONORMAL_OT_clear(bpy.types.Operator):
    """Remove the colours and the list"""

    bl_idname = "chronormal.clear"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        state = context.window_manager.chronormal
        for mesh in bpy.data.meshes:
            colours.clear(mesh)
        space = context.space_data
        if state.shading and space is not None and space.type == "VIEW_3D":
            space.shading.type, space.shading.color_type = json.loads(state.shading)
        state.shading = state.average = state.worst = state.object = ""
        state.findings.clear()
        return {"FINISHED"}


class CHRONORMAL_UL_findings(bpy.types.UIList):
    ICONS = {"NOW": "DOT", "FRAME": "TIME", "KEY": "SHAPEKEY_DATA", "PAIR": "LINKED", "PLACE": "VERTEXSEL"}

    def draw_item(self, _context, layout, _data, item, _icon, _active_data, _active_property, index=0) -> None:
        row = layout.row(align=True)
        parts = row.split(factor=0.46)
        parts.label(text=f"{item.degrees:.{2 if item.degrees < 1 else 1}f}\N{DEGREE SIGN}", icon=self.ICONS[item.kind])
        parts.label(text=item.label)
        row.operator(CHRONORMAL_OT_jump.bl_idname, text="", icon="VIEWZOOM").index = index


class CHRONORMAL_PT_look(bpy.types.Panel):
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Normals"
    bl_label = "Check shape-key normals"

    def draw(self, context: bpy.types.Context) -> None:
        layout, state, o = self.layout, context.window_manager.chronormal, context.object
        if o is None or o.type != "MESH" or o.data.shape_keys is None:
            layout.label(text="Select a mesh with shape keys.", icon="INFO")
            return
        if o.mode != "OBJECT":
            layout.label(text="Leave edit mode to check normals.", icon="INFO")
            return
        if baked.mark_of(o.data) is not None:
            layout.operator(baked.CHRONORMAL_OT_make_idle.bl_idname, icon="INFO")
        layout.row().prop(state, "judged", expand=True)
        column = layout.column(align=True)
        for over, text, icon in (("NOW", "At the sliders now", "RESTRICT_VIEW_OFF"), ("TIME", "Over the timeline", "TIME"),
                                 ("KEYS", "Keys and pairs of keys", "SHAPEKEY_DATA")):
            column.operator(CHRONORMAL_OT_look.bl_idname, text=text, icon=icon).over = over
        left_out = [m.name for m in o.modifiers if m.show_viewport and m.type != "ARMATURE"]
        if left_out:
            column = layout.column(align=True)
            column.label(text="The exporter leaves out:", icon="INFO")
            for name in left_out:
                column.label(text=name, icon="BLANK1")
        if state.object == o.name and state.average:
            self.draw_result(state)

    def draw_result(self, state: State) -> None:
        layout = self.layout
        box = layout.box()
        column = box.column(align=True)
        column.label(text="Error of the normals:")
        column.label(text=state.average)
        column.label(text=state.worst)
        column = box.column(align=True)
        row = column.row(align=True)
        for n in range(len(colours.RAMP)):
            row.prop(state, f"colour_{n}", text="")
        row = column.row(align=True)
        for n in range(len(colours.RAMP)):
            row.label(text=f"{state.top * n / (len(colours.RAMP) - 1):.3g}\N{DEGREE SIGN}")
        box.prop(state, "top")
        if state.findings:
            layout.template_list("CHRONORMAL_UL_findings", "", state, "findings", state, "active", rows=8)
        layout.operator(CHRONORMAL_OT_clear.bl_idname, icon="X")


_CLASSES = (Finding, State, CHRONORMAL_OT_look, CHRONORMAL_OT_jump, CHRONORMAL_OT_clear, CHRONORMAL_UL_findings, CHRONORMAL_PT_look)


def register() -> None:
    for one in _CLASSES:
        bpy.utils.register_class(one)
    bpy.types.WindowManager.chronormal = bpy.props.PointerProperty(type=State)


def unregister() -> None:
    for mesh in bpy.data.meshes:
        colours.clear(mesh)
    del bpy.types.WindowManager.chronormal
    for one in reversed(_CLASSES):
        bpy.utils.unregister_class(one)
