/// The sections of docs/weightings.md, a file each.
#ifndef WEIGHTINGS_SECTIONS_H_
#define WEIGHTINGS_SECTIONS_H_

#include <filesystem>

#include "chronormal/chronormal.h"
#include "support/page.h"
#include "support/statistics.h"

namespace chronormal::weightings {

using namespace pages;

void write_rules(Page& page);  ///< our weightings, and those of other libraries where they are built
void write_files(Page& page, const std::filesystem::path& data);  ///< normals in files; no data: none are measured
void write_fits(Page& page);        ///< quadratics in place of weighted normals: error, bound, cost
void write_curves(Page& page);      ///< curved motion: exact, and cut into straight pieces
void write_transforms(Page& page);  ///< rigid and affine motion

/// A motion of one mesh that stands still: the positions of a segment at t, as float32.
[[nodiscard]] Motion posed(const Motion& motion, std::size_t segment, double t);

/// Begins and ends a part that a test compares only where it can be measured; the word is the reason.
void begin_block(Page& page, std::string_view name);
void end_block(Page& page, std::string_view name);

}  // namespace chronormal::weightings

#endif  // WEIGHTINGS_SECTIONS_H_
