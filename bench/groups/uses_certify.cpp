// Measures how long certificates of the largest error over a segment take. For comparison, also measures common
// practice, which evaluates the scheme at 64 moments, compares each normal with the exact normal, and hopes that no
// error between these moments is larger.

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <vector>

#include "chronormal/analysis/certify.h"
#include "chronormal/analysis/quality.h"
#include "chronormal/normals/normal_groups.h"
#include "groups/groups.h"

namespace chronormal::bench {
namespace {

constexpr std::size_t kSamples = 64, kBlock = 1024;

struct Certified {
  std::unique_ptr<Scheme> scheme;
  std::vector<ErrorBounds> bounds;
  std::vector<float> shown;  // normals of the scheme at kTime
};

// Returns for each face the largest angle, over kSamples values of t, between the normal of the scheme and the exact
// normal, in radians. The upper bound of a certificate must be at least as large.
std::vector<double> sampled(const Scheme& scheme, const Segment& segment, std::size_t count) {
  std::vector<double> worst(count);
  std::vector<float> shown(3 * count);
  std::vector<Vec3d> exact(std::min(kBlock, count));
  const auto result = VectorView<float>::packed(shown.data(), count);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double t = static_cast<double>(i) / (kSamples - 1);
    scheme.evaluate(t, result);
    for (std::size_t first = 0; first < count; first += kBlock) {
      const IndexRange faces{first, std::min(kBlock, count - first)};
      reference_normals(segment, faces, t, std::span(exact).first(faces.count));
      for (std::size_t f = 0; f < faces.count; ++f)
        worst[first + f] = std::max(worst[first + f], angle_between(to_double(result[first + f]), exact[f]));
    }
  }
  return worst;
}

}  // namespace

void run_certificates(Suite& suite, const Size& size) {
  const std::string group = "certificates";
  CaseList list(suite, group, size);
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Segment segment = mesh.segment();
  const Oracle oracle(segment, Elements::kFaces);
  const std::size_t count = mesh.count(Elements::kFaces);
  const std::vector<ControlNormals> normals = all_face_control_normals(segment);
  const ElementBlock block{&segment, {0, count}, normals};
  for (const char* const name : {"linear", "quadratic", "cubic", "slerp", "circle:timed", "polynomial"}) {
    if (!list.wants(std::string(name)) && !list.wants(std::string(name) + ", 64 samples")) continue;
    const auto certified = std::make_shared<Certified>();
    certified->scheme = make_scheme(name).value();
    certified->scheme->prepare(block);
    certified->bounds.resize(count);
    certify(*certified->scheme, block, certified->bounds);
    const std::vector<double> worst = sampled(*certified->scheme, segment, count);
    double limit = 0;
    for (std::size_t f = 0; f < count; ++f) {
      limit = std::max(limit, certified->bounds[f].upper);
      if (worst[f] > certified->bounds[f].upper + 1e-12)
        throw std::runtime_error(std::string(name) + ": a sample of face " + std::to_string(f) + " is above its bound");
    }
    certified->shown.resize(3 * count);
    (void)certified->scheme->evaluate(double{kTime}, VectorView<float>::packed(certified->shown.data(), count));
    list.add(name, [&] {
      Case one;
      one.note = "bounds of the largest error over all t";
      one.run = [certified, block] { certify(*certified->scheme, block, certified->bounds); };
      one.checks = {packed_check(double{kTime}, certified->shown.data())};
      one.limit = limit;
      return one;
    });
    list.add(std::string(name) + ", 64 samples", [&] {
      Case one;
      one.library = "dense sampling";
      one.note = "the largest error at 64 t, which bounds nothing";
      one.run = [certified, &segment, count] { (void)sampled(*certified->scheme, segment, count); };
      one.checks = {packed_check(double{kTime}, certified->shown.data())};
      one.limit = limit;
      return one;
    });
  }
  suite.run(group, size, count, oracle, list.take());
}

}  // namespace chronormal::bench
