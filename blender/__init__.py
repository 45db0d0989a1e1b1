"""True normals for shape keys: the Blender add-on of chronormal.

Viewers add up one normal delta for each shape key. The sum is right at the keys but wrong between and beyond them:
highlights slide, and folds appear where the surface has none. The add-on

    export.py   bakes true normals into the file that File > Export > glTF 2.0 has just written,
    look.py     shows in the viewport where a viewer would be wrong, and by how many degrees,
    baked.py    recognises a baked file that is imported, so that the next export begins with the author's own keys,

and program.py runs the program `chronormal`, which does the baking. shown.py computes from an exported file the
normals that a viewer would render, truth.py asks Blender for its own normals, and settings.py has the preferences.
docs/artists.md is the manual.
"""
# SPDX-License-Identifier: MIT

import bpy

from . import baked, export, look, settings

bl_info = {
    "name": "Right normals for shape keys (chronormal)",
    "author": "The chronormal authors",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "File > Export > glTF 2.0, and the sidebar of the 3D viewport",
    "description": "Writes right normals for shape keys into glTF files, and shows where they would be wrong",
    "category": "Import-Export",
}

# The exporter and the importer of glTF look for names such as glTF2_pre_export_callback in the module of every enabled
# add-on, and call what they find.
glTF2_pre_export_callback = export.before_export
glTF2_post_export_callback = export.before_writing
glTF2ImportUserExtension = baked.RecogniseBakedFiles

if bpy.app.version >= (4, 2, 0):
    # Since version 4.2, the exporter calls draw_export() of add-ons that define a class glTF2ExportUserExtension.
    # In earlier versions, export.py shows the settings in a panel of its own.
    glTF2ExportUserExtension = export.NoFurtherHooks
    draw_export = export.draw_in_exporter

_PARTS = (settings, export, baked, look)


def register() -> None:
    for part in _PARTS:
        part.register()


def unregister() -> None:
    for part in reversed(_PARTS):
        part.unregister()
