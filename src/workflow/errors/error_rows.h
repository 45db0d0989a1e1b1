/// How an audit or a comparison fills a table of errors. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/workflow/errors.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

/// Makes room for so many rows. `earlier` are the bytes of other tables of the same result, and get those of this one, too.
/// Errors: kUsage where the table takes more than kMostErrorBytes; those of expansion.check() of all tables together.
[[nodiscard]] Status reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion,
                                  std::uint64_t& earlier);
[[nodiscard]] inline Status reserve_rows(ErrorTable& table, std::size_t rows, const Expansion& expansion) {
  std::uint64_t earlier = 0;
  return reserve_rows(table, rows, expansion, earlier);
}

/// Appends a row of NaN and returns it.
std::span<float> add_row(ErrorTable& table, std::size_t subject, bool is_weight, double at);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_ERROR_ROWS_H_
