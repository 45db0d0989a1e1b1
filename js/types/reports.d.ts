/**
 * Declares the reports of the functions, which equal the output of the commands with `--json` (docs/cli.md). New keys
 * may be added, but the meaning of a key never changes. Angles are in degrees. Vertices, faces, targets, nodes and so
 * on are counted from 0, and null stands for a value that does not exist.
 */

export type Weighting = 'area' | 'angle' | 'uniform' | 'area-angle' | 'max' | 'inverse-edges' | 'inverse-roots';
export type PathName = 'linear' | 'catmull-rom' | 'hermite';
export type Elements = 'faces' | 'vertices' | 'corners';

/** The fields with which every report begins. */
interface Head<Command extends string, Schema extends number> {
  /** The version of the program. */
  chronormal: string;
  command: Command;
  schema: Schema;
}

/** The description of a path that is curved and was cut into straight pieces. */
interface CurvedPath {
  path?: PathName;
  bend?: number;
  is_too_sparse?: boolean;
  cut?: { tolerance_degrees: number; segments: number; pieces: number; faces_beyond: number; rounding: number };
}

// The next types describe audits.

export interface AuditPlace {
  mesh?: number;
  primitive?: number | null;
  vertex: number;
  segment?: number;
  /** The weight at this place. Present if the weight of a target or an expression moves. */
  weight?: number;
  /** The time in seconds. Present for an animation or a sequence. */
  time?: number;
  /** The number of the pose, if the call asked for poses. */
  pose?: number;
}

/** The errors of the rendered normals over all samples. */
export interface MotionError {
  worst_degrees: number;
  mean_degrees: number;
  rms_degrees: number;
  percentile_99_degrees: number;
  percentile_99_9_degrees: number;
  judged: number;
  no_normal: number;
  faint: number;
  faint_worst_degrees: number;
  /**
   * The number of samples without a true normal, although the faces around have an area. Each such sample exceeds any
   * tolerance.
   */
  cancelled: number;
  unlit: number;
  /**
   * The number of edges over which errors jump by more than 10, 20 and 40 degrees, on average over all samples. Only
   * for glTF files.
   */
  torn_edges?: [number, number, number];
  /** The number of edges over which errors jump by more than 10 degrees, at the moment with the most such edges. */
  most_torn_edges?: number;
}

export interface HistogramBin {
  from_degrees: number;
  to_degrees: number;
  pairs: number;
}

export interface AuditSubject extends MotionError {
  kind: 'target' | 'track' | 'sequence' | 'expression' | 'opening' | 'poses';
  name: string;
  mesh: number | null;
  target: number | null;
  animation: number | null;
  node: number | null;
  expression: number | null;
  weighting: Weighting;
  segments: number;
  samples: number;
  vertices: number;
  worst_at_keys_degrees: number;
  skinning_worst_degrees: number | null;
  skinning_mean_degrees: number | null;
  worst_at: AuditPlace | null;
  faint_at: AuditPlace | null;
  unlit_at: AuditPlace | null;
  histogram: HistogramBin[];
}

export interface ViewerAudit extends MotionError {
  name: string;
  title: string;
  normals: 'sum' | 'unit' | 'clamped';
  tracks: 'specified' | 'splines_resampled' | 'all_resampled' | 'splines_without_duration' | 'splines_misread';
  skins: 'blended' | 'inverse_transpose' | 'by_joint';
  most_targets: number | null;
  source: string;
  passed: boolean | null;
  worst_subject: number | null;
  worst_at: AuditPlace | null;
  displaced_share: number;
  targets_beyond: number;
}

export interface AuthoredOffset {
  mesh: number | null;
  vertices: number;
  weighting: Weighting;
  weighting_detected: boolean;
  /** True if the true normals are weighted by the polygons from which the triangles of the file were made. */
  polygons: boolean;
  worst_degrees: number;
  mean_degrees: number;
  worst_at: AuditPlace | null;
  area_mean_degrees: number;
  closest_weighting: Weighting;
  closest_mean_degrees: number;
  closest_worst_degrees: number;
}

export interface AuditFinding {
  kind: 'unlit' | 'missing_normals' | 'wrong_at_keys' | 'wrong_between' | 'wrong_together' | 'wrong_pose' | 'stale_tangents' | 'stale_keys'
    | 'unknown_rule' | 'flat_primitive' | 'skin' | 'unread_skin' | 'baked' | 'emptied' | 'baked_keyframes' | 'beyond_viewer';
  fault: boolean;
  mesh: number | null;
  target: number | null;
  animation: number | null;
  node: number | null;
  expression: number | null;
  count: number;
  viewer: string | null;
  reason: string | null;
  worst_degrees: number | null;
  worst_at: AuditPlace | null;
}

export interface AuditReport extends Head<'audit', 2>, MotionError, CurvedPath {
  input: { name: string };
  rule: string;
  weighting: Weighting | null;
  stored_normals: boolean;
  tolerance_degrees: number | null;
  tolerance_torn_edges: number | null;
  passed: boolean | null;
  worst_subject: number | null;
  worst_at: AuditPlace | null;
  histogram: HistogramBin[];
  still: number;
  subjects: AuditSubject[];
  viewers: ViewerAudit[];
  authored_offsets: AuthoredOffset[];
  findings: AuditFinding[];
  /** Notes on parts of the file that were left out or could not be read as intended. */
  notes: string[];
}

// The next types describe bakes.

export interface BakeAudit {
  worst_degrees_before: number;
  worst_degrees_after: number;
  mean_degrees_before: number;
  mean_degrees_after: number;
  unlit_before: number;
  unlit_after: number;
  torn_edges_before: number;
  torn_edges_after: number;
  worse: boolean;
}

export interface WholeBakeAudit extends BakeAudit {
  /** The errors in each viewer that the bake is made for or must not make worse; empty for sequences. */
  viewers: Array<BakeAudit & { viewer: string }>;
}

export interface ShownErrors {
  mean_degrees: number;
  most_degrees: number;
  worst_degrees: number;
  /** The number of edges over which errors jump by more than 10, 20 and 40 degrees, on average over all poses. */
  torn_edges: [number, number, number];
}

export interface JudgedPoses {
  judged: number;
  before: ShownErrors;
  after: ShownErrors;
}

export interface ViewerChange {
  viewer: string;
  /**
   * `named` is true if the bake is made for this viewer. `better` is true if the errors in this viewer became smaller
   * as a whole.
   */
  named: boolean;
  better: boolean;
  /** The errors in the animations of the file, with each target alone, and in poses that a program sets. */
  file?: JudgedPoses;
  alone?: JudgedPoses;
  posed?: JudgedPoses;
}

export interface BakeCandidate {
  name: string;
  targets: number;
  bytes: number;
  played: ShownErrors;
  viewers: ViewerChange[];
  within: boolean;
  chosen: boolean;
  animations_only: boolean;
  rounded_degrees: number;
}

export interface BakedMesh {
  mesh: number;
  name: string;
  encoding: string;
  weighting: Weighting | null;
  already_baked: boolean;
  different_normals: number;
  /**
   * The formulas of the weights of correction targets: linear terms [target, factor], and products [target, target,
   * factor].
   */
  extra_targets: Array<{ target: number; linear: number[][]; quadratic: number[][] }>;
  bytes: number;
  undriven_targets: number;
  flat_primitives: number;
  vertices_without_base: number;
  vertices_without_stored_normal: number;
  rescaled_normals: number;
  new_tangents: number;
  stilled_targets: number;
  fitted_normals: number;
  left_out_targets: number;
  viewers: ViewerChange[];
  candidates: BakeCandidate[];
  target_fit_degrees: number;
  track_fit_degrees: number;
  audit: BakeAudit | null;
}

interface BakeHead extends Head<'bake', 3> {
  input: { name: string };
  /** Notes on parts of the input that were left out or could not be read as intended. */
  notes: string[];
  warnings: string[];
}

/** The report of bake() for a glTF file. */
export interface GltfBakeReport extends BakeHead {
  output: string;
  changed: boolean;
  meshes: BakedMesh[];
  added_targets: number;
  added_bytes: number;
  left_out_bytes: number;
  converted_tracks: number;
  pointers: string[];
  drivers: string | null;
  audit?: WholeBakeAudit;
}

/** The report of bake() for a sequence, which becomes a glTF file. */
export interface SequenceBakeReport extends BakeHead, CurvedPath {
  output: string;
  encoding: string;
  keyframes: number;
  vertices: number;
  targets: number;
  extra_targets: number;
  bytes: number;
  bound_degrees: number;
  without_normals: number;
  keys?: { count: number; in_between: number; keyframes_left_out: number; even: number; beyond: number };
  audit?: WholeBakeAudit;
}

/** A report of bake(). Only the report for a glTF file has `meshes`, so this member tells the two types apart. */
export type BakeReport = GltfBakeReport | SequenceBakeReport;

/** The report of bake() with `plan`: the size and the errors of each candidate. */
export interface PlanReport extends BakeHead {
  plan: true;
  meshes: Array<{ mesh: number; name: string; candidates: BakeCandidate[] }>;
}

// The next types describe comparisons.

export interface ElementPlace {
  segment: number;
  element: number;
  t: number;
}

/** The errors of a scheme's normals. */
interface SchemeError {
  scheme: string;
  mean_degrees: number;
  rms_degrees: number;
  max_degrees: number;
  max_at: ElementPlace;
  degenerate: number;
  missing: number;
}

export interface SchemeReport extends SchemeError {
  sum_degrees: number;
  relative_to_linear: number | null;
  fallbacks: number;
  flagged: number;
  certified?: {
    lower_degrees: number;
    upper_degrees: number;
    upper_at: { segment: number; element: number; from: number; to: number };
    unbounded: number;
  };
  prepare_ns?: number;
  evaluate_ns?: number;
  bytes: number;
  access: 'random' | 'sequential';
  operations: { add: number; multiply: number; divide: number; sqrt: number; trigonometric: number };
}

interface ComparedInput {
  name: string;
  vertices: number;
  faces: number;
  different_normals?: number;
}

/** The report of compare() on ways to interpolate normals. */
export interface SchemesReport extends Head<'compare', 1> {
  input: ComparedInput & CurvedPath & { segments: number };
  elements: Elements;
  /** Present if the elements are vertices or corners. */
  weighting?: Weighting;
  samples: number;
  schemes: SchemeReport[];
  tolerance_degrees?: number;
  cheapest?: string | null;
}

export interface DeltasError {
  deltas: string;
  mean_degrees: number;
  rms_degrees: number;
  max_degrees: number;
  max_at: {
    row: number;
    primitive?: number;
    face?: number;
    vertex?: number;
    corner?: number;
    weights: Array<{ target: number; name: string; weight: number }>;
  } | null;
  normals: number;
  degenerate: number;
  missing: number;
}

export interface BlendedMesh {
  mesh?: number;
  name?: string;
  vertices: number;
  faces: number;
  targets: number;
  elements: Elements;
  normals: number;
  errors: Array<{ active: number; rows: number; deltas: DeltasError[] }>;
}

/** The report of compare() with `blend` on deltas that viewers add up. */
export interface BlendReport extends Head<'compare', 1> {
  input: string;
  weights: 'random' | 'animation';
  animation?: string;
  meshes: BlendedMesh[];
  flat_meshes: number;
  still_meshes: number;
}

/** The report of compare() with `truth` on keyframes that were left out. */
export interface TruthReport extends Head<'compare', 1> {
  input: ComparedInput;
  elements: Elements;
  kept_keyframes: number;
  left_out_keyframes: number;
  bend: number;
  is_too_sparse: boolean;
  rows: Array<SchemeError & { path: PathName }>;
}

/** The normals of a scheme on one face. In flat arrays, the coordinates of vectors follow each other. */
export interface SchemeFigure {
  scheme: string;
  sum_degrees: number;
  degrees: Array<number | null>;
  normals: number[];
  lengths: number[] | null;
  nodes: number[] | null;
  points: number[] | null;
  tangents: number[] | null;
}

/** The report of compare() with `face`: all values of one face, from which Figures 1 to 3 of the paper are drawn. */
export interface FigureReport extends Head<'compare', 1> {
  input: string;
  figure: {
    face: number;
    segment: number;
    from: number[][];
    to: number[][];
    t: number[];
    normals: number[];
    lengths: number[];
    matrix: number[][] | null;
    schemes: SchemeFigure[];
  };
}

export type CompareReport = SchemesReport | BlendReport | TruthReport | FigureReport;

// The next types describe inspections.

interface FoundFaces {
  count: number;
  first_face: number | null;
}

interface FoundVertices {
  count: number;
  first_vertex: number | null;
}

/**
 * The number of faces with a problem, and the number of pairs of a face and a keyframe or segment in which the face has
 * the problem.
 */
export interface FacePlaces<Place> {
  faces: number;
  pairs: number;
  first: (Place & { face: number }) | null;
}

export interface Surface {
  triangles: number;
  most_corners: number;
  pieces: number;
  edges: number;
  open_edges: FoundFaces;
  non_manifold_edges: FoundFaces;
  turned_edges: FoundFaces;
  seam_edges: FoundFaces;
  doubled_faces: FoundFaces;
  back_to_back: FoundFaces;
  concave_faces: FoundFaces;
  repeating_faces: FoundFaces;
  unreferenced_vertices: FoundVertices;
  doubled_vertices: FoundVertices;
  doubled_at_start: FoundVertices;
}

export interface InspectedSegment {
  from: number;
  to: number;
  name: string;
  moved_vertices: number;
  largest_motion: number;
  largest_turn_degrees: number;
  turns_far: number;
  collapses: number;
  vanishes: number;
  turns_over: number;
  without_normals: number;
  flagged: number;
  bytes: number;
}

export interface InspectedPrimitive {
  mode: number;
  vertices: number;
  normals: boolean;
  tangents: boolean;
  draco: boolean;
  targets: Array<{ positions: boolean; normals: boolean; tangents: boolean }>;
  /** Present, with the fields below, if the primitive has triangles. */
  triangles?: number;
  doubled_vertices?: number;
  split_normals?: number;
  normals_off_length?: number;
}

export interface InspectedTrack {
  node: number;
  node_name: string;
  interpolation: string;
  keys: number;
  first_time: number;
  last_time: number;
  lowest_weight: number;
  highest_weight: number;
}

export interface InspectedGltf {
  extensions: string[];
  nodes: number;
  skinned_nodes: number;
  meshes: Array<{
    name: string;
    nodes: number;
    targets: number;
    target_names: string[];
    weights: number[];
    primitives: InspectedPrimitive[];
  }>;
  animations: Array<{ name: string; channels: number; weight_tracks: InspectedTrack[] }>;
  animation: number | null;
  curve_error: number;
  split_normals: number;
  parts: Array<{
    node: number | null;
    mesh: number;
    primitive: number;
    first_vertex: number;
    vertices: number;
    first_face: number;
    faces: number;
  }>;
}

/**
 * The report of inspect(). For a glTF file without faces, the report has only `input`, `notes`, `gltf` and `trouble`.
 */
export interface InspectReport extends Head<'inspect', 1> {
  input: { name: string; vertices: number; faces: number; keyframes: number; segments: number };
  /** Facts about the numbers in the file names of a sequence. Present if these numbers order the files. */
  files?: { count: number; first: number; last: number; least_step: number; most_step: number; are_seconds: boolean };
  /** Notes for people on how the input was read, in sentences. */
  notes: string[];
  kind?: 'mesh' | 'targets' | 'sequence';
  time?: { first: number; last: number } | null;
  box?: { low: number[]; high: number[]; diagonal: number };
  largest_motion?: { distance: number; segment: number; vertex: number };
  largest_turn?: { degrees: number; segment: number; face: number };
  surface?: Surface;
  keyframe_faces?: { no_area: FacePlaces<{ keyframe: number }>; slivers: FacePlaces<{ keyframe: number }> };
  segment_faces?: {
    without_normals: FacePlaces<{ segment: number }>;
    collapses: FacePlaces<{ segment: number; t: number }>;
    vanishes: FacePlaces<{ segment: number; t: number }>;
    turns_over: FacePlaces<{ segment: number; t: number }>;
    turns_far: FacePlaces<{ segment: number }>;
    flagged: number;
  };
  bytes?: { keyframes: number; normals: number };
  segments?: InspectedSegment[];
  gltf?: InspectedGltf;
  trouble: Array<{ kind: string; count: number; what: string; where: string | null; meaning: string }>;
}
