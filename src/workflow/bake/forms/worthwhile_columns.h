/// Which deltas of a form are worth their bytes. Private to workflow.
///
/// A form is made of columns: deltas of many vertices that one weight drives, be it that of a target of the mesh or of
/// an extra one. Each slot (a target of the mesh with its own corrections, or a pair of targets) is filled with one of
/// its options, from the cheapest to the fullest one. All of these together are a selection, and wanted is the one of
/// fewest bytes that is near enough at all poses:
///
///     few selections    all of them, by their bytes: the first that is near enough is the cheapest
///     many              from the fullest one on, slot by slot, those first whose lack turns least, for as long as the time
///                       allows; what cannot be spared stays
///
/// Units      degrees; poses have weights of the mesh's own targets first, others are not looked at.
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_COLUMNS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_COLUMNS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/workflow/hosts.h"
#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/write/tracks.h"

namespace chronormal::inline internal {

/// The deltas of a form as a host keeps them beside the stored normals, whatever the lengths of these. The result is
/// the form itself where that makes no difference.
[[nodiscard]] VertexColumns kept_columns(const Host& host, const RightNormals& rights,
                                         std::span<const std::uint32_t> vertices, const VertexColumns& form);

/// Deltas and what drives them: the weight of a target of the mesh is linear 1, quadratic 0 of that target.
struct Column {
  VertexVectors deltas;
  ExtraWeight weight;
  bool is_stored = false;  ///< what the file has, which hosts may keep in different ways
};

struct Option {
  std::vector<std::size_t> columns;
  std::size_t bytes = 0;
};
/// Options from the cheapest to the fullest one.
using Slot = std::vector<Option>;
/// The number of an option for each slot.
using Selection = std::vector<std::size_t>;

/// A pose, and what is asked of it.
struct AskedPose {
  std::vector<double> weights;
  bool must_be_near =
      false;  ///< within the tolerance where normals are longer than a thousandth of that of the base; else, and
              ///< in other poses, within it or no worse than what is stored
};

struct Worthwhile {
  std::vector<Column> columns;
  std::vector<Slot> slots;
};

/// Finds cheap selections that are near enough, the fullest one at last, and calls take(selection) for one after the
/// other, by their bytes, until that returns nothing; it returns the bytes of what came of a selection. A vertex that
/// is off by more than the tolerance with all columns need not be nearer without some of them. Where nothing took
/// most_bytes or fewer, options with the least in them for their bytes are left out until something does. Cost: for
/// each selection the sums of all columns at all poses
void find_worthwhile(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                     std::span<const std::uint32_t> element_of_vertex, const Worthwhile& offered,
                     std::span<const AskedPose> poses, std::span<const Host> hosts, double tolerance,
                     std::size_t most_bytes, const std::function<std::optional<std::size_t>(const Selection&)>& take);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_WORTHWHILE_COLUMNS_H_
