#include "workflow/bake/forms/alone_deltas.h"

#include <array>
#include <cmath>

#include "core/blocks.h"
#include "core/portable_math.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 256, kWeights = 32;
constexpr double kHarm = 0.01;  // degrees
constexpr double kPartOfTolerance = 0.9;
constexpr double kLeastLength = 2e-5;  // of the terms that a normal is made of: below, its direction means nothing
constexpr std::array<double, 8> kLengths = {0.8, 1.25, 0.6, 1.6, 0.4, 2.5, 0.2, 5};
constexpr std::array<double, 7> kParts = {0.8, 0.6, 0.4, 0.25, 0.15, 0.07, 0.03};

// Says of most normals that they are nearer than an angle, without computing theirs: |s x r| < tan(angle) s . r.
class NearerThan {
 public:
  explicit NearerThan(double degrees) {
    constexpr double kSurely = 1 - 1e-6;  // far more than what rounding changes
    const double angle = degrees / kDegreesPerRadian, tangent = portable::sin(angle) / portable::cos(angle);
    if (degrees < kWidest) square_ = kSurely * tangent * tangent;
  }
  [[nodiscard]] bool surely(const Vec3d& shown, const Vec3d& right) const {
    constexpr double kLeast = 1e-100;  // the squares of what is shorter might be 0
    const double along = dot(shown, right);
    const Vec3d across = cross(shown, right);
    return along > kLeast && dot(across, across) <= square_ * along * along;
  }

 private:
  static constexpr double kWidest = 80;
  double square_ = -1;
};

// One vertex while a target is played.
struct Course {
  Vec3d normal, linear, square;  // n(w) = normal + w linear + w^2 square
  double largest = 0;
  Vec3d base;  // as it is stored

  [[nodiscard]] bool is_harmed(const Vec3d& before, const Vec3d& after, double tolerance,
                               const NearerThan& part_of_tolerance) const {
    for (std::size_t step = 1; step <= kWeights; ++step) {
      const double w = static_cast<double>(step) / kWeights;
      const Vec3d right = normal + w * linear + (w * w) * square;
      if (!(length(right) > kLeastLength * largest)) continue;
      const auto error = [&](const Vec3d& delta) {
        const Vec3d shown = base + w * delta;
        return max_abs(shown) > 0 ? kDegreesPerRadian * angle_between(shown, right) : 180;
      };
      if (part_of_tolerance.surely(base + w * after, right)) continue;
      const double now = error(after);
      if (now > kPartOfTolerance * tolerance && now > error(before) + kHarm) return true;
    }
    return false;
  }
};

Vec3d harmless_delta(const Course& course, const Vec3d& before, const Vec3d& delta, FormLengths lengths,
                     double tolerance, const NearerThan& part_of_tolerance) {
  const auto is_harmed = [&](const Vec3d& after) {
    return course.is_harmed(before, after, tolerance, part_of_tolerance);
  };
  if (!is_harmed(delta)) return delta;
  const bool is_free = lengths == FormLengths::kFree;
  for (const double size : kLengths) {
    const Vec3d other = size * (course.base + delta) - course.base;
    if (is_free && !is_harmed(other)) return other;
  }
  for (const double part : kParts) {
    Vec3d other = (1 - part) * before + part * delta;
    if (!is_free) other = length(course.base) * unit(course.base + other) - course.base;
    if (!is_harmed(other)) return other;
  }
  return before;
}

}  // namespace

void make_harmless_alone(const DeltaSource& source, const std::vector<VertexVectors>& stored, FormLengths lengths,
                         double tolerance, std::vector<VertexVectors>& deltas) {
  const VectorView<const float> normals =
      VectorView<const float>::packed(source.base_normals.data(), source.base_normals.size() / 3);
  if (normals.count == 0) return;  // nor are there deltas
  const NearerThan part_of_tolerance(kPartOfTolerance * tolerance);
  for (std::size_t i = 0; i < deltas.size(); ++i) {
    if (!moves(source.shading, i)) continue;
    const NormalTerms::Term linear = source.terms.linear_by_element(i);
    const NormalTerms::Term square = source.terms.pair_by_element(i, i);
    VertexVectors& delta = deltas[i];
    parallel_each(delta.vertices.size(), kBlock, [&](std::size_t n) {
      const std::uint32_t v = delta.vertices[n], element = source.shading.element_of_vertex[v];
      const Vec3d of_element = source.terms.base_of(element), base = to_double(normals[v]);
      const VertexTerms turned(of_element, source.plan.largest[element], base);
      Vec3d a, c;
      (void)linear.find(element, a);
      (void)square.find(element, c);
      const Course course{turned(of_element), turned(a), turned(c),
                          length(turned(Vec3d{source.plan.largest[element], 0, 0})), base};
      Vec3f& vector = delta.vectors[n];
      vector = to_float(
          harmless_delta(course, to_double(stored[i].at(v)), to_double(vector), lengths, tolerance, part_of_tolerance));
    });
  }
}

}  // namespace chronormal::inline internal
