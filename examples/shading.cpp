// Draws wrong and right shading of a morph side by side: writes shading.png and shading_flat.png, or the paths given.
//
// A square column is halfway through a twist. All panels have the same geometry and the same light, but different
// normals:
//
//     left    what engines show: the two end normals, interpolated and normalised
//     middle  exact: n(t) from three control normals
//     right   the angle between the two, in degrees
//
// The first picture is smooth (a normal per vertex), the second flat (a normal per face). |n(t)| is twice the area, so
// the area-weighted normal of a vertex is the sum of the n(t) of its faces. The sum is a quadratic too, and exact at
// every t.

#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "chronormal/chronormal_io.h"

namespace {

using namespace chronormal;

constexpr double kTime = 0.5;  // t between the keyframes
// The width of one panel, the width of three panels with the legend, and the height, in pixels.
constexpr int kPanel = 380, kWidth = 1200, kHeight = 480;
constexpr int kSub = 3;               // samples per pixel in each direction
constexpr double kScale = 132;        // pixels per unit of length
constexpr double kLargestAngle = 40;  // degrees at the end of the colour scale
constexpr Vec3d kBackground{0.94, 0.945, 0.955};

/// The unit normals of all elements at kTime.
struct Normals {
  std::vector<Vec3d> exact, linear;

  explicit Normals(const std::vector<ControlNormals>& elements) {
    std::vector<float> packed(3 * elements.size());
    const auto view = VectorView<float>::packed(packed.data(), elements.size());
    (void)NormalCurves(elements).unit_normals(kTime, view);
    for (std::size_t i = 0; i < elements.size(); ++i) {
      exact.push_back(to_double(view[i]));
      linear.push_back(unit(lerp(unit(elements[i].n0), unit(elements[i].n1), kTime)));
    }
  }
};

/// The first point that the ray through a sample meets: a face, and the place in the face.
struct Hit {
  std::size_t face = 0;
  std::array<double, 3> weights{};
  double depth = -1e30;  // coordinate towards the eye; -1e30 if the ray meets no face
  bool front = true;     // false for the inside of the column, whose normals point away from the eye
};

/// The directions towards the camera, to its right and upwards. The camera is at infinity, so all rays are parallel.
const Vec3d kEye = unit(Vec3d{0.55, -1, 0.24}), kRight = unit(cross(Vec3d{0, 0, 1}, kEye)), kUp = cross(kEye, kRight);
constexpr Vec3d kMiddle{0, 0, 1.5};  // the point at which the camera looks

/// Finds the visible face for each sample of a panel, with a z-buffer. The whole column must be in the picture.
std::vector<Hit> rasterise(const Segment& segment) {
  constexpr std::size_t kColumns = std::size_t{kPanel} * kSub, kRows = std::size_t{kHeight} * kSub;
  std::vector<Hit> hits(kColumns * kRows);
  for (std::size_t f = 0; f < segment.topology->face_count(); ++f) {
    // The corners are measured in samples: x to the right, y down, z towards the eye.
    std::array<Vec3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = segment.topology->face(f)[k];
      const Vec3d q = lerp(to_double(segment.from[v]), to_double(segment.to[v]), kTime) - kMiddle;
      p[k] = {kSub * (kPanel / 2.0 + kScale * dot(q, kRight)), kSub * (kHeight / 2.0 - kScale * dot(q, kUp)),
              dot(q, kEye)};
    }
    const auto area = [&p](std::size_t a, std::size_t b, double x, double y) {
      return (p[b].x - p[a].x) * (y - p[a].y) - (p[b].y - p[a].y) * (x - p[a].x);
    };
    const double whole = area(0, 1, p[2].x, p[2].y);
    if (whole == 0) continue;
    const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
    for (int row = static_cast<int>(top); row <= static_cast<int>(bottom); ++row) {
      for (int col = static_cast<int>(left); col <= static_cast<int>(right); ++col) {
        const double x = col + 0.5, y = row + 0.5;
        const std::array<double, 3> w{area(1, 2, x, y) / whole, area(2, 0, x, y) / whole, area(0, 1, x, y) / whole};
        const double depth = w[0] * p[0].z + w[1] * p[1].z + w[2] * p[2].z;
        Hit& hit = hits[static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(col)];
        if (std::min({w[0], w[1], w[2]}) >= 0 && depth > hit.depth) hit = {f, w, depth, whole < 0};
      }
    }
  }
  return hits;
}

/// Returns the colour of glossy paint in a studio. The light comes from the sky, a lamp, and upright tubes that the
/// paint reflects.
Vec3d paint(const Vec3d& normal) {
  const Vec3d lamp = unit(0.8 * kEye + 0.9 * kUp - 0.9 * kRight);
  const Vec3d mirrored = (2 * dot(normal, kEye)) * normal - kEye;
  const double diffuse = 0.22 + 0.18 * normal.z + 0.8 * std::max(0.0, dot(normal, lamp));
  const double azimuth = std::atan2(dot(mirrored, kRight), dot(mirrored, kEye));
  const double tubes = 0.5 + 0.5 * std::tanh(6 * (std::cos(5 * azimuth) - 0.55));
  // This is Schlick's approximation of the reflectance.
  const double mirror = 0.05 + 0.95 * std::pow(1 - std::max(0.0, dot(normal, kEye)), 5);
  const double gloss = 0.5 * std::pow(std::max(0.0, dot(mirrored, lamp)), 40) + (0.42 + mirror) * tubes;
  return diffuse * Vec3d{0.02, 0.20, 0.40} + gloss * Vec3d{1, 0.98, 0.95};
}

/// Returns a colour for an angle: from pale for 0 through yellow and red to black for a large error.
Vec3d colour_of(double degrees) {
  constexpr std::array<Vec3d, 5> kColours{
      {{0.80, 0.82, 0.84}, {0.95, 0.72, 0.25}, {0.85, 0.25, 0.08}, {0.40, 0.02, 0.10}, {0.05, 0.0, 0.06}}};
  const double s = std::clamp(degrees / kLargestAngle, 0.0, 0.9999) * (kColours.size() - 1);
  const std::size_t i = static_cast<std::size_t>(s);
  return lerp(kColours[i], kColours[i + 1], s - static_cast<double>(i));
}

/// Returns a pixel of the legend, which has the colour scale with 0, 10, ... 40 degrees beside it.
Vec3d legend(int x, int y) {
  // The glyphs of the digits 0 to 4, the degree sign and a blank. Each is three by five pixels, with one octal digit
  // for each row.
  constexpr std::array<int, 7> kFont{075557, 026227, 071747, 071717, 055711, 075700, 0};
  constexpr int kTop = 130, kStep = 55, kZoom = 2;  // 10 degrees take kStep pixels
  if (x < 12 && y >= kTop && y < kTop + 4 * kStep) return colour_of(kLargestAngle * (1 - (y - kTop) / (4.0 * kStep)));
  const int line = y - kTop + 5, label = 4 - line / kStep, row = line % kStep / kZoom, column = (x - 18) / kZoom;
  if (x < 18 || line < 0 || label < 0 || row >= 5 || column >= 12 || column % 4 == 3) return kBackground;
  const std::array<int, 3> text = label > 0 ? std::array{label, 0, 5} : std::array{0, 5, 6};
  const int bits = kFont[static_cast<std::size_t>(text[static_cast<std::size_t>(column / 4)])];
  return bits >> (3 * (4 - row) + 2 - column % 4) & 1 ? Vec3d{0.1, 0.1, 0.1} : kBackground;
}

/// Returns three panels and the legend as RGB bytes. The samples of a pixel are averaged before the gamma is applied.
std::vector<png_byte> draw(const std::vector<Hit>& hits, const Topology& mesh, const Normals& normals, bool smooth) {
  std::vector<png_byte> bytes;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int panel = x / kPanel;  // 0: linear, 1: exact, 2: angle, 3: legend
      Vec3d sum;
      for (int s = 0; s < kSub * kSub; ++s) {
        const int sample = (y * kSub + s / kSub) * kPanel * kSub + x % kPanel * kSub + s % kSub;
        const Hit& hit = hits[static_cast<std::size_t>(sample)];
        const auto interpolate = [&](const std::vector<Vec3d>& of) {
          Vec3d n;
          for (std::size_t k = 0; k < 3; ++k) n = n + hit.weights[k] * of[smooth ? mesh.face(hit.face)[k] : hit.face];
          return (hit.front ? 1.0 : -1.0) * unit(n);
        };
        const Vec3d exact = interpolate(normals.exact), linear = interpolate(normals.linear);
        sum = sum + (panel == 3           ? legend(x % kPanel, y)
                     : hit.depth == -1e30 ? kBackground
                     : panel == 2         ? colour_of(kDegreesPerRadian * angle_between(exact, linear))
                                          : paint(panel == 0 ? linear : exact));
      }
      for (const double c : {sum.x, sum.y, sum.z})
        bytes.push_back(static_cast<png_byte>(255.5 * std::pow(std::min(c / (kSub * kSub), 1.0), 1 / 2.2)));
    }
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const Motion motion = make_builtin_morph("twist").value();
  const Segment segment = motion.segment(0);
  const Topology& topology = motion.topology;

  // Compute the control normals of faces and their sums for vertices. For comparison, compute the true normals from
  // positions alone.
  const IndexRange all{0, topology.face_count()};
  std::vector<ControlNormals> faces(all.count), vertices(topology.vertex_count());
  std::vector<Vec3d> true_faces(all.count), true_vertices(topology.vertex_count());
  face_control_normals(segment, all, faces);
  reference_normals(segment, all, kTime, true_faces);
  for (std::size_t f = 0; f < all.count; ++f) {
    for (const std::uint32_t v : topology.face(f)) vertices[v] = vertices[v] + faces[f];
    for (const std::uint32_t v : topology.face(f)) true_vertices[v] = true_vertices[v] + true_faces[f];
  }

  const std::vector<Hit> hits = rasterise(segment);
  bool holds = true;
  std::printf("largest error at t = %.1f     linear     exact\n                              deg       rad\n", kTime);
  for (const bool smooth : {true, false}) {
    const Normals normals(smooth ? vertices : faces);
    const std::vector<Vec3d>& truth = smooth ? true_vertices : true_faces;
    double linear = 0, exact = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      linear = std::max(linear, kDegreesPerRadian * angle_between(normals.linear[i], truth[i]));
      exact = std::max(exact, angle_between(normals.exact[i], truth[i]));
    }
    std::printf("%-22s  %9.2f  %8.1e\n", smooth ? "smooth: vertex normals" : "flat: face normals", linear, exact);
    holds = holds && linear > 10 && exact < 1e-5;

    const char* path = smooth ? (argc > 1 ? argv[1] : "shading.png") : (argc > 2 ? argv[2] : "shading_flat.png");
    png_image image{};
    image.version = PNG_IMAGE_VERSION, image.format = PNG_FORMAT_RGB, image.width = kWidth, image.height = kHeight;
    const std::vector<png_byte> bytes = draw(hits, topology, normals, smooth);
    if (!png_image_write_to_file(&image, path, 0, bytes.data(), 0, nullptr)) {
      std::fprintf(stderr, "shading: %s: %s\n", path, image.message);
      return 1;
    }
  }
  if (!holds) std::fprintf(stderr, "shading: exact normals should have been right, and only they\n");
  return holds ? 0 : 1;
}
