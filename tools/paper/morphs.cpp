// Samples of faces are drawn with a generator of fixed seed, so that every run measures the same ones.
#include "paper/morphs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace chronormal::paper {

const std::vector<Morph>& morphs() {
  static const std::vector<Morph> all = [] {
    std::vector<Morph> made;
    for (const char* name : {"cloth", "bend", "twist", "eversion"})
      made.push_back({name, make_builtin_morph(name).value()});
    return made;
  }();
  return all;
}

const Motion& morph(std::string_view name) {
  static const Motion soup = make_builtin_morph("soup").value();
  for (const Morph& m : morphs()) {
    if (m.name == name) return m.motion;
  }
  return soup;
}

Motion some_faces(const Motion& motion, std::size_t count) {
  const std::size_t faces = motion.topology.face_count();
  if (count >= faces) return motion;
  // The first steps of a shuffle by hand: the standard one differs between libraries.
  std::vector<std::size_t> order(faces);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::mt19937_64 random(7);
  for (std::size_t i = 0; i < count; ++i) std::swap(order[i], order[i + random() % (faces - i)]);
  order.resize(count);
  std::sort(order.begin(), order.end());

  std::vector<std::uint32_t> corners;
  for (const std::size_t face : order) {
    const auto corners_of_face = motion.topology.face(face);
    corners.insert(corners.end(), corners_of_face.begin(), corners_of_face.end());
  }
  Motion part{Topology::triangles(motion.topology.vertex_count(), std::move(corners)).value(), motion.keyframes, {}};
  part.connect_as_sequence();
  return part;
}

Motion some_pairs(const Motion& motion, std::size_t pairs) {
  return some_faces(motion, pairs / motion.segments.size());
}

// As angle_between(), without its care for lengths that overflow: this is asked for millions of pairs of unit vectors.
double degrees_between(const Vec3d& a, const Vec3d& b) {
  const Vec3d c = cross(a, b);
  return kDegreesPerRadian * std::atan2(std::sqrt(dot(c, c)), dot(a, b));
}

PairErrors::PairErrors(const Motion& motion, std::size_t samples)
    : motion_(&motion),
      samples_(samples),
      faces_(motion.topology.face_count()),
      pairs_(faces_ * motion.segments.size()) {
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const Segment segment = motion.segment(s);
    control_normals_.push_back(all_face_control_normals(segment));
    for (std::size_t i = 0; i < samples; ++i) {
      std::vector<Vec3d> exact(faces_);
      reference_normals(segment, {0, faces_}, static_cast<double>(i) / static_cast<double>(samples - 1), exact);
      for (Vec3d& normal : exact) normal = unit(normal);
      exact_.push_back(std::move(exact));
    }
  }
}

template <class Combine>
std::vector<double> PairErrors::combined(std::string_view scheme_name, Combine combine) const {
  std::vector<double> result;
  result.reserve(pairs_);
  std::vector<float> packed(3 * faces_);
  const auto view = VectorView<float>::packed(packed.data(), faces_);
  for (std::size_t s = 0; s < motion_->segments.size(); ++s) {
    const Segment segment = motion_->segment(s);
    const auto scheme = make_scheme(scheme_name).value();
    scheme->prepare({&segment, {0, faces_}, control_normals_[s]});
    std::vector<double> values(faces_, 0);
    for (std::size_t i = 0; i < samples_; ++i) {
      scheme->evaluate(static_cast<double>(i) / static_cast<double>(samples_ - 1), view);
      const std::vector<Vec3d>& exact = exact_[s * samples_ + i];
      for (std::size_t f = 0; f < faces_; ++f)
        values[f] = combine(values[f], degrees_between(exact[f], to_double(view[f])));
    }
    result.insert(result.end(), values.begin(), values.end());
  }
  return result;
}

std::vector<double> PairErrors::sums(std::string_view scheme) const {
  return combined(scheme, [](double a, double b) { return a + b; });
}

std::vector<double> PairErrors::largest(std::string_view scheme) const {
  return combined(scheme, [](double a, double b) { return std::max(a, b); });
}

PreparedScheme::PreparedScheme(std::string_view name, const Segment& segment, IndexRange faces)
    : segment_(segment), count_(faces.count), control_normals_(faces.count), scheme_(make_scheme(name).value()) {
  face_control_normals(segment_, faces, control_normals_);
  scheme_->prepare({&segment_, faces, control_normals_});
}

std::vector<Vec3d> PreparedScheme::at(double t) const {
  std::vector<float> packed(3 * count_);
  const auto view = VectorView<float>::packed(packed.data(), count_);
  scheme_->evaluate(t, view);
  std::vector<Vec3d> normals;
  for (std::size_t i = 0; i < count_; ++i) normals.push_back(to_double(view[i]));
  return normals;
}

}  // namespace chronormal::paper
