# Writes docs/truth.md from tools/truth/truth.md.in. It gives motions whose truth is known, and sequences by other
# people in CHRONORMAL_DATA, to `chronormal compare --truth`, and measures what errors come to on the screen and at
# keyframes (shading.py). With --check it fails where the page would differ.
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
SCHEMES = ['linear', 'slerp', 'decasteljau:4', 'polynomial']


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


MOTIONS = {
    'turn': (grid(48, 24, ball), lambda p, t: turned(p, ANGLE * t)),
    'twist': (grid(48, 48, column), lambda p, t: turned(p, ANGLE * t * (p[:, 1] + 1) / 2)),
}


def compare(path, every):
    command = [PROGRAM, 'compare', path, '--truth', str(every), '--elements', 'vertices', '--json', '--quiet']
    out = subprocess.run(command + ['--schemes', ','.join(SCHEMES)], check=True, capture_output=True, text=True).stdout
    return json.loads(out)


def rows_of(result):
    return {'exact on curves' if row['path'] != 'linear' else row['scheme']: row['mean_degrees'] for row in result['rows']}


def table(heads, results):
    """A line for each scheme and a column for each of (title, result)."""
    names = SCHEMES + ['exact on curves']
    titles = {'linear': '`linear` (nlerp)', 'slerp': '`slerp`', 'decasteljau:4': '`decasteljau:4`',
              'polynomial': '`polynomial`: exact of straight paths', 'exact on curves': 'exact of curved paths (Catmull-Rom)'}
    lines = ['| mean degrees | ' + ' | '.join(heads) + ' |', '|---|' + '--:|' * len(heads)]
    for name in names:
        cells = []
        for result in results:
            rows = rows_of(result)
            least = min(rows.values())
            text = '-' if name not in rows else f'{rows[name]:.3f}' if rows[name] >= 0.01 else f'{rows[name]:.4f}'
            cells.append(f'**{text}**' if rows.get(name) == least else text)
        lines.append(f'| {titles[name]} | ' + ' | '.join(cells) + ' |')
    bends = [f'{result["bend"]:.2f}' + (' (too sparse)' if result['is_too_sparse'] else '') for result in results]
    return '\n'.join(lines + ['| bend of the path | ' + ' | '.join(bends) + ' |'])


def known(name):
    (positions, faces), moved = MOTIONS[name]
    results, segments = [], [1, 2, 4, 8, 16]
    with tempfile.TemporaryDirectory() as folder:
        for count in segments:
            times = np.linspace(0, 1, count * IN_EACH + 1)
            path = pathlib.Path(folder) / f'{name}_{count}.npz'
            frames = np.stack([moved(positions, t) for t in times]).astype(np.float32)
            np.savez(path, positions=frames, faces=faces, times=times)
            results.append(compare(path, IN_EACH))
    return table([f'{count} segment{"s" * (count > 1)}' for count in segments], results)


def sequences(data):
    inputs = [('rumba_13', 'sequences/rumba_13', 2), ('rumba_13', 'sequences/rumba_13', 3), ('faerie', 'sequences/md2_faerie/faerie.md2', 2),
              ('faerie', 'sequences/md2_faerie/faerie.md2', 3)]
    results = [compare(data / path, every) for _, path, every in inputs]
    return table([f'{name}, every {every}{"nd" if every == 2 else "rd"}' for name, _, every in inputs], results)


def sampled(path, *moments):
    """Positions (k, n, 3), times (k) and faces of a motion at some moments, as `chronormal sample` writes them."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / 'poses.npz'
        subprocess.run([PROGRAM, 'sample', path, *moments, '--quiet', '-o', out], check=True, capture_output=True)
        arrays = np.load(out)
        return arrays['positions'].astype(float), arrays['times'], arrays['faces']


def screens(data):
    """The table of differences on the screen, for the dance and a face."""
    lines = []
    for title, path, moments in [('the dance', 'sequences/rumba_13', ['--times', 'keys']),
                                 ('a face', 'rigs/ict_capture.glb', ['--animation', '0', '--times', '0:0.5:4'])]:
        poses, _, faces = sampled(data / path, *moments)
        low, high = poses.min((0, 1)), poses.max((0, 1))
        width = 1.02 * (high - low)[:2].max()
        view = (low + high)[0] / 2 - width / 2, (low + high)[1] / 2 - width / 2, width
        all_of = {}
        for start, end in zip(poses, poses[1:]):
            for name, found in shading.differences(start, end, faces, view).items():
                all_of.setdefault(name, []).append(found)
        for name, found in all_of.items():
            angles, levels = (np.concatenate(part) for part in zip(*found))
            cells = [angles.mean(), np.percentile(angles, 99), np.median(levels), np.percentile(levels, 99)]
            lines.append(f'| {title} | `{name}` | ' + ' | '.join(f'{cell:.2f}' for cell in cells) + ' |')
    head = ['| | scheme | mean, degrees | 99 %, degrees | median pixel, levels | 99 % of pixels, levels |', '|---|---|--:|--:|--:|--:|']
    return '\n'.join(head + lines)


def bands(data):
    """The table of jumps of dn/dt at keyframes, for motions that are known and for the dance."""
    columns = []
    for name, (mesh, moved) in MOTIONS.items():
        times = np.linspace(0, 1, 9)
        columns.append(shading.mach_bands([moved(mesh[0], t) for t in times], times, mesh[1]))
    poses, times, faces = sampled(data / 'sequences/rumba_13', '--times', 'keys')
    columns.append(shading.mach_bands(list(poses), times, faces))
    titles = {'linear': '`linear` (nlerp)', 'polynomial': '`polynomial`: exact of straight paths', 'curve': 'exact of curved paths (Catmull-Rom)'}
    lines = ['| jump of dn/dt, % of its size | the turn, 8 segments | the twist, 8 segments | the dance |', '|---|--:|--:|--:|']
    return '\n'.join(lines + [f'| {titles[name]} | ' + ' | '.join(f'{100 * column[name]:.1f}' for column in columns) + ' |' for name in titles])


def table_1(data):
    """The table of sums relative to linear over 21 samples of each segment, as in Table 1 of the paper."""
    names = ['linear', 'quadratic', 'cubic', 'polynomial', 'slerp', 'decasteljau:4', 'quaternion:matrix', 'quaternion:optimal', 'circle:timed']
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
