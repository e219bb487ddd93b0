#include "tools/ca2/number_in.h"

#include "core/types/text.h"

namespace ca2 {

CLI::Validator number_in(double least, double most) {
  const std::string range = formatted("%.9g to %.9g", least, most);
  const auto check = [=](const std::string& text) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
    return good ? std::string() : "'" + text + "' is not a number from " + range;
  };
  return {check, range};
}

CLI::Validator seconds() {
  return number_in(1e-3, 30 * 86400);
}

}  // namespace ca2
