import type { AbstractMesh, Scene } from '@babylonjs/core';

/** Drives the correction targets of all meshes of baked files in a scene, until detach(). Returns these meshes. */
export function attach(scene: Scene): AbstractMesh[];
/** Leaves the meshes of a scene to the application again; correction targets get the weight 0. */
export function detach(scene: Scene): void;
