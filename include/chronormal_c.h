/* chronormal for C and every language that can call C: exact normals of meshes that deform.
 *
 *     chronormal_mesh mesh = {vertex_count, face_count, corners, NULL};
 *     chronormal_curves* curves = NULL;
 *     if (chronormal_curves_create(&mesh, from, to, NULL, &curves) != CHRONORMAL_DONE)
 *       fprintf(stderr, "%s\n", chronormal_last_message());
 *     chronormal_curves_unit_normals(curves, 0.5, normals, NULL);
 *     chronormal_curves_destroy(curves);
 *
 * Shapes     Vectors are three float32, one after the other; a stride in bytes leads from one vector to the next, and 0
 *            stands for 12. Strides are multiples of 4, and 12 or more.
 * Times      t is a fraction of a segment, 0 to 1. Functions whose names end in _write refuse any other t; the older
 *            functions move t to the nearer end, and write zeros if t is NaN.
 * Ownership  All arrays belong to the caller and are only read or written during the call. An object is destroyed by
 *            the function whose name ends in _destroy, which also accepts NULL.
 * Errors     A function that can fail returns a chronormal_status and changes nothing when it fails.
 *            chronormal_last_message() returns the message for people, with the place, for the calling thread. Nothing
 *            throws.
 * Threads    Different objects may be used at the same time, and each by one thread at a time. Functions that take a
 *            const object may run on any number of threads for the same object.
 * Growth     Structures of options begin with their size, so that a program that was compiled with an older header
 *            keeps working: call the _init function, or set the size and every field. A library that is older than the
 *            header refuses fields that it does not know, unless their bytes are 0.
 */
#ifndef CHRONORMAL_C_H_
#define CHRONORMAL_C_H_

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(chronormal_c_EXPORTS)
#define CHRONORMAL_API __declspec(dllexport)
#elif defined(_WIN32)
#define CHRONORMAL_API
#else
#define CHRONORMAL_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The outcome of a call. The values are the exit codes of the program. */
typedef enum chronormal_status {
  CHRONORMAL_DONE = 0,
  CHRONORMAL_FAILED = 1,       /* memory or files could not be used, or the library failed */
  CHRONORMAL_USAGE = 2,        /* an argument names something that does not exist, or does not fit the others */
  CHRONORMAL_INVALID_INPUT = 3 /* the data are wrong */
} chronormal_status;

/* Returns the version of the library at run time, MAJOR.MINOR.PATCH, as in "0.2.0". */
CHRONORMAL_API const char* chronormal_version(void);
/* Returns a sentence about the last call on this thread that failed, or "" if none has failed. The text stays valid
 * until the next call that fails. */
CHRONORMAL_API const char* chronormal_last_message(void);

/* Polygons over vertices. `corners` has the vertices of all faces, one face after the other. `offsets` has
 * face_count + 1 numbers, the first of which is 0: face f has the corners offsets[f] to offsets[f + 1] - 1. If
 * `offsets` is NULL, every face is a triangle. */
typedef struct chronormal_mesh {
  size_t vertex_count;
  size_t face_count;
  const uint32_t* corners;
  const uint32_t* offsets;
} chronormal_mesh;

typedef struct chronormal_vectors {
  const float* data;
  size_t stride; /* bytes from one vector to the next; 0 stands for 12 */
} chronormal_vectors;

typedef struct chronormal_result {
  float* data;
  size_t stride; /* bytes from one vector to the next; 0 stands for 12 */
} chronormal_result;

typedef enum chronormal_elements {
  CHRONORMAL_FACES = 0,
  CHRONORMAL_VERTICES = 1,
  CHRONORMAL_CORNERS = 2
} chronormal_elements;

typedef struct chronormal_options {
  size_t size;           /* sizeof(chronormal_options) */
  int elements;          /* a chronormal_elements; usually CHRONORMAL_VERTICES */
  int separate;          /* if not 0, vertices at one point do not share a normal, so that seams show */
  double crease_angle;   /* degrees; for corners, edges with a larger angle at t = 0 are hard; usually 180 */
  const char* weighting; /* "area" (exact), or another name of docs/truth.md; NULL: area */
  double tolerance;      /* the largest error in radians; usually 1e-6; 1e-3 needs a third of the memory */
  int all_threads;       /* if not 0, all cores are used */
} chronormal_options;

CHRONORMAL_API void chronormal_options_init(chronormal_options* options);

/* The format of a normal in memory. */
typedef enum chronormal_format {
  CHRONORMAL_FLOAT32 = 0,    /* three float32 */
  CHRONORMAL_OCTAHEDRAL = 1, /* 4 bytes: two int16, the octahedral encoding as snorm; (0, 0, 0) becomes (0, 0, 1) */
  CHRONORMAL_RGB10A2 = 2     /* 4 bytes: x, y, z as snorm of 10 bits each, from the lowest bits up */
} chronormal_format;

#define CHRONORMAL_ALL ((size_t)-1)

/* The memory for normals, and the range of normals to write. Normal i is written to data + i * stride, whatever the
 * range. */
typedef struct chronormal_output {
  size_t size;         /* sizeof(chronormal_output) */
  void* data;          /* the memory of normal 0 */
  size_t stride;       /* bytes from one normal to the next; 0 stands for the size of the format, which is the only
                        * stride that formats of 4 bytes may have */
  int format;          /* a chronormal_format; usually CHRONORMAL_FLOAT32 */
  size_t first, count; /* the normals that are written; usually 0 and CHRONORMAL_ALL */
} chronormal_output;

CHRONORMAL_API void chronormal_output_init(chronormal_output* output, void* data);

/* Normals between two arrays of positions, exact for every t in [0, 1]. */
typedef struct chronormal_curves chronormal_curves;

/* Prepares the curves of a segment, in which vertices move straight from `from` to `to`. Options may be NULL. `from`
 * and `to` must have a position for each vertex. */
CHRONORMAL_API chronormal_status chronormal_curves_create(const chronormal_mesh* mesh, chronormal_vectors from,
                                                          chronormal_vectors to, const chronormal_options* options,
                                                          chronormal_curves** result);
/* Prepares the next segment of the same mesh, reusing the memory of the previous one. The vertices that share a normal
 * stay the same. */
CHRONORMAL_API chronormal_status chronormal_curves_next(chronormal_curves* curves, chronormal_vectors from,
                                                        chronormal_vectors to);
/* Returns the number of normals: one for each face, vertex or corner. */
CHRONORMAL_API size_t chronormal_curves_size(const chronormal_curves* curves);
/* Returns the number of bytes of memory that the curves take. */
CHRONORMAL_API size_t chronormal_curves_bytes(const chronormal_curves* curves);
/* Writes the unit normals at t, with (0, 0, 0) for elements without a normal. The number of such elements is stored in
 * `zeros`, unless `zeros` is NULL. */
CHRONORMAL_API chronormal_status chronormal_curves_unit_normals(chronormal_curves* curves, double t,
                                                                chronormal_result normals, size_t* zeros);
/* Writes the unit normals at many t, each to its own output. The total number of normals that are (0, 0, 0) is stored
 * in `zeros`, unless `zeros` is NULL. Runs on the calling thread without allocating memory, so that jobs of an engine
 * can write ranges of one output. */
CHRONORMAL_API chronormal_status chronormal_curves_write(const chronormal_curves* curves, const double* times,
                                                         const chronormal_output* outputs, size_t count, size_t* zeros);
/* Writes the angle in degrees, float32, between each given normal, which need not be a unit vector, and the exact
 * normal at t: the error of an interpolation. The angle is 180 if only the given normal or only the exact normal has a
 * direction. */
CHRONORMAL_API chronormal_status chronormal_curves_errors(chronormal_curves* curves, double t,
                                                          chronormal_vectors normals, float* degrees);
CHRONORMAL_API void chronormal_curves_destroy(chronormal_curves* curves);

/* A morph target: its deltas, and the vertices to which they are added, in ascending order. If `vertices` is NULL,
 * every vertex has a delta. */
typedef struct chronormal_target {
  size_t count;             /* number of deltas */
  const uint32_t* vertices; /* `count` numbers of vertices, or NULL */
  chronormal_vectors deltas;
} chronormal_target;

/* Normals of blend shapes, exact at any weights. */
typedef struct chronormal_blend chronormal_blend;

/* Prepares blend shapes. The options must have the tolerance 1e-6 and the weighting "area". */
CHRONORMAL_API chronormal_status chronormal_blend_create(const chronormal_mesh* mesh, chronormal_vectors base,
                                                         const chronormal_target* targets, size_t target_count,
                                                         const chronormal_options* options, chronormal_blend** result);
CHRONORMAL_API size_t chronormal_blend_size(const chronormal_blend* blend);
/* Writes the unit normals of the blend shapes at `weights`, which has a weight for each target. */
CHRONORMAL_API chronormal_status chronormal_blend_unit_normals(chronormal_blend* blend, const double* weights,
                                                               chronormal_result normals, size_t* zeros);
/* Sets the weights and moves the vertices. Call this function once per frame. Afterwards, several threads may write
 * ranges of normals at the same time. */
CHRONORMAL_API chronormal_status chronormal_blend_set_weights(chronormal_blend* blend, const double* weights);
CHRONORMAL_API chronormal_status chronormal_blend_write(const chronormal_blend* blend, const chronormal_output* output,
                                                        size_t* zeros);
CHRONORMAL_API void chronormal_blend_destroy(chronormal_blend* blend);

/* A motion from files, in every format that the program reads. */
typedef struct chronormal_motion chronormal_motion;

/* Reads files as the command line of `chronormal sample` does, but needs at least two keyframes, or a file with a
 * motion. The tolerance of the options is not used. */
CHRONORMAL_API chronormal_status chronormal_motion_read(const char* const* files, size_t file_count,
                                                        const chronormal_options* options, chronormal_motion** result);
/* Sets the path of the vertices of a sequence, like `chronormal sample --path`: "linear" (at first), "catmull-rom", on
 * curves through the keyframes, or "hermite", with the velocities of the file. Curves are cut into straight pieces,
 * whose normals are within 0.01 degrees (or the tolerance in "catmull-rom:0.1") of the curve's normals, plus the effect
 * of rounding positions to float. Errors: CHRONORMAL_USAGE if the motion cannot have such paths. */
CHRONORMAL_API chronormal_status chronormal_motion_follow(chronormal_motion* motion, const char* path);
/* Returns the number of normals: one for each face, vertex or corner. */
CHRONORMAL_API size_t chronormal_motion_size(const chronormal_motion* motion);
/* Returns the first and the last time of a motion in seconds; 0 and 0 for morph targets. */
CHRONORMAL_API void chronormal_motion_times(const chronormal_motion* motion, double* first, double* last);
CHRONORMAL_API chronormal_status chronormal_motion_unit_normals(chronormal_motion* motion, double time,
                                                                chronormal_result normals);
CHRONORMAL_API void chronormal_motion_destroy(chronormal_motion* motion);

#ifdef __cplusplus
}
#endif

#endif /* CHRONORMAL_C_H_ */
