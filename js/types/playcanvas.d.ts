import type { AppBase, Asset, MeshInstance } from 'playcanvas';

/**
 * Drives the correction targets of all meshes of the given baked files (containers) that an application shows, until
 * detach(). Returns the driven meshes.
 */
export function attach(app: AppBase, ...assets: Asset[]): MeshInstance[];
/** Stops driving the meshes of an application, and sets the weights of correction targets to 0. */
export function detach(app: AppBase): void;
