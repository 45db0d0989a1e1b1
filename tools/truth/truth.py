# Writes docs/truth.md from tools/truth/truth.md.in. It gives motions whose truth is known, and sequences by other
# people in CHRONORMAL_DATA, to `chronormal compare --truth`, and measures what errors come to on the screen and at
# keyframes (shading.py). With --check it fails where the page would differ.
import contextlib
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import shading

PROGRAM = pathlib.Path('build/release/chronormal').resolve()
TEMPLATE, PAGE = pathlib.Path('tools/truth/truth.md.in'), pathlib.Path('docs/truth.md')
ANGLE = 2 * np.pi / 3  # of the turn and of the twist, in all
IN_EACH = 8  # of each segment as many steps are known, and compared but for its ends
SHOWN = pathlib.Path('build/release/tools/truth/chronormal_shown').resolve()
# The rows of all tables: schemes on straight paths, and exact normals on curves.
TITLES = {'linear': '`linear` (nlerp)', 'linear:scaled': '`linear:scaled`', 'slerp': '`slerp`', 'quadratic': '`quadratic`',
          'cubic': '`cubic`', 'decasteljau:4': '`decasteljau:4`', 'quaternion:optimal': '`quaternion:optimal`', 'circle': '`circle`',
          'circle:timed': '`circle:timed`', 'polynomial': '`polynomial`: exact of straight paths',
          'catmull-rom': 'exact of curves through the keyframes (`catmull-rom`)',
          'hermite': 'exact of curves with the velocities of the motion (`hermite`)'}
CURVES = ['catmull-rom', 'hermite']
SCHEMES = [name for name in TITLES if name not in CURVES]
# These look at the edges of faces, so that their errors are those of faces, beside those of linear there.
OF_FACES = {'linear': '`linear`, of faces', 'quaternion:matrix': '`quaternion:matrix`, of faces'}


def grid(around, up, place):
    """Positions (n, 3) of a tube, closed around, by place(part around, part up); faces (m, 3)."""
    positions = np.array([place(j / around, i / up) for i in range(up + 1) for j in range(around)])
    faces = []
    for i in range(up):
        for j in range(around):
            a, b = i * around + j, i * around + (j + 1) % around
            faces += [(a, a + around, b), (b, a + around, b + around)]
    return positions, np.array(faces, np.int32)


def ball(around, up):
    at, down = 2 * np.pi * around, np.pi * (0.02 + 0.96 * up)
    return np.sin(down) * np.cos(at), np.cos(down), np.sin(down) * np.sin(at)


def column(around, up):
    side, part = divmod(4 * around, 1)
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)]
    (x0, z0), (x1, z1) = corners[int(side)], corners[int(side) + 1]
    return x0 + part * (x1 - x0), 2 * up - 1, z0 + part * (z1 - z0)


def turned(positions, angle):
    """Around y, by one angle or one for each vertex."""
    x, y, z = positions.T
    return np.stack([np.cos(angle) * x + np.sin(angle) * z, y, np.cos(angle) * z - np.sin(angle) * x], 1)


def velocities(positions, rate):
    x, _, z = positions.T
    return np.stack([rate * z, 0 * x, -rate * x], 1)


# By name: the mesh, and how fast each vertex turns.
MOTIONS = {
    'turn': (grid(48, 24, ball), lambda p: ANGLE + 0 * p[:, 1]),
    'twist': (grid(48, 48, column), lambda p: ANGLE * (p[:, 1] + 1) / 2),
}


def write_motion(path, name, times):
    (positions, faces), rate_of = MOTIONS[name]
    rate = rate_of(positions)
    frames = [turned(positions, rate * t) for t in times]
    arrays = np.stack(frames).astype(np.float32), np.stack([velocities(p, rate) for p in frames]).astype(np.float32)
    np.savez(path, positions=arrays[0], velocities=arrays[1], faces=faces, times=times)


def compared(path, every, elements, schemes):
    command = [PROGRAM, 'compare', path, '--truth', str(every), '--elements', elements, '--json', '--quiet', '--schemes', ','.join(schemes)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def compare(path, every):
    """The means of all rows of a table in degrees, by their titles, and its last line."""
    result = compared(path, every, 'vertices', SCHEMES)
    means = {TITLES[row['scheme'] if row['path'] == 'linear' else row['path']]: row['mean_degrees'] for row in result['rows']}
    for row in compared(path, every, 'faces', OF_FACES)['rows']:
        if row['path'] == 'linear':
            means[OF_FACES[row['scheme']]] = row['mean_degrees']
    return means, f'{result["bend"]:.2f}' + (' (too sparse)' if result['is_too_sparse'] else '')


def degrees(mean):
    return f'{mean:.3f}' if mean >= 0.01 else f'{mean:.4f}' if mean >= 1e-4 else '< 0.0001'  # near the rounding of float32


def table(heads, results):
    """A line for each row and a column for each of the results; the least mean over vertices is bold."""
    lines = ['| mean degrees | ' + ' | '.join(heads) + ' |', '|---|' + '--:|' * len(heads)]
    for title in [*TITLES.values(), *OF_FACES.values()]:
        cells = []
        for means, _ in results:
            text = '-' if title not in means else degrees(means[title])
            least = min(mean for other, mean in means.items() if other in TITLES.values())
            cells.append(f'**{text}**' if means.get(title) == least and title in TITLES.values() else text)
        if any(cell != '-' for cell in cells):
            lines.append(f'| {title} | ' + ' | '.join(cells) + ' |')
    return '\n'.join(lines + ['| bend of the path | ' + ' | '.join(bend for _, bend in results) + ' |'])


def known(name):
    results, segments = [], [1, 2, 4, 8, 16]
    with tempfile.TemporaryDirectory() as folder:
        for count in segments:
            path = pathlib.Path(folder) / f'{name}_{count}.npz'
            write_motion(path, name, np.linspace(0, 1, count * IN_EACH + 1))
            results.append(compare(path, IN_EACH))
    return table([f'{count} segment{"s" * (count > 1)}' for count in segments], results)


def sequences(data):
    ordinal = {2: '2nd', 3: '3rd', 4: '4th', 8: '8th'}
    inputs = [('rumba_13', 'sequences/rumba_13', 2), ('rumba_13', 'sequences/rumba_13', 3), ('faerie', 'sequences/md2_faerie/faerie.md2', 2),
              ('faerie', 'sequences/md2_faerie/faerie.md2', 3)]
    heads, results = [], []
    for name, path, every in inputs:
        heads.append(f'{name}, every {ordinal[every]}')
        results.append(compare(data / path, every))
    # The face at the times of its own frames.
    with as_sequence(*sampled(data / 'rigs/ict_capture.glb', '--animation', '0', '--times', 'keys')) as path:
        for every in [2, 4, 8]:
            heads.append(f'face, every {ordinal[every]}')
            results.append(compare(path, every))
    return table(heads, results)


def sampled(path, *moments):
    """Positions (k, n, 3), times (k) and faces of a motion at some moments, as `chronormal sample` writes them."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / 'poses.npz'
        subprocess.run([PROGRAM, 'sample', path, *moments, '--quiet', '-o', out], check=True, capture_output=True)
        arrays = np.load(out)
        return arrays['positions'].astype(float), arrays['times'], arrays['faces']


def shown(path, names, moments):
    """What the program shows of a sequence: unit normals by segment, by scheme, at moments of each segment."""
    command = [SHOWN, path, ','.join(names), ','.join(map(repr, moments))]
    numbers = np.frombuffer(subprocess.run(command, check=True, capture_output=True).stdout, np.float32).astype(float)
    vertices = numbers.size // (3 * len(names) * len(moments) * (len(np.load(path)['times']) - 1))
    of_segments = numbers.reshape(-1, len(names), len(moments), vertices, 3)
    return [dict(zip(names, segment)) for segment in of_segments]


@contextlib.contextmanager
def as_sequence(poses, times, faces):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / 'poses.npz'
        np.savez(path, positions=poses.astype(np.float32), faces=faces, times=times)
        yield path


def screens(data):
    """The table of differences on the screen, for the dance and a face."""
    lines = []
    for title, path, moments in [('the dance', 'sequences/rumba_13', ['--times', 'keys']),
                                 ('a face', 'rigs/ict_capture.glb', ['--animation', '0', '--times', '0:0.5:4'])]:
        poses, times, faces = sampled(data / path, *moments)
        low, high = poses.min((0, 1)), poses.max((0, 1))
        width = 1.02 * (high - low)[:2].max()
        view = (low + high)[0] / 2 - width / 2, (low + high)[1] / 2 - width / 2, width
        all_of = {}
        with as_sequence(poses, times, faces) as file:
            of_segments = shown(file, SCHEMES, [0.25])
        for start, end, normals in zip(poses, poses[1:], of_segments):
            here = {name: at[0] for name, at in normals.items()}
            for name, found in shading.differences(start, end, faces, view, here, 0.25).items():
                all_of.setdefault(name, []).append(found)
        for name, found in all_of.items():
            angles, levels = (np.concatenate(part) for part in zip(*found))
            cells = [angles.mean(), np.percentile(angles, 99), *np.percentile(levels, [50, 90, 99])]
            lines.append(f'| {title} | `{name}` | ' + ' | '.join(f'{cell:.2f}' for cell in cells) + ' |')
    head = ['| | scheme | mean, degrees | 99 %, degrees | median pixel, levels | 90 % of pixels, levels | 99 % of pixels, levels |',
            '|---|---|--:|--:|--:|--:|--:|']
    return '\n'.join(head + lines)


def bands(data):
    """The table of jumps of dn/dt at keyframes, for motions that are known and for the dance."""
    columns = []
    with tempfile.TemporaryDirectory() as folder:
        for name in MOTIONS:
            path, times = pathlib.Path(folder) / f'{name}.npz', np.linspace(0, 1, 9)
            write_motion(path, name, times)
            columns.append((path, times, SCHEMES + CURVES))
        poses, times, faces = sampled(data / 'sequences/rumba_13', '--times', 'keys')
        path = pathlib.Path(folder) / 'dance.npz'
        np.savez(path, positions=poses.astype(np.float32), faces=faces, times=times)
        columns.append((path, times, SCHEMES + CURVES[:1]))
        found = []
        for path, times, names in columns:
            of_segments = shown(path, names, shading.MOMENTS)
            found.append({name: shading.jumps([segment[name] for segment in of_segments], times) for name in names})
    lines = ['| jump of dn/dt, % of its size | the turn, 8 segments | the twist, 8 segments | the dance |', '|---|--:|--:|--:|']
    cell = lambda column, name: f'{100 * column[name]:.1f}' if name in column else '-'
    return '\n'.join(lines + [f'| {title} | ' + ' | '.join(cell(column, name) for column in found) + ' |' for name, title in TITLES.items()])


def table_1(data):
    """The table of sums relative to linear over 21 samples of each segment, as in Table 1 of the paper."""
    names = ['linear', 'linear:scaled', 'quadratic', 'cubic', 'polynomial', 'slerp', 'decasteljau:4', 'quaternion:random:1', 'quaternion:matrix',
             'quaternion:edge', 'quaternion:polar', 'quaternion:optimal', 'circle', 'circle:timed']
    columns = []
    for path in ['sequences/rumba_13', 'rigs/ict_capture.glb']:
        command = [PROGRAM, 'compare', data / path, '--schemes', ','.join(names), '--json', '--no-times', '--quiet']
        result = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        columns.append({row['scheme']: row['relative_to_linear'] for row in result['schemes']})
    number = lambda ratio: f'{ratio:.3f}' if ratio > 0.001 else f'{ratio:.0e}'.replace('e-0', 'e-')
    lines = ['| sum relative to linear | the dance | a face |', '|---|--:|--:|']
    return '\n'.join(lines + [f'| `{name}` | ' + ' | '.join(number(column[name]) for column in columns) + ' |' for name in names])


# The tables that are measured on other people's meshes; each stands between two comments of the page.
MEASURED = {'sequences': sequences, 'screen': screens, 'keyframes': bands, 'table 1': table_1}


def main():
    data = os.environ.get('CHRONORMAL_DATA')
    check = '--check' in sys.argv
    text, there = TEMPLATE.read_text(), PAGE.read_text() if PAGE.exists() else ''
    if not data and any(f'<!-- {name} -->' not in there for name in MEASURED):
        sys.exit('set CHRONORMAL_DATA to the folder of the real data: the page has figures of its files')
    page = text.replace('@turn@', known('turn')).replace('@twist@', known('twist'))
    for name, measure in MEASURED.items():
        # Without the data, the tables of the page stay as they are: a page without other people's meshes would say less
        # than before.
        begin, end = f'<!-- {name} -->\n', '\n<!-- end -->'
        table = measure(pathlib.Path(data)) if data else there.split(begin)[1].split(end)[0]
        page = page.replace(f'@{name}@', table)
    if check and page != there:
        sys.exit(f'{PAGE} has other figures than those measured now: run tools/make_truth')
    if not check:
        PAGE.write_text(page)


main()
