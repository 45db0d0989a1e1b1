/// The sections of docs/paper.md, a file each.
#ifndef PAPER_SECTIONS_H_
#define PAPER_SECTIONS_H_

#include "support/page.h"

namespace chronormal::paper {

using namespace pages;

void write_table1(Page& page);   ///< the quality of the paper's schemes, and of ours
void write_table2(Page& page);   ///< what they cost; the only section with times in it
void write_drift(Page& page);    ///< sequential access
void write_figure2(Page& page);  ///< lengths and oscillation
void write_frames(Page& page);   ///< random frames, and the best ones
void write_slips(Page& page);    ///< the paper's and ours

}  // namespace chronormal::paper

#endif  // PAPER_SECTIONS_H_
