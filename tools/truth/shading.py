# Measures for tools/truth/truth.py what errors of normals come to on the screen, and how much dn/dt jumps at keyframes.
# Everything is computed in double from the positions of keyframes alone.
import numpy as np

LIGHT = np.array([0.4, 0.5, 0.77]) / np.linalg.norm([0.4, 0.5, 0.77])
AMBIENT = 0.1


def unit(vectors):
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0)


def normals_of(positions, faces):
    """Unit normals (n, 3) of vertices, weighted by area."""
    corners = positions[faces]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(positions)
    for c in range(3):
        np.add.at(sums, faces[:, c], areas)
    return unit(sums)


def slerp(a, b, t):
    angle = np.arccos(np.clip(np.sum(a * b, 1), -1, 1))[:, None]
    sine = np.where(angle > 1e-6, np.sin(angle), 1)
    arc = (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / sine
    return unit(np.where(angle > 1e-6, arc, (1 - t) * a + t * b))


def de_casteljau(points, t):
    while len(points) > 1:
        points = [slerp(a, b, t) for a, b in zip(points, points[1:])]
    return points[0]


def schemes(at, t):
    """Unit normals by scheme, interpolated from the exact ones, at(t), at the nodes of the scheme."""
    start, end = at(0), at(1)
    return {'linear': unit((1 - t) * start + t * end),
            'slerp': slerp(start, end, t),
            'quadratic': unit((1 - t) * (1 - 2 * t) * start + 4 * t * (1 - t) * at(0.5) + t * (2 * t - 1) * end),
            'decasteljau:4': de_casteljau([start, at(1 / 3), at(2 / 3), end], t)}


def seen(positions, faces, size, view):
    """The pixels that show a face, from along z within view = (left, bottom, width): faces (p) and barycentric weights (p, 3)."""
    left, bottom, width = view
    screen = np.column_stack([(positions[:, 0] - left) / width * size, (positions[:, 1] - bottom) / width * size, positions[:, 2]])
    depth = np.full((size, size), -np.inf)
    face_at = np.full((size, size), -1)
    weights = np.zeros((size, size, 3))
    for f, (a, b, c) in enumerate(screen[faces]):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area <= 0:  # it shows its back
            continue
        low = np.maximum(np.ceil(np.min([a, b, c], 0)[:2] - 0.5).astype(int), 0)
        high = np.minimum(np.floor(np.max([a, b, c], 0)[:2] - 0.5).astype(int), size - 1)
        if (low > high).any():
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1) + 0.5, np.arange(low[1], high[1] + 1) + 0.5)
        v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        z = (1 - v - w) * a[2] + v * b[2] + w * c[2]
        part = (slice(low[1], high[1] + 1), slice(low[0], high[0] + 1))
        inside = (v >= 0) & (w >= 0) & (v + w <= 1) & (z > depth[part])
        depth[part][inside] = z[inside]
        face_at[part][inside] = f
        weights[part][inside] = np.stack([1 - v - w, v, w], -1)[inside]
    shown = face_at >= 0
    return face_at[shown], weights[shown]


def levels(normals, faces, pixels):
    """Grey of 0 to 255, as a screen shows it (sRGB), of a matte surface under one light."""
    of_face, weights = pixels
    n = unit(np.einsum('pc,pcd->pd', weights, normals[faces[of_face]]))
    light = AMBIENT + (1 - AMBIENT) * np.maximum(n @ LIGHT, 0)
    return 255 * np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def differences(start, end, faces, view, t=0.25, size=512):
    """By scheme: (angles in degrees of vertices that move, differences in levels of pixels) to exact normals, on the surface
    that is shown, whose vertices move straight."""
    at = lambda s: normals_of((1 - s) * start + s * end, faces)
    positions, exact = (1 - t) * start + t * end, at(t)
    pixels = seen(positions, faces, size, view)
    right = levels(exact, faces, pixels)
    turning = np.linalg.norm(at(1) - at(0), axis=1) > 1e-6
    touched = turning[faces[pixels[0]]].any(1)
    result = {}
    for name, normals in schemes(at, t).items():
        angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(normals, exact), axis=1), np.sum(normals * exact, 1)))
        result[name] = angles[turning], np.abs(levels(normals, faces, pixels) - right)[touched]
    return result


def catmull_rom(keys, times, s, t):
    """Positions on the curves of chronormal: velocities are those of parabolas, and at both ends of the cubic through four keyframes."""
    def velocity(k):
        first, last = (max(k - 1, 0), min(k + 2, len(keys))) if 0 < k < len(keys) - 1 else (0, 4) if k == 0 else (len(keys) - 4, len(keys))
        nodes = range(max(first, 0), min(last, len(keys)))
        total = 0
        for i in nodes:
            if i == k:
                share = sum(1 / (times[k] - times[j]) for j in nodes if j != k)
            else:
                share = np.prod([(times[k] - times[j]) / (times[i] - times[j]) for j in nodes if j not in (i, k)]) / (times[i] - times[k])
            total = total + share * keys[i]
        return total

    d = times[s + 1] - times[s]
    return ((1 + 2 * t) * (1 - t) ** 2 * keys[s] + t * t * (3 - 2 * t) * keys[s + 1]
            + d * t * (1 - t) ** 2 * velocity(s) - d * t * t * (1 - t) * velocity(s + 1))


def jumps(keys, times, faces, at):
    """How much dn/dt jumps at the keyframes between, as a share of its mean size there: at(s, t) are the unit normals in
    segment s. Means over vertices and keyframes."""
    h = 1e-4
    jumped = speed = 0
    for k in range(1, len(keys) - 1):
        before = (at(k - 1, 1) - at(k - 1, 1 - h)) / (h * (times[k] - times[k - 1]))
        after = (at(k, h) - at(k, 0)) / (h * (times[k + 1] - times[k]))
        jumped += np.linalg.norm(after - before, axis=1).sum()
        speed += (np.linalg.norm(before, axis=1) + np.linalg.norm(after, axis=1)).sum() / 2
    return jumped / speed


def mach_bands(keys, times, faces):
    """The share by which dn/dt jumps, by the path between keyframes."""
    normals = [normals_of(key, faces) for key in keys]
    return {'linear': jumps(keys, times, faces, lambda s, t: unit((1 - t) * normals[s] + t * normals[s + 1])),
            'polynomial': jumps(keys, times, faces, lambda s, t: normals_of((1 - t) * keys[s] + t * keys[s + 1], faces)),
            'curve': jumps(keys, times, faces, lambda s, t: normals_of(catmull_rom(keys, times, s, t), faces))}
