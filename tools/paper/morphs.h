/// The meshes of docs/paper.md, and what several of its sections measure on them.
#ifndef PAPER_MORPHS_H_
#define PAPER_MORPHS_H_

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/chronormal_io.h"
#include "support/numbers.h"

namespace chronormal::paper {

using namespace pages;

inline constexpr double kPi = 3.14159265358979323846;

struct Morph {
  std::string name;
  Motion motion;
};

/// cloth, bend, twist, eversion: from mild to dramatic, as the columns of every table.
[[nodiscard]] const std::vector<Morph>& morphs();
/// Those and soup, by name.
[[nodiscard]] const Motion& morph(std::string_view name);

/// A motion of some of the faces, drawn at random, the same on every call. All of them where there are not more.
[[nodiscard]] Motion some_faces(const Motion& motion, std::size_t count);
/// The faces of a motion so that (face, segment) pairs are about `pairs`.
[[nodiscard]] Motion some_pairs(const Motion& motion, std::size_t pairs);

/// Angle between unit vectors, in degrees.
[[nodiscard]] double degrees_between(const Vec3d& a, const Vec3d& b);

/// Exact unit normals of all (segment, face) pairs at N equidistant t, from positions (analysis/quality.h),
/// and any scheme held against them, pair by pair. A sample without a direction counts as no error.
class PairErrors {
 public:
  PairErrors(const Motion& motion, std::size_t samples);

  [[nodiscard]] std::size_t pairs() const { return pairs_; }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  /// The angles of a scheme, degrees, summed over samples; one value per pair. Threads: const functions may run at
  /// once.
  [[nodiscard]] std::vector<double> sums(std::string_view scheme) const;
  /// The largest angle of each pair, in degrees.
  [[nodiscard]] std::vector<double> largest(std::string_view scheme) const;

 private:
  template <class Combine>
  std::vector<double> combined(std::string_view scheme, Combine combine) const;

  const Motion* motion_;
  std::size_t samples_, faces_, pairs_;
  std::vector<std::vector<ControlNormals>> control_normals_;  // per segment
  std::vector<std::vector<Vec3d>> exact_;                     // per segment and sample
};

/// A scheme prepared on some elements, with what it needs to stay alive. The segment is not owned.
class PreparedScheme {
 public:
  PreparedScheme(std::string_view name, const Segment& segment, IndexRange faces);
  [[nodiscard]] const Scheme& operator*() const { return *scheme_; }
  [[nodiscard]] const Scheme* operator->() const { return scheme_.get(); }
  /// The unit normals at t, as doubles.
  [[nodiscard]] std::vector<Vec3d> at(double t) const;

 private:
  Segment segment_;
  std::size_t count_;
  std::vector<ControlNormals> control_normals_;
  std::unique_ptr<Scheme> scheme_;
};

}  // namespace chronormal::paper

#endif  // PAPER_MORPHS_H_
