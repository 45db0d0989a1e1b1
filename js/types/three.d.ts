import type { Mesh, Object3D } from 'three';

/** Drives the correction targets of all meshes of a baked file below an object, until detach(). Returns these meshes. */
export function attach(root: Object3D): Mesh[];
/** Leaves the meshes below an object to the application again; correction targets get the weight 0. */
export function detach(root: Object3D): void;
/** Sets the weights of correction targets once, before InstancedMesh.setMorphAt() takes the weights of a mesh. */
export function drive(root: Object3D): void;
