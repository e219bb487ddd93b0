#include "core/io/yaml.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/io/yaml_reader.h"
#include "core/io/yaml_text.h"

namespace ca2 {
namespace {

std::string error_of(const std::string& text) {
  const auto tree = parse_yaml(text, "f.yaml");
  return tree ? "no error" : tree.error().text();
}

TEST(Yaml, KeepsPlacesAndQuotes) {
  const auto tree = parse_yaml("a: 1\nb:\n  - x\n  - {c: \"2\"}\nd: ~\n", "f.yaml");
  ASSERT_TRUE(tree) << tree.error().text();
  const YamlNode* c = tree->find("b")->items[1].find("c");
  ASSERT_TRUE(c);
  EXPECT_EQ(c->text, "2");
  EXPECT_TRUE(c->quoted);
  EXPECT_EQ(c->line, 4);
  EXPECT_EQ(c->column, 9);
  EXPECT_EQ(c->key_column, 6);
  EXPECT_FALSE(tree->find("a")->quoted);
  EXPECT_TRUE(tree->find("d")->is_null());
  EXPECT_TRUE(parse_yaml("", "f.yaml")->is_null());
}

TEST(Yaml, RefusesWhatIsHostileWithItsPlace) {
  EXPECT_EQ(error_of("a: 1\na: 2\n"), "f.yaml:2:1: the key 'a' is given twice");
  EXPECT_NE(error_of("a: &x 1\nb: *x\n").find("f.yaml:1:4: anchors and aliases"), std::string::npos);
  EXPECT_NE(error_of("a: [1, 2\nb: 3").find("f.yaml:"), std::string::npos);
  EXPECT_NE(error_of("a: 1\n---\nb: 2\n").find("more than one"), std::string::npos);
  EXPECT_NE(error_of("? [1, 2]\n: 3\n").find("f.yaml:1:3: a key must be a word"), std::string::npos);
  EXPECT_NE(error_of(std::string(100000, '[')).find("nest deeper"), std::string::npos);
  EXPECT_NE(error_of(std::string(max_yaml_bytes + 1, ' ')).find("larger than"), std::string::npos);
  EXPECT_NE(error_of(std::string("a: \0b", 5)).find("zero bytes"), std::string::npos);
  EXPECT_NE(error_of("\tx: 1").find("f.yaml:1:"), std::string::npos);
}

TEST(Yaml, AnAliasBombEndsAtOnce) {
  std::string bomb = "a0: &a0 [x, x]\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before + ", " + before + "]\n";
  }
  EXPECT_NE(error_of(bomb).find("anchors and aliases"), std::string::npos);
}

TEST(Yaml, NumbersAreWhatTheyLookLike) {
  const auto number = [](const std::string& text) { return yaml_number(parse_yaml(text, "f").value()); };
  EXPECT_EQ(number("1e3"), 1000.0);
  EXPECT_EQ(number("-.5"), -0.5);
  EXPECT_EQ(number("+2"), 2.0);
  EXPECT_TRUE(std::isinf(number("1e999").value()));
  EXPECT_TRUE(std::isnan(number(".nan").value()));
  for (const char* other :
       {"nan", "inf", "0x10", "1,5", "1 2", "\"1\"", "no", "1_000", "--1", "+-1", "-", "."}) {
    EXPECT_FALSE(number(other)) << other;
  }
}

TEST(Yaml, TextsAndNumbersComeBackExactly) {
  std::mt19937_64 random(3);
  const std::string alphabet = "ab1 :#-'\"\\\n\t{}[],&*!|>%@~y\x01\xc3\xa4.";
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (std::size_t n = random() % 8; n > 0; --n) text += alphabet[random() % alphabet.size()];
    // A lone byte of a UTF-8 sequence is no text.
    if (text.find('\xc3') != std::string::npos || text.find('\xa4') != std::string::npos) continue;
    const auto tree = parse_yaml("key: " + yaml_string(text) + "\n", "f.yaml");
    ASSERT_TRUE(tree) << tree.error().text() << " " << yaml_string(text);
    ASSERT_TRUE(tree->items[0].is_scalar()) << yaml_string(text);
    ASSERT_EQ(tree->items[0].text, text);
  }
  for (const char* text : {"", "yes", "null", "~", "1.5", "on", "weiß", "a: b", "-"}) {
    EXPECT_EQ(parse_yaml("[" + yaml_string(text) + "]", "f").value().items[0].text, text);
  }
  for (int i = 0; i < 2000; ++i) {
    const double value = std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 600) - 300);
    ASSERT_EQ(yaml_number(parse_yaml(exact(-value), "f").value()), -value);
  }
}

TEST(Yaml, SuggestsTheNearestKey) {
  const std::string_view known[] = {"columns", "rows", "square"};
  EXPECT_EQ(suggest("colums", known), "did you mean 'columns'?");
  EXPECT_EQ(suggest("row", known), "did you mean 'rows'?");
  EXPECT_EQ(suggest("temperature", known), "known are: columns, rows, square");
}

}  // namespace
}  // namespace ca2
