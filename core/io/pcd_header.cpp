#include "core/io/pcd_header.h"

#include <algorithm>
#include <charconv>
#include <map>

namespace ca2 {
namespace {

/// Real headers have about eleven lines; a longer one is another kind of file.
constexpr std::size_t max_header_lines = 200;
constexpr std::size_t max_fields = 256;

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr std::string_view blanks = " \t\r\v\f";
  for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(blanks, end);
  }
  return words;
}

template <class Int>
std::optional<Int> to_integer(std::string_view word) {
  Int value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// What is quoted in a message: printable, and not the whole of a binary file.
std::string quoted(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + text + (word.size() > 40 ? "...'" : "'");
}

class HeaderParser {
 public:
  HeaderParser(std::string_view content, const std::string& name) : content_(content), name_(name) {}

  Result<PcdHeader> parse() {
    while (!done_ && position_ < content_.size() && line_ < max_header_lines) {
      ++line_;
      const std::size_t end = std::min(content_.find('\n', position_), content_.size());
      const auto words = split(content_.substr(position_, end - position_));
      position_ = std::min(end + 1, content_.size());
      if (words.empty()) continue;
      if (words[0][0] == '#') {
        comment(words);
      } else if (!entry(words)) {
        // Not a header line at all: whatever follows would only be noise in the report.
        return fail(ErrorCode::data, std::move(problems_));
      }
    }
    if (!done_) {
      problem(line_, "the header has no DATA line", "is this a PCD file, and all of it?");
    } else {
      combine();
    }
    if (!problems_.empty()) return fail(ErrorCode::data, std::move(problems_));
    header_.body = position_;
    header_.body_line = line_ + 1;
    return header_;
  }

 private:
  using Words = std::vector<std::string_view>;

  void problem(std::size_t line, std::string what, std::string hint = {}) {
    problems_.push_back(
        {name_ + ":" + std::to_string(std::max<std::size_t>(line, 1)), std::move(what), std::move(hint)});
  }

  /// Our own writer's "# grid RINGS COLUMNS".
  void comment(const Words& words) {
    if (words.size() != 4 || words[1] != "grid") return;
    header_.rings = to_integer<int>(words[2]).value_or(0);
    header_.columns = to_integer<int>(words[3]).value_or(0);
  }

  bool entry(const Words& words) {
    static constexpr std::string_view known[] = {"VERSION", "FIELDS", "COLUMNS",   "SIZE",   "TYPE", "COUNT",
                                                 "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};
    if (std::find(std::begin(known), std::end(known), words[0]) == std::end(known)) {
      problem(line_, quoted(words[0]) + " is not a PCD header entry",
              entries_.empty() ? "is this a PCD file?" : "");
      return false;
    }
    // COLUMNS is what version 0.5 called FIELDS.
    const std::string key(words[0] == "COLUMNS" ? "FIELDS" : words[0]);
    if (!entries_.emplace(key, Entry{line_, {words.begin() + 1, words.end()}}).second) {
      problem(line_, key + " is given twice");
    }
    done_ = key == "DATA";
    return true;
  }

  struct Entry {
    std::size_t line = 0;
    Words words;
  };

  const Entry* find(const char* key, bool required) {
    const auto found = entries_.find(key);
    if (found != entries_.end()) return &found->second;
    if (required) problem(line_, std::string("the header has no ") + key + " line");
    return nullptr;
  }

  std::optional<std::size_t> size_entry(const char* key, bool required) {
    const Entry* entry = find(key, required);
    if (!entry) return std::nullopt;
    const auto value =
        entry->words.size() == 1 ? to_integer<std::size_t>(entry->words[0]) : std::optional<std::size_t>();
    if (!value) problem(entry->line, std::string(key) + " must be one whole number");
    return value;
  }

  void combine() {
    if (const Entry* version = find("VERSION", false)) {
      static constexpr std::string_view known[] = {"0.7", ".7", "0.6", ".6"};
      if (version->words.size() != 1 ||
          std::find(std::begin(known), std::end(known), version->words[0]) == std::end(known)) {
        problem(version->line, "the version is neither 0.7 nor 0.6");
      }
    }
    combine_fields();
    combine_size();
    const Entry& data = entries_.at("DATA");
    if (data.words.size() == 1 && data.words[0] == "ascii") {
      header_.data = PcdData::ascii;
    } else if (data.words.size() == 1 && data.words[0] == "binary") {
      header_.data = PcdData::binary;
    } else if (data.words.size() == 1 && data.words[0] == "binary_compressed") {
      problem(data.line, "compressed PCD files are not read",
              "convert it: pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1");
    } else {
      problem(data.line, "DATA must be ascii or binary");
    }
  }

  void combine_fields() {
    const Entry* names = find("FIELDS", true);
    const Entry* sizes = find("SIZE", true);
    const Entry* types = find("TYPE", true);
    const Entry* counts = find("COUNT", false);
    if (!names || !sizes || !types) return;
    const std::size_t n = names->words.size();
    if (n == 0 || n > max_fields) {
      problem(names->line, "there must be 1 to " + std::to_string(max_fields) + " fields");
      return;
    }
    bool fits = true;
    for (const auto& [entry, key] : {std::pair(sizes, "SIZE"), {types, "TYPE"}, {counts, "COUNT"}}) {
      if (!entry || entry->words.size() == n) continue;
      problem(entry->line, std::string(key) + " has " + std::to_string(entry->words.size()) +
                               " entries, FIELDS has " + std::to_string(n));
      fits = false;
    }
    if (!fits) return;
    for (std::size_t i = 0; i < n; ++i) {
      combine_field(names->words[i], sizes->words[i], types->words[i],
                    counts ? counts->words[i] : std::string_view("1"), sizes->line);
    }
    if (header_.bytes_per_point > max_pcd_point_bytes) {
      problem(names->line, "a point would have more than " + std::to_string(max_pcd_point_bytes) + " bytes");
    }
  }

  void combine_field(std::string_view name, std::string_view size_word, std::string_view type_word,
                     std::string_view count_word, std::size_t line) {
    const auto size = to_integer<int>(size_word);
    const auto count = to_integer<std::size_t>(count_word);
    const bool is_float = type_word == "F";
    const bool known_type = is_float || type_word == "U" || type_word == "I";
    const bool known_size = size && (*size == 4 || *size == 8 || (!is_float && (*size == 1 || *size == 2)));
    if (!known_type || !known_size) {
      problem(line, "field " + quoted(name) + " has type " + quoted(type_word) + " and size " +
                        quoted(size_word) + "; PCD has F of 4 or 8 bytes, U and I of 1, 2, 4 or 8");
      return;
    }
    if (!count || *count == 0 || *count > max_pcd_point_bytes) {
      problem(line, "field " + quoted(name) + " has the count " + quoted(count_word));
      return;
    }
    header_.fields.push_back(
        {std::string(name), type_word[0], *size, *count, header_.bytes_per_point, header_.values_per_point});
    header_.bytes_per_point += static_cast<std::size_t>(*size) * *count;
    header_.values_per_point += *count;
  }

  void combine_size() {
    const auto width = size_entry("WIDTH", true);
    const auto height = size_entry("HEIGHT", true);
    const auto points = size_entry("POINTS", false);
    if (!width || !height) return;
    // Anything near 2^40 points is far more than any file holds; the bound keeps the product exact.
    constexpr std::size_t limit = std::size_t{1} << 40;
    const std::size_t line = entries_.at("WIDTH").line;
    if (*width > limit || *height > limit || (*width != 0 && *height > limit / *width)) {
      problem(line, "WIDTH and HEIGHT promise more points than any file holds");
      return;
    }
    if (points && *points != *width * *height) {
      problem(entries_.at("POINTS").line, "POINTS is " + std::to_string(*points) + ", WIDTH x HEIGHT is " +
                                              std::to_string(*width * *height));
    }
    header_.width = *width;
    header_.height = *height;
    header_.points = *width * *height;
  }

  std::string_view content_;
  const std::string& name_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  bool done_ = false;
  std::map<std::string, Entry> entries_;
  std::vector<Problem> problems_;
  PcdHeader header_;
};

}  // namespace

const PcdField* PcdHeader::find(std::string_view name) const {
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const PcdField& field) { return field.name == name; });
  return found == fields.end() ? nullptr : &*found;
}

Result<PcdHeader> parse_pcd_header(std::string_view content, const std::string& name) {
  if (content.empty()) return fail(ErrorCode::data, name, "is empty");
  return HeaderParser(content, name).parse();
}

}  // namespace ca2
