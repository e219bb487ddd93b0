#include "tools/ca2/print_warnings.h"

#include <cstdio>

namespace ca2 {

void print_warnings(const std::vector<Problem>& problems) {
  for (const Problem& problem : problems) {
    const Error line(ErrorCode::data, problem.where, "warning: " + problem.what, problem.hint);
    std::fprintf(stderr, "ca2: %s\n", line.text().c_str());
  }
}

}  // namespace ca2
