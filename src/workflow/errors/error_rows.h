/// Fills the table of errors of an audit or a comparison. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/workflow/errors.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

/// Reserves memory for `rows` rows of a table of errors. `earlier` counts the bytes of other tables of the same result,
/// and grows by the bytes of this table. Errors: kUsage if the table takes more than kMostErrorBytes; those of
/// expansion.check() for all tables together.
[[nodiscard]] Status reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion,
                                  std::uint64_t& earlier);
[[nodiscard]] inline Status reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion) {
  std::uint64_t earlier = 0;
  return reserve_rows(table, rows, expansion, earlier);
}

/// Appends a row of NaN, and returns this row, which the caller fills. The row belongs to the moment `at`, which is a
/// weight or a time in seconds.
std::span<float> add_row(ErrorTable& table, std::size_t subject, bool is_weight, double at);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
