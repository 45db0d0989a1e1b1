/// The sections of docs/paper.md, a file each. Each measures what its section of paper.md.in has places for.
#ifndef PAPER_SECTIONS_H_
#define PAPER_SECTIONS_H_

#include "support/page.h"

namespace chronormal::paper {

using namespace pages;

void measure_table1(Page& page);   ///< the quality of the paper's schemes, and of ours
void measure_table2(Page& page);   ///< what they cost; the only section with times in it
void measure_drift(Page& page);    ///< sequential access
void measure_figure2(Page& page);  ///< lengths and oscillation
void measure_frames(Page& page);   ///< random frames, and the best ones
void measure_slips(Page& page);    ///< the paper's and ours
void draw_sketches(Page& page);    ///< the paper's Figures 1 and 3, from a face of ours

}  // namespace chronormal::paper

#endif  // PAPER_SECTIONS_H_
