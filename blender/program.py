"""Finds the program chronormal and runs it."""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import stat
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

SYSTEMS = {
    ("Linux", "x86_64"): "linux-x64",
    ("Linux", "aarch64"): "linux-arm64",
    ("Windows", "AMD64"): "windows-x64",
}

# The program's exit code if it wrote a file that exceeds the tolerance (docs/cli.md).
BEYOND_TOLERANCE = 4


class Unavailable(Exception):
    """The error that is raised if there is no program that can be run. The text says what the user can do."""


@dataclass
class Outcome:
    """The result of a run of the program: its exit code, its report, and the sentences that it printed."""

    code: int
    report: dict[str, Any] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)

    @property
    def wrote(self) -> bool:
        return self.code in (0, BEYOND_TOLERANCE)


def system_name() -> str | None:
    """Returns the name of the folder in bin/ for this system, or None if the add-on has no program for it."""
    return SYSTEMS.get((platform.system(), platform.machine()))


def shipped(folder: Path = Path(__file__).parent) -> Path | None:
    """Returns the program that came with the add-on for this system, or None."""
    system = system_name()
    if system is None:
        return None
    path = folder / "bin" / system / ("chronormal.exe" if system.startswith("windows") else "chronormal")
    return path if path.is_file() else None


def make_executable(path: Path) -> None:
    """Makes a file executable. Blender unpacks add-ons without the permissions of their files."""
    if os.access(path, os.X_OK):
        return
    try:
        path.chmod(path.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)
    except OSError as error:
        raise Unavailable(f"{path} may not be run ({error.strerror}). Allow the file to be executed, in its properties.") from error


def find(preferred: str) -> Path:
    """Returns the program that the preferences name, or else the program in bin/, or else a program on PATH. Raises
    Unavailable if there is none."""
    if preferred:
        path = Path(preferred)
        if not path.is_file():
            raise Unavailable(f"The preferences name the program {preferred}, which is not there. Correct the path in Edit > "
                              "Preferences > Add-ons, or leave the path empty to use the program that ships with the add-on.")
        make_executable(path)
        return path
    path = shipped()
    if path is not None:
        make_executable(path)
        return path
    on_path = shutil.which("chronormal")
    if on_path is not None:
        return Path(on_path)
    raise Unavailable(f"The program chronormal was not found: this copy of the add-on has none for {platform.system()} on "
                      f"{platform.machine()}. Name a program in Edit > Preferences > Add-ons > Right normals for shape keys.")


# The labels in the panel for the options that messages of the program may mention.
_OPTIONS = {"--tolerance": "Tolerance", "--max-targets": "Most targets", "--max-bytes": "Most KB", "--for": "Viewers"}


def sentences(text: str) -> list[str]:
    """Returns the lines that the program printed for people, with the panel's labels in place of options."""
    result = []
    for line in text.splitlines():
        line = line.removeprefix("chronormal bake: ").strip()
        line = re.sub(r", or choose another candidate that --plan lists", "", line)
        for option, label in _OPTIONS.items():
            line = re.sub(re.escape(option) + r"(?![\w-])", f'"{label}"', line)
        if line and not line.startswith("Try: "):
            result.append(line)
    return result


def bake(path: Path, source: Path, result: Path, options: list[str]) -> Outcome:
    """Bakes a glTF file. The result may replace the source; if anything fails, the source is unchanged."""
    command = [str(path), "bake", str(source), "-o", str(result), "--force", "--json", "--quiet", *options]
    without_console = getattr(subprocess, "CREATE_NO_WINDOW", 0)
    try:
        run = subprocess.run(command, capture_output=True, check=False, creationflags=without_console)
    except OSError as error:
        raise Unavailable(f"{path} could not be started: {error.strerror}. Check the path of the program in the "
                          "preferences.") from error
    outcome = Outcome(run.returncode, said=sentences(run.stderr.decode("utf-8", "replace")))
    if outcome.wrote:
        try:
            outcome.report = json.loads(run.stdout)
        except ValueError as error:
            raise Unavailable(f"{path} does not answer as chronormal does. Check the path of the program in the preferences.") from error
    return outcome
