"""Bakes glTF files by other people in CHRONORMAL_DATA, and measures how viewers render them, for docs/viewers.md."""

import os
from pathlib import Path

import chronormal as cn
from page import Page

FILES = ["gltf/MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf", "gltf/AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf",
         "gltf/MorphStressTest/glTF/MorphStressTest.gltf", "gltf/RobotExpressive/RobotExpressive.glb", "rigs/blender_suzanne_two_keys.glb",
         "rigs/ict_capture.glb"]
# Babylon.js and Bevy render the same normals as three.js, up to rounding.
VIEWERS = {"three": "three.js, Babylon.js, Bevy", "playcanvas": "PlayCanvas", "godot": "Godot 4", "filament": "Filament", "gltfpack": "after gltfpack"}
STATES = {None: "by default", "exact": "`exact`"}
SAMPLES = 3


def errors(source, base=None):
    found = cn.audit(source, viewers=list(VIEWERS), samples=SAMPLES)["viewers"]
    degrees = lambda value: "0" if value < 0.005 else f"{value:.2f}"  # noqa: E731
    return [f"{degrees(one['mean_degrees'])}, {degrees(one['percentile_99_9_degrees'])}" for one in found]


def main():
    page, data = Page("viewers"), Path(os.environ["CHRONORMAL_DATA"])
    rows, sizes = [], []
    for file in FILES:
        path, name = str(data / file), f"`{Path(file).name.split('.')[0]}`"
        rows.append([f"{name} as it was", *errors(path)])
        for encoding, title in STATES.items():
            glb, report = cn.bake(path, encode=encoding)
            rows.append([f"{name} {title}", *errors(glb)])
            if encoding is None:
                meshes = report["meshes"]
                sizes.append([name, f"{sum(len(mesh['extra_targets']) for mesh in meshes)}", f"{sum(mesh['bytes'] for mesh in meshes):,}"])
    page.table("files", ["degrees: average, 99.9 %", *VIEWERS.values()], rows)
    page.table("sizes", ["file, baked by default", "correction targets", "bytes added"], sizes)
    page.finish()


if __name__ == "__main__":
    main()
