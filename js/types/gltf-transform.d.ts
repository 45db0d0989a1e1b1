import type { Transform } from '@gltf-transform/core';
import type { BakeOptions, Report } from './index.js';

/** A transform that writes right normals into a document: bake() of it, in place. */
export function chronormal(options?: Omit<BakeOptions, 'name' | 'resources'> & { onReport?: (report: Report) => void }): Transform;
/** Adds `gltf-transform chronormal IN OUT`: what onProgramReady is in a gltf-transform.config.mjs. */
export function command(context: { program: any; io: any; Session: any }): void;
