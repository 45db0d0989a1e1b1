/** Right normals for meshes that deform: audits and bakes glTF files. Nothing here touches a file system or the network. */

export type Host = 'three' | 'babylon' | 'playcanvas' | 'godot' | 'filament' | 'bevy' | 'gltfpack' | 'quantize' | 'meshopt';

export interface Progress {
  /** What is done, as the program's bar says it. */
  label: string;
  percent: number;
}

/** How a call is made. Every other option is one of the program, in camel case: `maxTargets: 112` is `--max-targets 112`. */
export interface CallOptions {
  /**
   * The name of the input, with its extension, which tells its format: walk.npz. It may have folders in it. A name that no
   * file can have is refused with code 2. Default: input.glb or input.gltf.
   */
  name?: string;
  /** The files that a .gltf names, by their URIs. */
  resources?: Record<string, Uint8Array | ArrayBuffer>;
  /** Ends the call in the middle; its promise is rejected with the reason. */
  signal?: AbortSignal;
  onProgress?: (progress: Progress) => void;
  /** false: the work is done in this thread, which waits for it, and `signal` is only looked at before. Default: in a worker. */
  worker?: boolean;
  /** The most bytes of memory that the program gets, 16 MiB at least. Default: 4 GiB, or what the machine gives. */
  memoryLimit?: number;
}

export interface JudgeOptions extends CallOptions {
  tolerance?: number;
  weighting?: 'area' | 'uniform' | 'angle' | (string & {});
  animation?: string | number;
  /** How vertices move between the keyframes of a sequence, which is not glTF but .npz, for example: straight by default. */
  path?: 'linear' | 'catmull-rom' | 'hermite';
  [option: string]: unknown;
}

export interface BakeOptions extends JudgeOptions {
  /** The hosts in which the result must be right, and nowhere worse than before. Default: all. */
  for?: Host[] | 'all';
  encode?: 'harmless' | 'exact' | 'endpoint' | (string & {});
  maxTargets?: number;
  maxBytes?: number;
  animationsOnly?: boolean;
  smooth?: boolean;
}

export interface AuditOptions extends JudgeOptions {
  host?: Host[] | 'all';
  samples?: number;
}

/** The JSON of the command, as `--json` prints it (docs/cli.md). */
export type Report = Record<string, unknown> & { schema: number };

export interface Judged {
  report: Report;
  /** What the program says beside its result, a line each. */
  warnings: string[];
  /** false: the result is beyond the tolerance or the budget that were asked for (exit code 4). */
  within: boolean;
}

export interface Baked extends Judged {
  bytes: Uint8Array;
  /** The files beside a .gltf, by their names. */
  files: Record<string, Uint8Array>;
}

/** What was refused or could not be done. `code` is the exit code of the program: 1 failed, 2 usage, 3 the input is invalid. */
export class ChronormalError extends Error {
  code: number;
}

export interface CompareOptions extends JudgeOptions {
  schemes?: string[];
  samples?: number;
  certify?: boolean;
}

/** Is copied before a call returns its promise, as resources are: the caller may use the memory again at once. */
export type Bytes = Uint8Array | ArrayBuffer | ArrayBufferView;

export function bake(input: Bytes, options?: BakeOptions): Promise<Baked>;
export function audit(input: Bytes, options?: AuditOptions): Promise<Judged>;
export function inspect(input: Bytes, options?: CallOptions & Record<string, unknown>): Promise<Judged>;
export function compare(input: Bytes, options?: CompareOptions): Promise<Judged>;
