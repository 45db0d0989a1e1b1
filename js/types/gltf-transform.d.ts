import type { Transform } from '@gltf-transform/core';
import type { BakeOptions, GltfBakeReport } from './index.js';

/** The options of bake(), but for those of its bytes and of a plan. */
export interface TransformOptions extends Omit<BakeOptions, 'name' | 'resources' | 'plan'> {
  onReport?: (report: GltfBakeReport) => void;
}

/** A transform that writes right normals into a document: bake() of it, in place. */
export function chronormal(options?: TransformOptions): Transform;
/** Adds `gltf-transform chronormal IN OUT`: what onProgramReady is in a gltf-transform.config.mjs. */
export function command(context: { program: any; io: any; Session: any }): void;
