/// A query of `chronormal query`. Each has a file query_NAME.cpp with one function that describes it.
#ifndef CLI_COMMANDS_QUERY_QUESTION_H_
#define CLI_COMMANDS_QUERY_QUESTION_H_

#include <functional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/workflow/query.h"
#include "cli/options/options.h"

namespace chronormal::cli {

/// A function that answers the query for a motion, and for elements if the query supports them.
using Ask =
    std::function<Result<QueryAnswer>(const Motion&, const QuerySpan&, const QueryProgress&, const ElementOptions&)>;

struct Question {
  std::string name, summary;
  std::vector<Option> options;  ///< options of this query only
  /// Parses the options before any input is read, and returns the function. Errors: kUsage with an option as the place.
  std::function<Result<Ask>()> understand;
  bool takes_elements = false;  ///< false if the query is only about faces
};

[[nodiscard]] Question collapse_question();
[[nodiscard]] Question cones_question();
[[nodiscard]] Question contain_question();
[[nodiscard]] Question facing_question();
[[nodiscard]] Question shutter_question();

}  // namespace chronormal::cli

#endif  // CLI_COMMANDS_QUERY_QUESTION_H_
