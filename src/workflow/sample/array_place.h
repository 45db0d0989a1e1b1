/// Where the rows of a .npy file belong that a shard of `sample` wrote: a comment in the header of the array, which
/// NumPy passes over.
///
///     {'descr': '<f4', 'fortran_order': False, 'shape': (5, 8, 3), } # rows from 10 of 40, samples 1a2b3c4d
///
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_ARRAY_PLACE_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_ARRAY_PLACE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "chronormal/motion/topology.h"
#include "chronormal/workflow/sample.h"

namespace chronormal::inline internal {

struct ArrayPlace {
  std::uint64_t first = 0;    ///< the number of the first row among all
  std::uint64_t total = 0;    ///< how many rows there are in all
  std::uint32_t samples = 0;  ///< a checksum of what was asked for: parts with different ones do not belong together

  [[nodiscard]] std::string text() const;
  /// Reads such a text; nothing where it is another one.
  [[nodiscard]] static std::optional<ArrayPlace> read(std::string_view text);
};

/// The checksum of the moments, of what is computed at them, and of the faces of the mesh.
[[nodiscard]] std::uint32_t checksum_of(const Topology& topology, const SampleOptions& options, const Moments& moments);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_ARRAY_PLACE_H_
