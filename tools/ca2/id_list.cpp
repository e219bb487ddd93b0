#include "tools/ca2/id_list.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace ca2 {
namespace {

bool parse_id(std::string_view text, int& id) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  return error == std::errc() && end == text.data() + text.size() && id >= 0;
}

}  // namespace

Result<std::vector<int>> parse_id_list(const std::string& text) {
  std::vector<int> ids;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    int first = 0;
    int last = 0;
    const bool good = dash == std::string::npos ? parse_id(part, first) && parse_id(part, last)
                                                : parse_id(std::string_view(part).substr(0, dash), first) &&
                                                      parse_id(std::string_view(part).substr(dash + 1), last);
    if (!good || last < first || last - first > 1000000) {
      return fail(ErrorCode::usage, "--views", "cannot read '" + part + "'",
                  "write numbers and ranges like 1,4,7-9");
    }
    for (int id = first; id <= last; ++id) ids.push_back(id);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace ca2
