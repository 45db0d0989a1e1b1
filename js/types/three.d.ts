import type { Mesh, Object3D } from 'three';

/**
 * Drives the correction targets of all meshes of a baked file below an object, until detach(). Returns the driven
 * meshes.
 */
export function attach(root: Object3D): Mesh[];
/** Stops driving the meshes below an object, and sets the weights of their correction targets to 0. */
export function detach(root: Object3D): void;
/**
 * Sets the weights of correction targets once. Call this function before InstancedMesh.setMorphAt() takes the weights
 * of a mesh.
 */
export function drive(root: Object3D): void;
