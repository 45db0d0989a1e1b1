import type { Transform } from '@gltf-transform/core';
import type { BakeOptions, GltfBakeReport } from './index.js';

/** The options of bake(), except those that name the input and its files, and except `plan`. */
export interface TransformOptions extends Omit<BakeOptions, 'name' | 'resources' | 'plan'> {
  onReport?: (report: GltfBakeReport) => void;
}

/** Returns a transform that bakes a document in place. */
export function chronormal(options?: TransformOptions): Transform;
/**
 * Adds the command `gltf-transform chronormal IN OUT`. Use this function as onProgramReady in a
 * gltf-transform.config.mjs.
 */
export function command(context: { program: any; io: any; Session: any }): void;
