"""A frame loop in Python: keyframes of a mesh, and the normals of the frames shown between them, in one array."""
import numpy as np

import chronormal as cn

faces = [[0, 1, 2], [0, 2, 3]]
keys = np.array([[[0, 0, 0], [1, 0, 0], [1, 1, z], [0, 1, 0]] for z in (0, 1, 0)], dtype=np.float32)
shown = np.empty((4, 3), dtype=np.float32)

curves = cn.curves(keys[0], keys[1], faces)
for k in range(len(keys) - 1):
    if k > 0:
        curves.next(keys[k], keys[k + 1])  # reuses the memory of the previous segment
    for t in (0, 0.5):
        curves.unit_normals(t, out=shown)
        print(f"t = {k + t}: the normal of vertex 2 is {shown[2].round(3)}")
