#include "io/mesh/far_origin.h"

#include "io/bytes/scan.h"

namespace chronormal::inline internal {

std::string note_of_lost_digits(std::span<const float> positions) {
  // The largest allowed step between neighbouring float32 numbers, as a fraction of the extent of the mesh. If the step
  // is larger, the user gets a note.
  constexpr double kMuch = 1e-4;
  double extent = 0, step = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = positions[axis], high = low;
    for (std::size_t i = axis; i < positions.size(); i += 3) {
      low = std::min(low, positions[i]);
      high = std::max(high, positions[i]);
    }
    extent = std::max(extent, double{high} - double{low});
    const float farthest = std::max(std::fabs(low), std::fabs(high));
    step = std::max(step, double{farthest} - double{std::nextafter(farthest, 0.0F)});
  }
  if (!(step > kMuch * extent)) return "";
  std::string text = "the mesh is so far from the origin that float32 positions move in steps of ";
  scan::append_number(text, static_cast<float>(step));
  text += ", while the mesh has a size of ";
  scan::append_number(text, static_cast<float>(extent));
  return text + "; normals follow the rounded positions, so move the mesh to the origin before you export it";
}

std::string origin_text(const Origin& origin) {
  std::string text;
  for (const double coordinate : origin) {
    text += text.empty() ? "(" : ", ";
    scan::append_number(text, coordinate);
  }
  return text + ")";
}

}  // namespace chronormal::inline internal
