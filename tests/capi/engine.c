/* Uses the C interface as an engine in C99 would: compares normals with cross products in double, and checks the
 * messages about wrong arguments. Exits with 1 at the first failure. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "chronormal_c.h"

#define EXPECT(condition)                                                                     \
  do {                                                                                        \
    if (!(condition)) {                                                                       \
      fprintf(stderr, "line %d: %s (%s)\n", __LINE__, #condition, chronormal_last_message()); \
      return 1;                                                                               \
    }                                                                                         \
  } while (0)

/* An engine's vertex, in which the position is one of several fields. */
typedef struct vertex {
  float position[3];
  float colour[4];
} vertex;

/* A tent of four faces over a square. Its tip moves sideways while the square is bent. */
static const uint32_t kCorners[12] = {0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4};
static const vertex kFrom[5] = {
    {{0, 0, 0}, {0}}, {{2, 0, 0}, {0}}, {{2, 2, 0}, {0}}, {{0, 2, 0}, {0}}, {{1, 1, 1}, {0}}};
static const vertex kTo[5] = {
    {{0, 0, 1}, {0}}, {{2, 0, -1}, {0}}, {{2, 2, 1}, {0}}, {{0, 2, -1}, {0}}, {{3, 1, 2}, {0}}};

static double at(int v, int c, double t) { return (1 - t) * kFrom[v].position[c] + t * kTo[v].position[c]; }

/* Adds twice the vector area of a face at t to n. */
static void add_face(int face, double t, double n[3]) {
  double e[3], f[3];
  for (int c = 0; c < 3; ++c) {
    e[c] = at((int)kCorners[3 * face + 1], c, t) - at((int)kCorners[3 * face], c, t);
    f[c] = at((int)kCorners[3 * face + 2], c, t) - at((int)kCorners[3 * face], c, t);
  }
  for (int c = 0; c < 3; ++c) n[c] += e[(c + 1) % 3] * f[(c + 2) % 3] - e[(c + 2) % 3] * f[(c + 1) % 3];
}

/* Computes the expected normal of element i, which is a face, a vertex or a corner. */
static void truth(int elements, int i, double t, double n[3]) {
  n[0] = n[1] = n[2] = 0;
  for (int face = 0; face < 4; ++face) {
    int counts = elements == CHRONORMAL_FACES ? face == i : 0;
    for (int corner = 0; corner < 3; ++corner)
      if (elements != CHRONORMAL_FACES)
        counts |= (int)kCorners[3 * face + corner] == (elements == CHRONORMAL_VERTICES ? i : (int)kCorners[i]);
    if (counts) add_face(face, t, n);
  }
  const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int c = 0; c < 3; ++c) n[c] /= length;
}

static int check_curves(int elements, size_t size) {
  const chronormal_mesh mesh = {5, 4, kCorners, NULL};
  const chronormal_vectors from = {kFrom[0].position, sizeof(vertex)}, to = {kTo[0].position, sizeof(vertex)};
  chronormal_options options;
  chronormal_options_init(&options);
  options.elements = elements;
  chronormal_curves* curves = NULL;
  EXPECT(chronormal_curves_create(&mesh, from, to, &options, &curves) == CHRONORMAL_DONE);
  EXPECT(chronormal_curves_size(curves) == size && chronormal_curves_bytes(curves) > 0);
  for (int step = 0; step <= 8; ++step) {
    const double t = step / 8.0;
    vertex shown[12];
    size_t zeros = 99;
    EXPECT(chronormal_curves_unit_normals(curves, t, (chronormal_result){shown[0].position, sizeof(vertex)}, &zeros) ==
           CHRONORMAL_DONE);
    EXPECT(zeros == 0);
    float degrees[12];
    EXPECT(chronormal_curves_errors(curves, t, (chronormal_vectors){shown[0].position, sizeof(vertex)}, degrees) ==
           CHRONORMAL_DONE);
    for (size_t i = 0; i < size; ++i) {
      double n[3];
      truth(elements, (int)i, t, n);
      for (int c = 0; c < 3; ++c) EXPECT(fabs(shown[i].position[c] - n[c]) < 2e-6);
      EXPECT(degrees[i] < 1e-3F);
    }
  }
  /* The next segment leads back to the start, so it begins with the end of the first segment. */
  float packed[36], first[36];
  EXPECT(chronormal_curves_unit_normals(curves, 1, (chronormal_result){first, 0}, NULL) == CHRONORMAL_DONE);
  EXPECT(chronormal_curves_next(curves, to, from) == CHRONORMAL_DONE);
  EXPECT(chronormal_curves_unit_normals(curves, 0, (chronormal_result){packed, 0}, NULL) == CHRONORMAL_DONE);
  EXPECT(memcmp(first, packed, 12 * size) == 0);
  packed[0] = -packed[0], packed[1] = -packed[1], packed[2] = -packed[2];
  float degrees[12];
  EXPECT(chronormal_curves_errors(curves, 0, (chronormal_vectors){packed, 0}, degrees) == CHRONORMAL_DONE);
  EXPECT(fabsf(degrees[0] - 180) < 1e-3F && degrees[1] < 1e-3F);
  chronormal_curves_destroy(curves);
  return 0;
}

/* Decodes an octahedral normal without the library. */
static void decode(const int16_t word[2], double n[3]) {
  const double x = word[0] / 32767.0, y = word[1] / 32767.0, z = 1 - fabs(x) - fabs(y);
  n[0] = z < 0 ? (1 - fabs(y)) * (x < 0 ? -1 : 1) : x;
  n[1] = z < 0 ? (1 - fabs(x)) * (y < 0 ? -1 : 1) : y;
  n[2] = z;
  const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int c = 0; c < 3; ++c) n[c] /= length;
}

/* Checks that calls for ranges of elements or for many t give the same bits as one call for all elements, and that
 * packed normals are close to the unpacked normals. */
static int check_outputs(void) {
  const chronormal_mesh mesh = {5, 4, kCorners, NULL};
  const chronormal_vectors from = {kFrom[0].position, sizeof(vertex)}, to = {kTo[0].position, sizeof(vertex)};
  chronormal_curves* curves = NULL;
  EXPECT(chronormal_curves_create(&mesh, from, to, NULL, &curves) == CHRONORMAL_DONE);
  const double times[3] = {0, 0.375, 1};
  float whole[3][15], ranges[3][15];
  int16_t octahedral[5][2];
  uint32_t bits[5];
  size_t zeros = 99;
  for (int k = 0; k < 3; ++k)
    EXPECT(chronormal_curves_unit_normals(curves, times[k], (chronormal_result){whole[k], 0}, NULL) == CHRONORMAL_DONE);
  chronormal_output outputs[3];
  for (size_t first = 0; first < 5; first += 2) { /* 0 and 1, 2 and 3, 4 */
    for (int k = 0; k < 3; ++k) {
      chronormal_output_init(&outputs[k], ranges[k]);
      outputs[k].first = first;
      outputs[k].count = first + 2 <= 5 ? 2 : CHRONORMAL_ALL;
    }
    EXPECT(chronormal_curves_write(curves, times, outputs, 3, &zeros) == CHRONORMAL_DONE && zeros == 0);
  }
  EXPECT(memcmp(whole, ranges, sizeof whole) == 0);
  chronormal_output_init(&outputs[0], octahedral);
  outputs[0].format = CHRONORMAL_OCTAHEDRAL;
  chronormal_output_init(&outputs[1], bits);
  outputs[1].format = CHRONORMAL_RGB10A2;
  const double twice[2] = {times[1], times[1]};
  EXPECT(chronormal_curves_write(curves, twice, outputs, 2, NULL) == CHRONORMAL_DONE);
  for (int v = 0; v < 5; ++v) {
    double n[3];
    decode(octahedral[v], n);
    for (int c = 0; c < 3; ++c) {
      EXPECT(fabs(n[c] - whole[1][3 * v + c]) < 1e-4);
      const int word = (int)(bits[v] >> (10 * c)) & 1023;
      EXPECT(fabs((word < 512 ? word : word - 1024) / 511.0 - whole[1][3 * v + c]) < 2e-3);
    }
  }
  /* Wrong arguments must be reported, and nothing must be written. */
  const double beyond[2] = {0.5, 1.5}, none[1] = {NAN};
  memset(ranges, 0, sizeof ranges);
  for (int k = 0; k < 2; ++k) chronormal_output_init(&outputs[k], ranges[k]);
  EXPECT(chronormal_curves_write(curves, beyond, outputs, 2, NULL) == CHRONORMAL_USAGE && ranges[0][2] == 0);
  EXPECT(chronormal_curves_write(curves, none, outputs, 1, NULL) == CHRONORMAL_USAGE);
  for (size_t stride = 1; stride < 12; ++stride) {
    outputs[0].stride = stride;
    EXPECT(chronormal_curves_write(curves, times, outputs, 1, NULL) == CHRONORMAL_USAGE);
    EXPECT(chronormal_curves_unit_normals(curves, 0, (chronormal_result){ranges[0], stride}, NULL) == CHRONORMAL_USAGE);
    EXPECT(chronormal_curves_next(curves, (chronormal_vectors){ranges[0], stride}, to) == CHRONORMAL_USAGE);
  }
  outputs[0].stride = 0;
  outputs[0].first = 3;
  outputs[0].count = 3;
  EXPECT(chronormal_curves_write(curves, times, outputs, 1, NULL) == CHRONORMAL_USAGE);
  outputs[0].format = 3;
  EXPECT(chronormal_curves_write(curves, times, outputs, 1, NULL) == CHRONORMAL_USAGE);
  chronormal_curves_destroy(curves);
  return 0;
}

/* Tests options of a newer header: fields that this library does not know must be 0. */
static int check_newer_options(void) {
  const chronormal_mesh mesh = {5, 4, kCorners, NULL};
  const chronormal_vectors from = {kFrom[0].position, sizeof(vertex)};
  struct {
    chronormal_options options;
    double sharper;
  } newer;
  memset(&newer, 0, sizeof newer);
  chronormal_options_init(&newer.options);
  newer.options.size = sizeof newer;
  chronormal_curves* curves = NULL;
  EXPECT(chronormal_curves_create(&mesh, from, from, &newer.options, &curves) == CHRONORMAL_DONE);
  chronormal_curves_destroy(curves);
  newer.sharper = 0.5;
  curves = NULL;
  EXPECT(chronormal_curves_create(&mesh, from, from, &newer.options, &curves) == CHRONORMAL_USAGE && curves == NULL);
  EXPECT(strstr(chronormal_last_message(), "newer") != NULL);
  return 0;
}

static int check_blend(void) {
  const chronormal_mesh mesh = {5, 4, kCorners, NULL};
  float deltas[15];
  for (int v = 0; v < 5; ++v)
    for (int c = 0; c < 3; ++c) deltas[3 * v + c] = kTo[v].position[c] - kFrom[v].position[c];
  const uint32_t tip = 4;
  const float sideways[3] = {0, 1, 0};
  const chronormal_target targets[2] = {{5, NULL, {deltas, 0}}, {1, &tip, {sideways, 0}}};
  chronormal_blend* blend = NULL;
  EXPECT(chronormal_blend_create(&mesh, (chronormal_vectors){kFrom[0].position, sizeof(vertex)}, targets, 2, NULL,
                                 &blend) == CHRONORMAL_DONE);
  EXPECT(chronormal_blend_size(blend) == 5);
  const double weights[2] = {0.375, 0};
  float normals[15];
  size_t zeros = 99;
  EXPECT(chronormal_blend_unit_normals(blend, weights, (chronormal_result){normals, 0}, &zeros) == CHRONORMAL_DONE &&
         zeros == 0);
  for (int v = 0; v < 5; ++v) {
    double n[3];
    truth(CHRONORMAL_VERTICES, v, 0.375, n);
    for (int c = 0; c < 3; ++c) EXPECT(fabs(normals[3 * v + c] - n[c]) < 2e-6);
  }
  float ranges[15];
  chronormal_output output;
  chronormal_output_init(&output, ranges);
  EXPECT(chronormal_blend_set_weights(blend, weights) == CHRONORMAL_DONE);
  for (output.first = 0, output.count = 1; output.first < 5; ++output.first)
    EXPECT(chronormal_blend_write(blend, &output, &zeros) == CHRONORMAL_DONE && zeros == 0);
  EXPECT(memcmp(normals, ranges, sizeof ranges) == 0);
  const double infinite[2] = {0, INFINITY};
  EXPECT(chronormal_blend_set_weights(blend, infinite) == CHRONORMAL_USAGE);
  chronormal_blend_destroy(blend);
  return 0;
}

/* Tests curved motion: a vertex moves on the parabola z = t (2 - t), which is the cubic through three keyframes. */
static int check_paths(const char* folder) {
  char names[3][512];
  const char* files[3] = {names[0], names[1], names[2]};
  for (int k = 0; k < 3; ++k) {
    snprintf(names[k], sizeof names[k], "%s/arch_%d.obj", folder, k);
    FILE* file = fopen(names[k], "w");
    EXPECT(file != NULL);
    fprintf(file, "v 0 0 0\nv 1 0 0\nv 0 1 %d\nf 1 2 3\n", k == 1 ? 1 : 0);
    EXPECT(fclose(file) == 0);
  }
  chronormal_motion* motion = NULL;
  EXPECT(chronormal_motion_read(files, 3, NULL, &motion) == CHRONORMAL_DONE);
  float normals[9];
  for (int curved = 0; curved < 2; ++curved) {
    EXPECT(chronormal_motion_follow(motion, curved ? "catmull-rom" : "linear") == CHRONORMAL_DONE);
    for (double time = 0; time <= 2; time += 0.25) {
      EXPECT(chronormal_motion_unit_normals(motion, time, (chronormal_result){normals, 0}) == CHRONORMAL_DONE);
      const double z = curved ? time * (2 - time) : 1 - fabs(time - 1), length = sqrt(1 + z * z);
      const double tolerance = curved ? 1.8e-4 : 2e-6; /* 0.01 degrees */
      EXPECT(fabs(normals[1] + z / length) < tolerance && fabs(normals[2] - 1 / length) < tolerance);
    }
  }
  chronormal_motion_destroy(motion);
  return 0;
}

static int check_motion(const char* folder) {
  char names[2][512];
  const char* files[2] = {names[0], names[1]};
  for (int k = 0; k < 2; ++k) {
    snprintf(names[k], sizeof names[k], "%s/tent_%d.obj", folder, k);
    FILE* file = fopen(names[k], "w");
    EXPECT(file != NULL);
    for (int v = 0; v < 5; ++v) fprintf(file, "v %g %g %g\n", at(v, 0, k), at(v, 1, k), at(v, 2, k));
    for (int f = 0; f < 4; ++f)
      fprintf(file, "f %u %u %u\n", kCorners[3 * f] + 1, kCorners[3 * f + 1] + 1, kCorners[3 * f + 2] + 1);
    EXPECT(fclose(file) == 0);
  }
  chronormal_motion* motion = NULL;
  EXPECT(chronormal_motion_read(files, 2, NULL, &motion) == CHRONORMAL_DONE);
  double first = -1, last = -1;
  chronormal_motion_times(motion, &first, &last);
  EXPECT(first == 0 && last == 1 && chronormal_motion_size(motion) == 5);
  float normals[15];
  EXPECT(chronormal_motion_unit_normals(motion, 0.25, (chronormal_result){normals, 0}) == CHRONORMAL_DONE);
  for (int v = 0; v < 5; ++v) {
    double n[3];
    truth(CHRONORMAL_VERTICES, v, 0.25, n);
    for (int c = 0; c < 3; ++c) EXPECT(fabs(normals[3 * v + c] - n[c]) < 2e-6);
  }
  EXPECT(chronormal_motion_unit_normals(motion, 7, (chronormal_result){normals, 0}) == CHRONORMAL_USAGE);
  EXPECT(chronormal_motion_follow(motion, "round") == CHRONORMAL_USAGE);
  EXPECT(strstr(chronormal_last_message(), "'round'") != NULL);
  EXPECT(chronormal_motion_follow(motion, "hermite") == CHRONORMAL_USAGE); /* these files have no velocities */
  EXPECT(chronormal_motion_follow(motion, NULL) == CHRONORMAL_USAGE);
  EXPECT(chronormal_motion_follow(NULL, "linear") == CHRONORMAL_USAGE);
  chronormal_motion_destroy(motion);
  if (check_paths(folder) != 0) return 1;
  files[1] = "nothing.obj";
  EXPECT(chronormal_motion_read(files, 2, NULL, &motion) == CHRONORMAL_FAILED);
  EXPECT(strstr(chronormal_last_message(), "nothing.obj") != NULL);
  EXPECT(chronormal_motion_read(files, 0, NULL, &motion) == CHRONORMAL_USAGE);
  EXPECT(strcmp(chronormal_last_message(), "file_count: there are no files; pass at least one name") == 0);
  return 0;
}

static int check_misuse(void) {
  const uint32_t beyond[3] = {0, 1, 5};
  const chronormal_mesh mesh = {5, 4, kCorners, NULL}, wrong = {5, 1, beyond, NULL};
  const chronormal_vectors from = {kFrom[0].position, sizeof(vertex)}, nothing = {NULL, 0},
                           crooked = {kFrom[0].position, 13};
  chronormal_curves* curves = NULL;
  EXPECT(chronormal_curves_create(NULL, from, from, NULL, &curves) == CHRONORMAL_USAGE);
  EXPECT(chronormal_curves_create(&mesh, from, nothing, NULL, &curves) == CHRONORMAL_USAGE);
  EXPECT(strcmp(chronormal_last_message(), "to: the pointer is NULL; pass a valid pointer") == 0);
  EXPECT(chronormal_curves_create(&mesh, from, crooked, NULL, &curves) == CHRONORMAL_USAGE);
  EXPECT(chronormal_curves_create(&wrong, from, from, NULL, &curves) == CHRONORMAL_INVALID_INPUT);
  EXPECT(strstr(chronormal_last_message(), "face 0, corner 2") != NULL);
  vertex broken[5];
  memcpy(broken, kTo, sizeof broken);
  broken[3].position[1] = NAN;
  const chronormal_vectors to = {broken[0].position, sizeof(vertex)};
  EXPECT(chronormal_curves_create(&mesh, from, to, NULL, &curves) == CHRONORMAL_INVALID_INPUT);
  EXPECT(strstr(chronormal_last_message(), "keyframe 1, vertex 3") != NULL);
  chronormal_options options;
  memset(&options, 0, sizeof options);
  EXPECT(chronormal_curves_create(&mesh, from, from, &options, &curves) == CHRONORMAL_USAGE);
  chronormal_options_init(&options);
  options.weighting = "weight";
  EXPECT(chronormal_curves_create(&mesh, from, from, &options, &curves) == CHRONORMAL_USAGE);
  EXPECT(strstr(chronormal_last_message(), "area-angle") != NULL);
  EXPECT(curves == NULL && chronormal_curves_size(NULL) == 0);
  chronormal_curves_destroy(NULL);
  return 0;
}

int main(int count, char** arguments) {
  EXPECT(count == 3 && strcmp(chronormal_version(), arguments[1]) == 0);
  EXPECT(strcmp(chronormal_last_message(), "") == 0);
  if (check_curves(CHRONORMAL_FACES, 4) || check_curves(CHRONORMAL_VERTICES, 5) || check_curves(CHRONORMAL_CORNERS, 12))
    return 1;
  return check_outputs() || check_newer_options() || check_blend() || check_motion(arguments[2]) || check_misuse();
}
