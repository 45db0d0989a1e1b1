import type { AbstractMesh, Scene } from '@babylonjs/core';

/** Drives the correction targets of all meshes of baked files in a scene, until detach(). Returns the driven meshes. */
export function attach(scene: Scene): AbstractMesh[];
/** Stops driving the meshes of a scene, and sets the weights of correction targets to 0. */
export function detach(scene: Scene): void;
