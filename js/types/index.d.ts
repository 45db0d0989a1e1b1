/** Declares the functions that audit and bake files. The functions touch neither a file system nor the network. */
import type { AuditReport, BakeReport, CompareReport, Elements, InspectReport, PathName, PlanReport, Weighting } from './reports.js';

export * from './reports.js';

export type Viewer = 'three' | 'babylon' | 'playcanvas' | 'godot' | 'filament' | 'bevy' | 'gltfpack' | 'quantize' | 'meshopt';

export interface Progress {
  /** The name of the current step, as in the program's progress bar. */
  label: string;
  percent: number;
}

/** The options that every call has. */
export interface CallOptions {
  /**
   * The name of the input, whose extension tells its format: walk.npz. The name may have folders in it. A name that no
   * file can have is refused with code 2. Default: input.glb or input.gltf.
   */
  name?: string;
  /** The files to which a .gltf refers, by their URIs, and the files that options name. */
  resources?: Record<string, Bytes>;
  /** A signal that stops the call. The promise of the call is then rejected with the reason of the signal. */
  signal?: AbortSignal;
  onProgress?: (progress: Progress) => void;
  /**
   * False to work in the calling thread, which is then blocked and checks `signal` only before it begins.
   * Default: true, and a worker does the work.
   */
  worker?: boolean;
  /** The limit of the program's memory in bytes, at least 16 MiB. Default: 4 GiB, or less if the machine has less. */
  memoryLimit?: number;
}

/**
 * The options for reading the input. All options except those of CallOptions are options of the program, written in
 * camel case: `maxTargets: 112` is `--max-targets 112`. `chronormal help COMMAND` explains the options. Options with
 * other names, and values of another type, are refused.
 */
export interface ReadOptions extends CallOptions {
  allowExternal?: boolean;
  maxExpansion?: number;
  fps?: number;
  from?: number;
  to?: number;
  every?: number;
  loop?: boolean;
  strict?: boolean;
  /**
   * The paths of vertices between the keyframes of a sequence (.npz, for example, but not glTF). Default: straight
   * lines. Curves are cut into straight pieces whose normals are within 0.01 degrees of the curve's normals, or within
   * the tolerance that follows the name.
   */
  path?: PathName | `${'catmull-rom' | 'hermite'}:${number}`;
}

/** The options that select a motion of a file. */
interface MotionOptions extends ReadOptions {
  /** The base mesh if the input is a morph target: a name among `resources`. */
  base?: string;
  animation?: string | number;
}

export interface AuditOptions extends MotionOptions {
  rule?: 'gltf' | 'lerp' | 'nlerp' | 'slerp' | 'step' | 'flat';
  weighting?: Weighting;
  /** The viewers whose rendered normals are judged, besides the normals that the glTF specification demands. */
  for?: Viewer | 'all' | Array<Viewer | 'all'>;
  /** @deprecated the old name of `for` */
  host?: Viewer | 'all' | Array<Viewer | 'all'>;
  samples?: number;
  /** The poses that are judged besides the poses of the file: 'random', or a name among `resources`. */
  poses?: string;
  /** The two weights between which each target alone is moved. Default: '0:1'. */
  weights?: `${number}:${number}`;
  tolerance?: number;
  /** The largest number of edges of a glTF file over which errors may jump by more than 10 degrees at one moment. */
  tears?: number;
  noWeld?: boolean;
}

export interface BakeOptions extends ReadOptions {
  /**
   * The viewers that the result is made for. Default: all viewers that add up deltas. The errors in other viewers
   * become no larger if possible.
   */
  for?: Viewer | 'all' | Array<Viewer | 'all'>;
  encode?: 'smallest' | 'harmless' | 'exact' | 'endpoint' | 'keys';
  weighting?: Weighting;
  crease?: number;
  recomputeBase?: boolean;
  smooth?: boolean;
  maxBytes?: number;
  maxTargets?: number;
  animationsOnly?: boolean;
  /** The poses for which the file is baked besides the poses of the file: 'random', or a name among `resources`. */
  poses?: string;
  /** True to report the size and the errors of each candidate, and to make no file. */
  plan?: boolean;
  denseZeros?: boolean;
  tolerance?: number;
  noWeld?: boolean;
  noAudit?: boolean;
}

export type Scheme = 'recompute' | 'polynomial' | 'rational' | 'linear' | 'quadratic' | 'cubic' | `lagrange:${number}` | 'linear:scaled' | 'slerp'
  | 'decasteljau' | `decasteljau:${number}` | 'quaternion:matrix' | 'quaternion:edge' | 'quaternion:polar' | 'quaternion:random'
  | `quaternion:random:${number}` | 'quaternion:optimal' | 'circle' | 'circle:timed';

export interface CompareOptions extends MotionOptions {
  world?: boolean;
  schemes?: Scheme | Scheme[];
  samples?: number;
  elements?: Elements;
  crease?: number;
  noWeld?: boolean;
  weighting?: Weighting;
  access?: 'random' | 'sequential';
  certify?: boolean;
  tolerance?: number;
  /** The face for which the normals of each scheme are reported: the index of the face, or FACE:SEGMENT. */
  face?: number | string;
  blend?: number;
  active?: number;
  seed?: number;
  truth?: number;
  noTimes?: boolean;
}

export interface InspectOptions extends MotionOptions {
  world?: boolean;
}

export interface SampleOptions extends MotionOptions {
  world?: boolean;
  /** The times in seconds: one or several numbers, `FIRST:STEP:LAST`, or `keys` for the times of all keyframes. */
  times?: number | number[] | string;
  /**
   * A weight for each morph target, or such an array for each pose; or `NAME=WEIGHT,NAME=WEIGHT`, with 0 for other
   * targets.
   */
  weights?: number[] | number[][] | string;
  /** The scheme that interpolates between the exact normals at the ends of segments. Default: every normal is exact. */
  scheme?: Scheme;
  /** The number of steps per segment. With this option, the scheme computes each step from the previous one. */
  step?: number;
  elements?: Elements;
  crease?: number;
  hardEdges?: 'groups' | 'normals';
  noWeld?: boolean;
  weighting?: Weighting;
  /** The length of each normal: 1 for 'unit', and twice the area of a triangle for 'area'. Default: 'unit'. */
  length?: 'unit' | 'area';
}

export interface Sampled {
  /** The x, y and z of each normal, in the order of `shape`; (0, 0, 0) if there is no normal. */
  normals: Float32Array;
  /** Three numbers: the number of times or poses, of elements, and of coordinates (3). */
  shape: number[];
  warnings: string[];
}

export interface Judged<Report> {
  report: Report;
  /** The messages that the program writes besides the report, one line each. */
  warnings: string[];
  /** False if the result exceeds the requested tolerance or budget (exit code 4). */
  within: boolean;
}

export interface Baked extends Judged<BakeReport> {
  bytes: Uint8Array;
  /** The other files of a baked .gltf, by their names. */
  files: Record<string, Uint8Array>;
}

/**
 * An error of a call. `code` is the exit code of the program: 1 for a failure, 2 for wrong usage, 3 for an invalid
 * input.
 */
export class ChronormalError extends Error {
  constructor(code: number, message: string);
  name: 'ChronormalError';
  code: number;
}

/** The content of a file. A call copies the content before it returns, so the caller may reuse the memory at once. */
export type Bytes = Uint8Array | ArrayBuffer | ArrayBufferView;

export function bake(input: Bytes, options?: BakeOptions & { plan?: false }): Promise<Baked>;
export function bake(input: Bytes, options: BakeOptions & { plan: true }): Promise<Judged<PlanReport>>;
export function audit(input: Bytes, options?: AuditOptions): Promise<Judged<AuditReport>>;
export function inspect(input: Bytes, options?: InspectOptions): Promise<Judged<InspectReport>>;
export function compare(input: Bytes, options?: CompareOptions): Promise<Judged<CompareReport>>;
export function sample(input: Bytes, options?: SampleOptions): Promise<Sampled>;
