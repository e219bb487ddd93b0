/// @file GLib's objects and errors with owners.
#pragma once

#include <arv.h>

#include <memory>
#include <string>

namespace ca2 {

struct GObjectUnref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
template <class T>
using GObjectPtr = std::unique_ptr<T, GObjectUnref>;

struct GFree {
  void operator()(gpointer memory) const { g_free(memory); }
};
template <class T>
using GMemory = std::unique_ptr<T, GFree>;

/// Where a GLib function reports to.
class GErrorHolder {
 public:
  GErrorHolder() = default;
  GErrorHolder(const GErrorHolder&) = delete;
  GErrorHolder& operator=(const GErrorHolder&) = delete;
  ~GErrorHolder() { g_clear_error(&error_); }

  /// For the next call; forgets the last one's error.
  GError** out() {
    g_clear_error(&error_);
    return &error_;
  }
  explicit operator bool() const { return error_ != nullptr; }
  std::string text() const { return error_ ? error_->message : "unknown error"; }
  bool is(GQuark domain, int code) const { return g_error_matches(error_, domain, code); }

 private:
  GError* error_ = nullptr;
};

inline std::string text_or_empty(const char* text) {
  return text ? text : "";
}

}  // namespace ca2
