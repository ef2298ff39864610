// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The manual page: what the parser knows, between paragraphs that it does not know.

#include <string_view>

#include "station/command/reference.h"

namespace dubsar {

namespace {

/// Text as man(7) takes it: no control lines, dashes that can be copied into a shell.
std::string roff(std::string_view text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) {
      out += "\\&";
    }
    line_begins = c == '\n';
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string option_entry(const ReferenceOption& option) {
  std::string out = ".TP\n";
  if (option.names.empty()) {
    out += italic(option.positional) + (option.repeats ? " ..." : "");
  } else {
    for (std::size_t i = 0; i < option.names.size(); ++i) {
      out += (i == 0 ? "" : ", ") + bold(option.names[i]);
    }
    if (!option.word.empty()) {
      out += " " + italic(option.word) + (option.repeats ? " ..." : "");
    }
  }
  out += "\n" + roff(option.help.empty() ? "Required." : option.help);
  std::string more;
  const auto add = [&more](const std::string& what) { more += (more.empty() ? "" : "; ") + what; };
  for (const std::string& choice : option.choices) {
    more += (more.empty() ? "one of " : ", ") + choice;
  }
  if (!option.bounds.empty()) {
    add(option.bounds);
  }
  if (!option.standard.empty()) {
    add("otherwise " + option.standard);
  }
  if (option.required && !option.help.empty()) {
    add("required");
  }
  return out + (more.empty() ? "" : " (" + roff(more) + ")") + "\n";
}

std::string synopsis_of(const ReferenceVerb& verb) {
  std::string out = bold("dubsar " + verb.path());
  for (const ReferenceOption& option : verb.options) {
    if (option.names.empty()) {
      const std::string word = italic(option.positional) + (option.repeats ? " ..." : "");
      out += option.required ? " " + word : " [" + word + "]";
    } else if (option.required) {
      out += " " + bold(option.names.front()) + " " + italic(option.word);
    }
  }
  return out + (verb.verbs.empty() ? " [" + italic("options") + "]" : " " + italic("verb")) + "\n";
}

constexpr const char* kDescription = R"(.SH DESCRIPTION
.B dubsar
is the station beside a laser\-triangulation scanner for cuneiform tablets. It registers every range grid as it
arrives, marks under\-sampled clay, says where to scan next and when a tablet is conclusively scanned, stitches
the grids into one 2\-manifold mesh, and measures the wedges on it.
.PP
Lengths are millimetres, angles degrees.
.SH OPTIONS
These are taken before or after every verb.
)";

constexpr const char* kAfter = R"(.SH "EXIT STATUS"
.TP
.B 0
done
.TP
.B 1
ran, but the result falls short: not conclusive, a scan not registered, a verification that failed, stopped
.TP
.B 2
bad usage or bad input
.TP
.B 3
a device failed
.TP
.B 4
internal error, the disk refused, or another program is writing there; nothing that was stored is lost
.PP
An error is one line on standard error: where, what, and the mend.
.SH ENVIRONMENT
.TP
.B DUBSAR_DRIVER_PATH
folders with driver plugins, parted by colons, looked into before the program's own
.TP
.B DUBSAR_ARRAYS
.B files
or
.BR memory :
where large arrays lie; without it they go into files when memory is short
.TP
.B TMPDIR
the folder of those files, otherwise
.IR /var/tmp ;
they have no names and never outlive the program
.TP
.B XDG_DATA_HOME
.I dubsar/drivers
in it (otherwise in
.IR ~/.local/share )
is the user's folder of driver plugins
.TP
.B XDG_CONFIG_HOME
.I dubsar
in it (otherwise in
.IR ~/.config )
keeps what the window remembers
.SH FILES
.TP
.I session.sqlite, grids/NNN.grid
of a session's folder: what happened, in order, and the stored scans
.TP
.I /usr/lib/dubsar/drivers
driver plugins, where the program is
.I /usr/bin/dubsar
.TP
.I /usr/lib/udev/rules.d/60\-dubsar.rules
who may use cameras and stages
.TP
.I /usr/share/doc/dubsar
guides, file formats, licences
.SH EXAMPLES
.TP
.B dubsar drivers
what can be scanned with
.TP
.B dubsar scan \-\-auto \-\-device \(aqsim:?seed=1\(aq \-\-session S
a simulated tablet, until it is conclusive
.TP
.B dubsar scan \-\-device \(aqreplay:scans?unit=m\(aq \-\-session S
a folder of range grids
.TP
.B dubsar stitch S \-o model.ply; dubsar analyze model.ply \-o wedges.json
its mesh and its wedges
.TP
.B dubsar verify S
is every stored byte what was stored?
)";

}  // namespace

std::string manual_page(const std::vector<ReferenceVerb>& verbs, const std::string& version) {
  std::string out = ".\\\" Made by dubsar reference man.\n.TH DUBSAR 1 \"\" \"Dubsar " + version +
                    "\" \"User Commands\"\n.SH NAME\ndubsar \\- scan cuneiform tablets with a laser scanner\n"
                    ".SH SYNOPSIS\n" +
                    bold("dubsar") + " " + italic("verb") + " [" + italic("options") + "]\n" + kDescription;
  for (const ReferenceOption& option : verbs.front().options) {
    out += option_entry(option);
  }
  out += ".SH VERBS\n";
  for (std::size_t i = 1; i < verbs.size(); ++i) {
    out +=
        ".SS " + roff(verbs[i].path()) + "\n" + synopsis_of(verbs[i]) + ".PP\n" + roff(verbs[i].help) + ".\n";
    for (const ReferenceOption& option : verbs[i].options) {
      if (option.names.empty() || option.names.back() != "--help") {
        out += option_entry(option);
      }
    }
  }
  return out + kAfter;
}

}  // namespace dubsar
