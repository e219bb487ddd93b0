#include "core/types/result.h"

namespace ca2 {

std::string Error::text() const {
  std::string text;
  for (const Problem& problem : problems) {
    if (!text.empty()) text += '\n';
    if (!problem.where.empty()) text += problem.where + ": ";
    text += problem.what;
    if (!problem.hint.empty()) text += "; " + problem.hint;
  }
  return text;
}

}  // namespace ca2
