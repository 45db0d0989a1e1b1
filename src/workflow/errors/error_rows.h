/// How an audit or a comparison fills a table of errors. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_

#include <cstddef>
#include <span>

#include "chronormal/io/expansion.h"
#include "chronormal/workflow/errors.h"

namespace chronormal::inline internal {

/// Makes room for so many rows. Errors: kUsage where they take more than kMostErrorBytes; those of expansion.check().
[[nodiscard]] Status reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion);

/// Appends a row of NaN and returns it.
std::span<float> add_row(ErrorTable& table, std::size_t subject, bool is_weight, double at);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
