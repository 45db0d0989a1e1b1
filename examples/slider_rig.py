"""Sliders of a rig in Python: a base and two morph targets, and the normals at any weights."""
import chronormal as cn

base = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
lift = ([2], [[0, 0, 1]])  # vertex 2 alone
shear = [[0, 0, 0], [0, 0, 0], [0, 0, 1], [0, 0, 1]]

rig = cn.blend(base, [lift, shear], [[0, 1, 2], [0, 2, 3]])
for sliders in ([0, 0], [0.5, 0], [0.5, 1]):
    print(f"at {sliders}: the normal of vertex 2 is {rig.unit_normals(sliders)[2].round(3)}")
