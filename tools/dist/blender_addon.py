"""Packs the Blender add-on into a zip that Blender can install, together with the given programs.

    blender_addon.py OUT.zip [SYSTEM=FOLDER]...

SYSTEM is one of the systems that blender/program.py knows, such as linux-x64, and FOLDER has the program chronormal
for that system, and its licences in LICENSE and THIRD_PARTY if there are any. Equal files give equal bytes.
"""

import sys
from pathlib import Path

from zip_folder import write_zip

ROOT = Path(__file__).resolve().parents[2]
NAME = "chronormal_blender"  # the name of the Python package, and the id of the extension


def files(programs: dict[str, Path]) -> dict[str, Path]:
    """Returns the files of the zip, keyed by their names in the zip."""
    found = {path.name: path for path in (ROOT / "blender").iterdir() if path.suffix in (".py", ".toml")}
    found["LICENSE"] = ROOT / "LICENSE"
    for system, folder in programs.items():
        for path in folder.rglob("*"):
            inner = path.relative_to(folder)
            if path.is_file() and inner.parts[0] in ("chronormal", "chronormal.exe", "LICENSE", "THIRD_PARTY"):
                found[f"bin/{system}/{inner.as_posix()}"] = path
        if not any(name.startswith(f"bin/{system}/chronormal") for name in found):
            raise SystemExit(f"{folder} has no program chronormal")
    return found


if __name__ == "__main__":
    programs = {system: Path(folder) for system, folder in (argument.split("=", 1) for argument in sys.argv[2:])}
    write_zip(Path(sys.argv[1]), {f"{NAME}/{name}": path for name, path in files(programs).items()})
