/// The sections of docs/weightings.md, a file each. Each measures what its section of weightings.md.in has places for.
#ifndef WEIGHTINGS_SECTIONS_H_
#define WEIGHTINGS_SECTIONS_H_

#include <filesystem>
#include <string>

#include "chronormal/chronormal_io.h"
#include "support/numbers.h"
#include "support/page.h"

namespace chronormal::weightings {

using namespace pages;

/// Our weightings beside those of other libraries: the part of the page, empty where they are not built.
[[nodiscard]] std::string peers_part(const std::string& folder);
/// Normals in files: the part of the page, empty where there is no data.
[[nodiscard]] std::string golden_part(const std::string& folder, const std::filesystem::path& data);
void measure_fits(Page& page);        ///< quadratics in place of weighted normals: error, bound, cost
void measure_transforms(Page& page);  ///< rigid and affine motion

/// A motion of one mesh that stands still: the positions of a segment at t, as float32.
[[nodiscard]] Motion posed(const Motion& motion, std::size_t segment, double t);

/// 0 below 1e-9, and so many decimals where powers of ten take over.
[[nodiscard]] std::string degrees(double value, int decimals = 0);

}  // namespace chronormal::weightings

#endif  // WEIGHTINGS_SECTIONS_H_
