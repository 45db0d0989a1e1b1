# Measures for tools/truth/truth.py what errors of normals come to on the screen, and how much dn/dt jumps at keyframes.
# The right normals are computed here, in double, from positions alone; those that schemes show come from the program
# (normals_shown.cpp).
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


def differences(start, end, faces, view, shown, t, size=512):
    """By scheme: (angles in degrees of vertices that turn, differences in levels of pixels that show such a vertex) to exact
    normals, on the surface that is shown, whose vertices move straight. shown has the unit normals at t by scheme."""
    at = lambda s: normals_of((1 - s) * start + s * end, faces)
    positions, exact = (1 - t) * start + t * end, at(t)
    pixels = seen(positions, faces, size, view)
    right = levels(exact, faces, pixels)
    turning = np.linalg.norm(at(1) - at(0), axis=1) > 1e-6
    touched = turning[faces[pixels[0]]].any(1)
    result = {}
    for name, normals in shown.items():
        angles = np.degrees(np.arctan2(np.linalg.norm(np.cross(normals, exact), axis=1), np.sum(normals * exact, 1)))
        result[name] = angles[turning], np.abs(levels(normals, faces, pixels) - right)[touched]
    return result


# Where normals have to be known for jumps(): the ends of a segment, and two steps from each.
STEP = 1 / 128
MOMENTS = [0, STEP, 2 * STEP, 1 - 2 * STEP, 1 - STEP, 1]


def jumps(shown, times):
    """How much dn/dt jumps at the keyframes between, as a share of its mean size there: shown[s] has the unit normals in
    segment s at MOMENTS. Means over vertices and keyframes."""
    lengths = np.diff(times)
    slope = lambda at, step, length: (-3 * at[0] + 4 * at[1] - at[2]) / (2 * step * length)
    jumped = speed = 0
    for s in range(len(shown) - 1):
        before = slope(shown[s][:2:-1], -STEP, lengths[s])
        after = slope(shown[s + 1][:3], STEP, lengths[s + 1])
        jumped += np.linalg.norm(after - before, axis=1).sum()
        speed += (np.linalg.norm(before, axis=1) + np.linalg.norm(after, axis=1)).sum() / 2
    return jumped / speed
