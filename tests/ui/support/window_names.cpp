// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/ui/support/window_names.h"

#include <X11/Xlib.h>

#include <span>

namespace dubsar::test {

namespace {

/// A window that goes away meanwhile has no name.
int overlook(::Display* /*display*/, XErrorEvent* /*error*/) {
  return 0;
}

std::string name_of(::Display* display, Window window) {
  constexpr long kMost = 1000;
  const Atom utf8 = XInternAtom(display, "UTF8_STRING", False);
  Atom type = 0;
  int format = 0;
  unsigned long count = 0;
  unsigned long left = 0;
  unsigned char* bytes = nullptr;
  XGetWindowProperty(display, window, XInternAtom(display, "_NET_WM_NAME", False), 0, kMost, False, utf8,
                     &type, &format, &count, &left, &bytes);
  std::string out = bytes != nullptr ? std::string(bytes, bytes + count) : std::string();
  if (bytes != nullptr) {
    XFree(bytes);
  }
  return out;
}

}  // namespace

std::set<std::string> window_names() {
  ::Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) {
    return {};
  }
  XSetErrorHandler(overlook);
  std::set<std::string> out;
  Window root = 0;
  Window parent = 0;
  Window* windows = nullptr;
  unsigned count = 0;
  if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &windows, &count) != 0 &&
      windows != nullptr) {
    for (const Window window : std::span(windows, count)) {
      out.insert(name_of(display, window));
    }
    XFree(windows);
  }
  XCloseDisplay(display);
  return out;
}

}  // namespace dubsar::test
