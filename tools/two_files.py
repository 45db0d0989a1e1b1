#!/usr/bin/env python3
"""Writes chronormal_core.h and chronormal_core.cpp into a folder, for projects that want two files and a compiler. They
contain the parts of the library that normals of meshes in motion need.

    tools/two_files.py FOLDER

The text comes from include/ and src/: the headers named in ROOTS, the headers that these include, the sources of all
these headers, and so on. Each file is written once, after the files that it includes. Include guards, includes of other
files of the library, and code for Google Highway are left out: kernels are plain C++ (src/simd/plain_lanes.h). The
single file has only one unnamed namespace and one namespace of kernels, so the script ends with an error if two sources
use the same private name for different things.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOTS = [
    "chronormal/normals/control_normals.h", "chronormal/normals/mesh_normals.h"
]
# The headers that no other header includes, but whose sources are needed.
MORE = ["normals/groups/weld.h"]
# The macros whose values this script knows. Conditions on other macros are left to the compiler.
DEFINED = {"CHRONORMAL_HIGHWAY": False, "CHRONORMAL_ALONE": True}
TARGETS = {"HWY_SCALAR": 1, "HWY_EMU128": 2, "HWY_AVX2": 3, "HWY_AVX3": 4, "HWY_PLAIN": 5, "HWY_TARGET": 5, "HWY_ONCE": 1}

INCLUDE = re.compile(r'\s*#\s*include\s+([<"])([^>"]+)[>"]')


def find_file(name):
    for folder in ("include", "src"):
        if (ROOT / folder / name).exists():
            return f"{folder}/{name}"
    return None


def floor_of(path):
    return path.removeprefix("include/chronormal/").removeprefix("src/").split("/")[0]


def sources_of_headers():
    """Returns a dict from each header to the sources that define its functions. A source belongs to the first header
    that it includes."""
    sources = {}
    for path in sorted((ROOT / "src").rglob("*.cpp")):
        first = re.search(r'^#include "([^"]+)"', path.read_text(), re.M)
        header = first and find_file(first.group(1))
        source = str(path.relative_to(ROOT))
        if header and floor_of(header) == floor_of(source):
            sources.setdefault(header, []).append(source)
    return sources


def value_of(directive):
    """Returns the value of the condition of #if, #ifdef or #ifndef, or None if this script cannot evaluate it."""
    words = directive.split()
    if words[0] in ("#ifdef", "#ifndef"):
        known = DEFINED.get(words[1])
        return None if known is None else known == (words[0] == "#ifdef")
    expression = directive.split(None, 1)[1].split("//")[0]
    names = set(re.findall(r"[A-Za-z_]\w*", expression))
    if not names or not names <= set(TARGETS):
        return None
    for name in names:
        expression = re.sub(rf"\b{name}\b", str(TARGETS[name]), expression)
    return bool(eval(expression.replace("||", " or ").replace("&&", " and "), {"__builtins__": {}}))


def decided(lines):
    """Returns the lines of a file without the branches whose conditions are known to be false."""
    # For each open condition, the stack has three values: whether the condition is known, whether one of its branches
    # was taken, and whether the current branch is taken.
    result, stack = [], []
    for line in lines:
        directive = line.strip()
        taken = all(branch for _, _, branch in stack)
        if re.match(r"#\s*(if|ifdef|ifndef)\b", directive):
            value = value_of(directive) if taken else False
            stack.append((value is not None, bool(value), value is not False))
            if value is None:
                result.append(line)
        elif re.match(r"#\s*(elif|else)\b", directive):
            known, had, _ = stack.pop()
            outer = all(branch for _, _, branch in stack)
            if known:
                value = True if directive.startswith("#else") else value_of("#if " + directive.split(None, 1)[1])
                if value is None and outer and not had:
                    sys.exit(f"a condition that is only partly known: {directive}")
                stack.append((True, had or bool(value), bool(value) and not had))
            else:
                stack.append((False, had, True))
                if outer:
                    result.append(line)
        elif re.match(r"#\s*endif\b", directive):
            known, _, _ = stack.pop()
            if not known and all(branch for _, _, branch in stack):
                result.append(line)
        elif taken:
            result.append(line)
    return result


def without_guard(lines):
    """Returns the lines of a file without its include guard. The file is a header or an -inl.h."""
    text = "\n".join(lines)
    guard = re.search(r"^#ifndef (CHRONORMAL_\w+_H_)\n#define \1\n", text, re.M)
    if guard is None:
        guard = re.search(r"^#if defined\((CHRONORMAL_\w+_H_)\) == defined\(HWY_TARGET_TOGGLE\)\n(#.*\n){5}", text, re.M)
    if guard is None:
        return lines
    name, end = guard.group(1), text.rindex("#endif")
    text = text[:guard.start()] + text[guard.end():end]
    if name in text:
        sys.exit(f"{name} is used for more than a guard")
    return text.split("\n")


class File:
    """A source or header that goes into the two files, with its text, its includes of headers of the library, and its
    includes of system headers."""

    def __init__(self, path):
        self.path, self.includes, self.system = path, [], []
        lines = decided(without_guard((ROOT / path).read_text().split("\n")))
        lines = [line for line in lines if "HWY_TARGET_INCLUDE" not in line]
        kept, depth = [], 0
        for line in lines:
            depth += len(re.findall(r"^\s*#\s*if", line)) - len(re.findall(r"^\s*#\s*endif", line))
            include = INCLUDE.match(line)
            ours = find_file(include.group(2)) if include else None
            if ours is not None:
                self.includes.append(ours)
            elif include and include.group(1) == '"':
                sys.exit(f"{path} includes {include.group(2)}, which is nowhere")
            elif include and depth == 0:
                self.system.append(include.group(2))
            else:
                kept.append(line)
        self.text = re.sub(r"\n{3,}", "\n\n", "\n".join(kept)).strip("\n")


class Collection:
    def __init__(self):
        self.files, self.order = {}, []

    def add(self, path):
        """Adds a file after the files that it includes, unless it was added before."""
        if path in self.files:
            return
        file = self.files[path] = File(path)
        for included in file.includes:
            self.add(included)
        self.order.append(file)

    def add_sources(self):
        """Adds the sources of all headers, and of the headers that these sources include."""
        sources, count = sources_of_headers(), -1
        while count != len(self.order):
            count = len(self.order)
            for file in list(self.order):
                for source in sources.get(file.path, []):
                    self.add(source)


def private_names(text):
    """Returns the names that a source declares at the outermost level of its unnamed namespace, or of the namespace of
    kernels."""
    found, depth, is_private = set(), 0, False
    text = re.sub(r"//.*", "", text)
    for line in text.split("\n"):
        if re.match(r"namespace( \{|.*HWY_NAMESPACE)", line):
            is_private = True
        elif line.startswith("}  // namespace") or (line.startswith("}") and is_private and depth == 0):
            is_private = False
        if not is_private or not re.match(r"[A-Za-z]", line) or re.match(r"(namespace|static_assert)\b", line):
            continue
        kind = re.match(r"(?:template.*> )?(?:struct|class|enum class|enum|using) (\w+)", line)
        name = kind or re.search(r"(\w+)(?:\[.*\])? ?(?:\(|=|;)", line)
        if name:
            found.add(name.group(1))
    return found


LICENSE = "".join(f"// {line}".rstrip() + "\n" for line in (ROOT / "LICENSE").read_text().strip().split("\n"))
VERSION = re.search(r"project\(chronormal VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
# A product followed by a sum must be rounded twice, so that the bits are the same on every machine.
ROUNDINGS = """#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "chronormal promises the same bits everywhere, which -ffast-math breaks; compile without -ffast-math"
#endif
"""


def begin_roundings():
    return """#if defined(__clang__) && !defined(__wasm__)
#pragma float_control(push)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && defined(__FP_FAST_FMA)
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#endif
"""


def end_roundings():
    return """#if defined(__clang__) && !defined(__wasm__)
#pragma float_control(pop)
#elif defined(__GNUC__) && defined(__FP_FAST_FMA)
#pragma GCC pop_options
#endif
"""


def system_includes(files):
    return "".join(f"#include <{name}>\n" for name in sorted({name for file in files for name in file.system}))


def sections(files):
    return "".join(f"\n// ======== {file.path}\n\n{file.text}\n" for file in files)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    all_files = Collection()
    for root in ROOTS:
        all_files.add(find_file(root))
    headers = list(all_files.order)
    for header in MORE:
        all_files.add(find_file(header))
    all_files.add_sources()
    sources = [file for file in all_files.order if file not in headers]
    public = [file for file in sources if file.path.startswith("include/")]
    headers, sources = headers + public, [file for file in sources if file not in public]

    owners, errors = {}, []
    for file in sources:
        for name in private_names(file.text):
            if name in owners:
                errors.append(f"{name} stands in {owners[name]} and in {file.path}")
            owners.setdefault(name, file.path)
    for error in sorted(errors):
        print(error, file=sys.stderr)

    folder.mkdir(parents=True, exist_ok=True)
    (folder / "chronormal_core.h").write_text(
        f"/// chronormal {VERSION}: exact normals of triangle meshes that deform. With chronormal_core.cpp this is all of it\n"
        "/// that needs no files. Written by tools/two_files.py.\n///\n"
        "///     c++ -std=c++20 -O2 -c chronormal_core.cpp\n//\n" + LICENSE +
        "#ifndef CHRONORMAL_CORE_H_\n#define CHRONORMAL_CORE_H_\n\n" + system_includes(headers) + "\n" + ROUNDINGS +
        begin_roundings() + sections(headers) + "\n" + end_roundings() + "\n#endif  // CHRONORMAL_CORE_H_\n")
    (folder / "chronormal_core.cpp").write_text(
        f"// chronormal {VERSION}: the source of chronormal_core.h, where the license stands. Written by tools/two_files.py.\n"
        '#include "chronormal_core.h"\n\n' + system_includes(sources) + "\n" + begin_roundings() + sections(sources) + "\n" +
        end_roundings())
    if errors:
        sys.exit(1)


main()
