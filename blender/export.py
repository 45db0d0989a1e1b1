"""Bakes true normals into a glTF file as soon as Blender's exporter has written it.

The exporter calls glTF2_post_export_callback before it writes the file, and calls no hook after it has written the
file. Therefore before_export() replaces the exporter's function that writes, for one export and only if baking is
switched on; the replacement first puts the original function back. While baking is off, the exporter is not touched
at all.
"""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import importlib
import inspect
from pathlib import Path
from types import ModuleType
from typing import Any, Callable

import bpy

from . import colours, program, settings
from .say import say

# The modules of the exporter that may contain the function that writes: first the name in Blender 3.4, then the later
# name.
_WRITERS = ("io_scene_gltf2.io.exp.gltf2_io_export", "io_scene_gltf2.io.exp.export")
_WRITE = "save_gltf"
_PARAMETERS = ["gltf", "export_settings", "encoder", "glb_buffer"]

# The module whose function is replaced at the moment, its original function, and the replacement.
_replaced: tuple[ModuleType, Callable[..., Any], Callable[..., Any]] | None = None

# True while the add-on itself exports an object in order to check it. The file of such an export is not baked.
is_paused = False


def writer() -> ModuleType | None:
    """Returns the exporter's module that writes files, or None if its parameters are unexpected."""
    for name in _WRITERS:
        try:
            module = importlib.import_module(name)
        except ImportError:
            continue
        function = getattr(module, _WRITE, None)
        if inspect.isfunction(function) and list(inspect.signature(function).parameters) == _PARAMETERS:
            return module
    return None


def _put_back() -> None:
    """Puts the exporter's own function that writes files back, unless another add-on has replaced the function
    since."""
    global _replaced
    if _replaced is None:
        return
    module, original, ours = _replaced
    if getattr(module, _WRITE) is ours:
        setattr(module, _WRITE, original)
    _replaced = None


def before_export(export_settings: dict[str, Any]) -> None:
    """Prepares one export. The exporter calls this function before it does anything else."""
    global _replaced
    _put_back()  # An earlier export may have failed before it wrote.
    colours.hide()
    if is_paused or not settings.get().use:
        return
    module = writer()
    if module is None:
        say("WARNING", "Normals were not corrected: the add-on does not know this version of the glTF exporter. Your plain "
                       "export was kept; correct the file with the program: chronormal bake FILE -o RESULT")
        return
    original = getattr(module, _WRITE)

    def write_and_bake(gltf: Any, export_settings_then: dict[str, Any], encoder: Any, glb_buffer: Any) -> Any:
        _put_back()
        result = original(gltf, export_settings_then, encoder, glb_buffer)
        if export_settings_then is export_settings:
            say(*_bake_or_say_why(Path(export_settings["gltf_filepath"]).absolute()))
        return result

    _replaced = (module, original, write_and_bake)
    setattr(module, _WRITE, write_and_bake)


def before_writing(_export_settings: dict[str, Any]) -> None:
    """Restores the scene after before_export(). The exporter calls this function when it has read the scene."""
    colours.show()


def _bake_or_say_why(path: Path) -> tuple[str, str]:
    """Bakes a file that has been written. Exceptions must not reach the exporter, whose file is complete by now."""
    try:
        return bake_in_place(path)
    except Exception as error:  # pylint: disable=broad-except
        return "WARNING", ("Normals were not corrected; your plain export was kept. Please report this error of the add-on: "
                           f"{type(error).__name__}: {error}")


def bake_in_place(path: Path) -> tuple[str, str]:
    """Bakes a file that has been written, and returns the report. If anything fails, the file is unchanged."""
    try:
        found = program.find(settings.program_path())
        outcome = program.bake(found, path, path, settings.get().options())
    except program.Unavailable as error:
        return "WARNING", f"Normals were not corrected; your plain export was kept. {error}"
    if not outcome.wrote:
        why = " ".join(outcome.said) or f"the program ended with exit code {outcome.code}"
        return "WARNING", f"Normals were not corrected; your plain export was kept. {why}"
    level = "INFO" if outcome.code == 0 else "WARNING"
    return level, " ".join([verdict(outcome.report), *(said + "." for said in outcome.said)])


def verdict(report: dict[str, Any]) -> str:
    """Turns the report of `chronormal bake --json` into a sentence."""
    meshes = report.get("meshes", [])
    if meshes and all(mesh["already_baked"] for mesh in meshes):
        return "Nothing was changed, since this file was baked before. Export the original model to bake it anew."
    if not report.get("changed"):
        return "Normals are right already, so nothing was changed." if meshes else "The file has no shape keys, so nothing was changed."
    audit = report.get("audit")
    corrections = sum(len(mesh["extra_targets"]) for mesh in meshes)
    targets = f"{corrections} correction target" + ("" if corrections == 1 else "s")
    if not audit:
        return f"Normals were corrected, with {targets}."
    return (f"Normals were corrected: error on average {audit['mean_degrees_before']:.3g} -> {audit['mean_degrees_after']:.3g} degrees, "
            f"at worst {audit['worst_degrees_before']:.3g} -> {audit['worst_degrees_after']:.3g}, with {targets}.")


def draw_settings(layout: bpy.types.UILayout) -> None:
    preferences = settings.get()
    layout.use_property_split = True
    layout.use_property_decorate = False
    try:
        program.find(settings.program_path())
        reason = "" if writer() else ("The add-on does not know this version of the glTF exporter. Correct exported files "
                                      "with the program: chronormal bake FILE -o RESULT")
    except program.Unavailable as error:
        reason = str(error)
    if reason:
        column = layout.column(align=True)
        column.alert = True
        for n, line in enumerate(_lines(reason, 26)):
            column.label(text=line, icon="ERROR" if n == 0 else "BLANK1")
    column = layout.column()
    column.active = preferences.use
    column.column(align=True).prop(preferences, "viewers", expand=True)
    if not preferences.viewers:
        _hint(column, "If no viewer is chosen, normals are made right in the first four, and, where possible, no worse in the others")
    column.separator()
    column.prop(preferences, "tolerance")
    column.prop(preferences, "most_targets")
    column.prop(preferences, "most_kilobytes")
    _hint(column, "0 means no limit")


def _hint(layout: bpy.types.UILayout, text: str) -> None:
    """Writes a text below a setting, in the column of values."""
    columns = layout.split(factor=0.4)
    columns.label(text="")
    lines = columns.column(align=True)
    lines.scale_y = 0.8
    for line in _lines(text, 20):
        lines.label(text=line)

def _lines(text: str, width: int) -> list[str]:
    """Breaks a text into lines, since Blender's labels do not wrap."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


class CHRONORMAL_PT_export(bpy.types.Panel):
    bl_space_type = "FILE_BROWSER"
    bl_region_type = "TOOL_PROPS"
    bl_label = "Right normals for shape keys"
    bl_parent_id = "FILE_PT_operator"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        operator = context.space_data.active_operator
        return operator is not None and operator.bl_idname == "EXPORT_SCENE_OT_gltf"

    def draw_header(self, _context: bpy.types.Context) -> None:
        self.layout.prop(settings.get(), "use", text="")

    def draw(self, _context: bpy.types.Context) -> None:
        draw_settings(self.layout)


def draw_in_exporter(_context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
    """Draws the settings in the export dialog of Blender 4.2 and later."""
    header, body = layout.panel("CHRONORMAL_export", default_closed=False)
    header.prop(settings.get(), "use")
    if body is not None:
        draw_settings(body)


class NoFurtherHooks:
    """An empty glTF2ExportUserExtension (see __init__.py). Because an add-on defines such a class, the exporter of
    Blender 4.2 and later calls the add-on's draw_export()."""


def register() -> None:
    if bpy.app.version < (4, 2, 0):
        bpy.utils.register_class(CHRONORMAL_PT_export)


def unregister() -> None:
    _put_back()
    if bpy.app.version < (4, 2, 0):
        bpy.utils.unregister_class(CHRONORMAL_PT_export)
