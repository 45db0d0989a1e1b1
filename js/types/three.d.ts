import type { Mesh, Object3D } from 'three';

/** Drives the extra targets of all meshes of a baked file below an object, until detach(). Returns these meshes. */
export function attach(root: Object3D): Mesh[];
/** Leaves the meshes below an object to the application again; extra targets get the weight 0. */
export function detach(root: Object3D): void;
/** Sets the weights of extra targets once, before InstancedMesh.setMorphAt() takes those of a mesh. */
export function drive(root: Object3D): void;
