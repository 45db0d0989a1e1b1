// The schemes quaternion:matrix (the paper's), quaternion:edge, quaternion:polar and quaternion:random. They construct
// a frame of the face at each end, and interpolate the frames by quaternion slerp, which gives the normal (section 2.5
// of the paper). quaternion_optimal.cpp has the scheme that searches for frames.
//
// Quaternion slerp on the shorter arc is a rotation about a fixed axis at constant speed, so its result is stored as an
// arc (arc.h). If the frames cannot be constructed, slerp of the normals takes their place and counts as a fallback.

#include "schemes/frames.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

template <class MakeFrames>
struct Quaternion : UniformArc {
  explicit Quaternion(MakeFrames make) : make_frames(std::move(make)) {}

  void fit(ElementMotion& element, double* c) const {
    if (const auto frames = make_frames(element)) {
      put_arc(c, shorter_arc(*frames));
    } else {
      element.use_fallback();
      put_arc(c, CircleFamily(element.start().vector, element.end().vector).great_arc());
    }
  }

  MakeFrames make_frames;
  bool needs_faces = true;
};

template <class MakeFrames>
std::unique_ptr<Scheme> make_quaternion(MakeFrames make_frames) {
  return std::make_unique<CurveScheme<Quaternion<MakeFrames>>>(Quaternion<MakeFrames>(std::move(make_frames)));
}

}  // namespace

std::unique_ptr<Scheme> make_quaternion_matrix() { return make_quaternion(matrix_frames); }
std::unique_ptr<Scheme> make_quaternion_edge() { return make_quaternion(edge_frames); }
std::unique_ptr<Scheme> make_quaternion_polar() { return make_quaternion(polar_frames); }
std::unique_ptr<Scheme> make_quaternion_random(std::uint64_t seed) {
  return make_quaternion([seed](const ElementMotion& element) { return random_frames(element, seed); });
}

}  // namespace chronormal::inline internal
