#include "core/io/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <set>
#include <sstream>

namespace ca2 {
namespace {

/// More are of no use to a person.
constexpr std::size_t max_problems = 50;

std::string place(const std::string& name, const YAML::Mark& mark) {
  if (mark.is_null()) return name;
  return name + ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
}

/// Builds the tree from yaml-cpp's events: its own nodes know neither duplicate keys nor a bound on depth.
class TreeBuilder final : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const std::string& name) : name_(name) {}

  /// Thrown through the parser where going on would be harmful.
  struct Refused {};

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    add(mark, {});
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse_anchor(mark, 1);
    add(mark, {});
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    YamlNode node;
    // The tag "!" is yaml-cpp's word for a quoted scalar, "?" for a plain one.
    node.quoted = tag == "!";
    const bool null = !node.quoted && (value.empty() || value == "~" || value == "null");
    node.kind = null ? YamlNode::Kind::null : YamlNode::Kind::scalar;
    node.text = value;
    add(mark, std::move(node));
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::sequence);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor, YamlNode::Kind::map);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

  void problem(const std::string& where, std::string what, std::string hint = {}) {
    problems.push_back({where, std::move(what), std::move(hint)});
    if (problems.size() >= max_problems) throw Refused{};
  }

  YamlNode root;
  std::vector<Problem> problems;

 private:
  struct Level {
    YamlNode node;
    std::set<std::string> keys;  // of a map, those seen so far
    bool key_is_next = true;     // of a map
    YamlNode key;
  };

  void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    // A few lines of aliases of aliases make a document of 2^100 values.
    if (anchor != YAML::NullAnchor) {
      problem(place(name_, mark), "anchors and aliases are not allowed", "write the value out");
    }
  }

  void open(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind) {
    refuse_anchor(mark, anchor);
    if (levels_.size() >= max_yaml_depth) {
      problem(place(name_, mark), "values nest deeper than " + std::to_string(max_yaml_depth) + " levels");
      throw Refused{};
    }
    Level level;
    level.node.kind = kind;
    level.node.line = mark.line + 1;
    level.node.column = mark.column + 1;
    levels_.push_back(std::move(level));
  }

  void close() {
    YamlNode node = std::move(levels_.back().node);
    levels_.pop_back();
    store(std::move(node));
  }

  void add(const YAML::Mark& mark, YamlNode node) {
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    store(std::move(node));
  }

  void store(YamlNode node) {
    if (levels_.empty()) {
      root = std::move(node);
      return;
    }
    Level& level = levels_.back();
    if (level.node.is_map() && level.key_is_next) {
      level.key = std::move(node);
      level.key_is_next = false;
      return;
    }
    if (level.node.is_map()) {
      level.key_is_next = true;
      const YamlNode& key = level.key;
      const std::string where = name_ + ":" + std::to_string(key.line) + ":" + std::to_string(key.column);
      if (!key.is_scalar()) {
        problem(where, "a key must be a word");
        return;
      }
      if (!level.keys.insert(key.text).second) {
        problem(where, "the key '" + key.text + "' is given twice");
        return;
      }
      node.key = key.text;
      node.key_line = key.line;
      node.key_column = key.column;
    }
    level.node.items.push_back(std::move(node));
  }

  const std::string& name_;
  std::vector<Level> levels_;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view name) const {
  if (!is_map()) return nullptr;
  const auto found =
      std::find_if(items.begin(), items.end(), [&](const YamlNode& item) { return item.key == name; });
  return found == items.end() ? nullptr : &*found;
}

Result<YamlNode> parse_yaml(const std::string& text, const std::string& name, ErrorCode code) {
  if (text.size() > max_yaml_bytes) {
    return fail(code, name, "is larger than " + std::to_string(max_yaml_bytes) + " bytes");
  }
  if (text.find('\0') != std::string::npos) {
    return fail(code, name, "has zero bytes in it: it is not a text");
  }
  TreeBuilder builder(name);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    TreeBuilder ignored(name);
    if (parser.HandleNextDocument(ignored)) {
      builder.problem(name, "holds more than one YAML document",
                      "remove everything from the second '---' on");
    }
  } catch (const YAML::Exception& error) {
    builder.problems.push_back({place(name, error.mark), "is not valid YAML: " + error.msg, {}});
  } catch (const TreeBuilder::Refused&) {
    // The problem is listed.
  }
  if (!builder.problems.empty()) return fail(code, std::move(builder.problems));
  return std::move(builder.root);
}

}  // namespace ca2
