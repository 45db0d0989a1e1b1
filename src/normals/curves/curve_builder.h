/// Makes NormalCurves: control normals, sixteen at a time, into blocks of the fewest bytes.
///
///     source --tiles--> how precise each must be --> runs of blocks of one kind --> packed, one after the other
///
/// Elements go by chunks of 32 tiles, which stay in cache from the first step to the last. Parts of 16 to
/// 128 chunks may be made by several threads at once; where they end does not depend on the threads, and so neither do
/// the bits.
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_

#include <span>

#include "chronormal/normals/normal_curves.h"

namespace chronormal {

class CurveBuilder {
 public:
  [[nodiscard]] static NormalCurves of_control_normals(std::span<const ControlNormals> normals,
                                                       const CurveOptions& options);
  [[nodiscard]] static NormalCurves of_faces(const Segment& segment, const CurveOptions& options, Threads threads,
                                             NormalCurves* reuse);
  [[nodiscard]] static NormalCurves of_groups(const Segment& segment, const NormalGroups& groups,
                                              const CurveOptions& options, Threads threads, NormalCurves* reuse);

 private:
  template <class MakeSource>
  static NormalCurves build(std::size_t size, const CurveOptions& options, Threads threads, NormalCurves* reuse,
                            MakeSource make_source);

  // Builds from a copy of the segment in which both positions of a vertex lie side by side.
  template <class Build>
  static NormalCurves from_both_ends(const Segment& segment, Threads threads, NormalCurves* reuse, Build build);

  struct Part;
  class PartBuilder;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_BUILDER_H_
