"""Defines the preferences of the add-on, which also hold the settings of the export.

Properties of a scene would be written into glTF files as custom properties, even while the add-on is off.
Preferences are never written into a file.
"""
# SPDX-License-Identifier: MIT

import bpy

VIEWERS = (
    ("three", "three.js", "Most pages that show 3D in a browser; model-viewer too"),
    ("babylon", "Babylon.js", "Pages and games in a browser"),
    ("playcanvas", "PlayCanvas", "Pages and games in a browser"),
    ("bevy", "Bevy", "Games made with Bevy"),
    ("godot", "Godot", "Games made with Godot 4, which keeps a unit normal for each key"),
    ("filament", "Filament", "Android's Scene Viewer and others, which keep a unit normal for each key"),
)


class Preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: bpy.props.StringProperty(
        name="Program",
        description="The chronormal program to run. Leave the path empty to use the program that ships with the add-on",
        subtype="FILE_PATH",
    )
    use: bpy.props.BoolProperty(
        name="Right normals for shape keys",
        description="After a glTF file is written, correct the normals of its shape keys",
        default=False,
    )
    viewers: bpy.props.EnumProperty(
        name="Viewers",
        description="The viewers that the file is made for. If no viewer is chosen, the file is made for three.js, Babylon.js, "
                    "PlayCanvas and Bevy. Where possible, it gets no worse in the other viewers",
        items=[(name, title, what, 1 << n) for n, (name, title, what) in enumerate(VIEWERS)],
        options={"ENUM_FLAG"},
        default=set(),
    )
    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="The largest error allowed, in degrees. At 0, errors get as small as possible "
                    "in a file of at most 2.5 times the size",
        min=0, max=180, soft_max=5, precision=2, default=0,
    )
    most_targets: bpy.props.IntProperty(
        name="Most targets",
        description="The most morph targets that a mesh may have, shape keys included. At 0, a mesh may have as many "
                    "as the viewers can show",
        min=0, soft_max=64, default=0,
    )
    most_kilobytes: bpy.props.IntProperty(
        name="Most KB",
        description="The most kilobytes that the normals of a mesh's shape keys may take. At 0 there is no limit",
        min=0, soft_max=100_000, default=0,
    )

    def options(self) -> list[str]:
        """Returns the settings of the export as options of `chronormal bake`."""
        result: list[str] = []
        if self.viewers:
            result += ["--for", ",".join(name for name, _, _ in VIEWERS if name in self.viewers)]
        if self.tolerance > 0:
            result += ["--tolerance", f"{self.tolerance:g}"]
        if self.most_targets > 0:
            result += ["--max-targets", str(self.most_targets)]
        if self.most_kilobytes > 0:
            result += ["--max-bytes", str(1000 * self.most_kilobytes)]
        return result

    def draw(self, _context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "program")
        layout.label(text="The settings of the export are in the panel of File > Export > glTF 2.0.", icon="INFO")


def get() -> Preferences:
    return bpy.context.preferences.addons[__package__].preferences


def program_path() -> str:
    path = get().program
    return bpy.path.abspath(path) if path else ""


def register() -> None:
    bpy.utils.register_class(Preferences)


def unregister() -> None:
    bpy.utils.unregister_class(Preferences)
