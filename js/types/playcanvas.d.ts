import type { AppBase, Asset, MeshInstance } from 'playcanvas';

/** Drives the correction targets of all meshes of baked files, which are containers, that an application shows, until detach(). Returns these meshes. */
export function attach(app: AppBase, ...assets: Asset[]): MeshInstance[];
/** Leaves the meshes of an application to it again; correction targets get the weight 0. */
export function detach(app: AppBase): void;
