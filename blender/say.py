"""Tells the user the result of an operation, in the report of the operator that is running."""
# SPDX-License-Identifier: MIT

from __future__ import annotations

import sys

import bpy

# The level and the text of the last sentence that was reported, for scripts and tests.
last: tuple[str, str] = ("", "")


def _running_operator() -> bpy.types.Operator | None:
    """Returns the operator that is running. The exporter does not pass the operator to its hooks, so this function
    looks for it in the functions that called it."""
    frame = sys._getframe(1)  # pylint: disable=protected-access
    while frame is not None:
        owner = frame.f_locals.get("self")
        if isinstance(owner, bpy.types.Operator):
            return owner
        frame = frame.f_back
    return None


def say(level: str, text: str) -> None:
    """Reports a sentence. The level is INFO or WARNING; an ERROR would tell scripts that no file was written."""
    global last
    last = (level, text)
    operator = _running_operator()
    if operator is not None:
        operator.report({level}, text)
    else:
        print(f"{level.title()}: {text}")
