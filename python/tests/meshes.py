"""Makes meshes for tests, and normals by cross products in float64, which share no code with the library."""

import numpy as np

QUADS = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [4, 5, 9, 8], [5, 6, 10, 9], [6, 7, 11, 10]])


def sheet(seed=1, triangles=True):
    """Return a bent sheet of 12 vertices that moves: (p0, p1, faces)."""
    random = np.random.default_rng(seed)
    grid = np.array([[x, y, 0] for y in range(3) for x in range(4)], dtype=np.float64)
    p0 = grid + 0.2 * random.standard_normal((12, 3))
    p1 = grid[:, [2, 0, 1]] + 0.2 * random.standard_normal((12, 3))
    faces = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]]) if triangles else QUADS
    return p0.astype(np.float32), p1.astype(np.float32), faces


def face_normals(positions, faces):
    """Return twice the vector area of each face, also for polygons."""
    result = []
    for face in faces:
        corners = positions[np.asarray(face)]
        result.append(sum(np.cross(corners[i] - corners[0], corners[i + 1] - corners[0]) for i in range(1, len(face) - 1)))
    return np.array(result)


def unit(normals):
    return normals / np.linalg.norm(normals, axis=-1, keepdims=True)


def vertex_normals(positions, faces):
    positions = np.asarray(positions, dtype=np.float64)
    sums = np.zeros_like(positions)
    for face, normal in zip(faces, face_normals(positions, faces)):
        for vertex in face:
            sums[vertex] += normal
    return unit(sums)


def angle(a, b):
    """Return the angle in radians between each row of `a` and the same row of `b`, by atan2."""
    a, b = np.asarray(a, dtype=np.float64), np.asarray(b, dtype=np.float64)
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1))


def blended(p0, p1, t):
    return (1 - t) * p0.astype(np.float64) + t * p1.astype(np.float64)
