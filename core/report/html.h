/// @file The little HTML that a page without scripts needs.
#pragma once

#include <string>

namespace ca2 {

/// Text as HTML shows it.
std::string escaped(const std::string& raw);
/// An image's source that needs no file: "data:image/jpeg;base64,...".
std::string data_uri(const std::string& type, const std::string& bytes);
/// Style sheet of the report: a phone's width, light and dark, and print.
const char* report_style();

}  // namespace ca2
