// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sentences of the engine whose words stand around a name or a number: no phrase holds those.
#include <regex>
#include <span>
#include <string_view>
#include <utility>

#include "ui/shell/engine_words.h"

namespace dubsar::ui {

namespace {

/// What the system says of a file or a device.
constexpr std::pair<std::string_view, std::string_view> kOfTheSystem[] = {
    {"No such file or directory", "keine solche Datei, kein solcher Ordner"},
    {"Permission denied", "keine Berechtigung"},
    {"Operation not permitted", "nicht erlaubt"},
    {"No space left on device", "kein Platz mehr auf dem Datenträger"},
    {"Disk quota exceeded", "der zugeteilte Platz ist verbraucht"},
    {"Input/output error", "Fehler beim Lesen oder Schreiben"},
    {"Read-only file system", "der Datenträger ist schreibgeschützt"},
    {"Is a directory", "es ist ein Ordner"},
    {"File name too long", "der Name ist zu lang"},
    {"Not a directory", "es ist kein Ordner"},
    {"Too many open files", "zu viele offene Dateien"},
};

struct Rule {
  std::regex english;
  const char* german;
};

std::string by_rules(std::string text, std::span<const Rule> rules) {
  constexpr std::size_t kLongest = 4000;  // std::regex goes as deep as a name is long
  if (text.size() > kLongest) {
    return text;
  }
  for (const Rule& rule : rules) {
    text = std::regex_replace(text, rule.english, rule.german);
  }
  return text;
}

}  // namespace

std::string with_german_names(const std::string& text) {
  static const Rule kRules[] = {
      {std::regex("\\bsetting (\\S+) takes "), "Einstellung $1: zulässig ist "},
      {std::regex("\\b(setting|option) (\\S+) cannot be '"), "$2 kann nicht sein: '"},
      {std::regex("\\boption (\\S+) is given twice"), "die Option $1 steht zweimal da"},
      {std::regex("\\bno setting (\\S+) to read"), "keine Einstellung $1 zum Lesen"},
      {std::regex("\\bno setting (\\S+) to change"), "keine Einstellung $1 zum Ändern"},
      {std::regex("\\bno (dubsar_\\S+) in it"), "es fehlt $1"},
      {std::regex("\\b(owns|may write to) it\\b"), "$1 sie"},
      {std::regex("\\belement (\\S+) (?=has |stands )"), "Element $1 "},
      {std::regex(": not JSON from byte ([0-9]+) on"), ": kein JSON ab Byte $1"},
      {std::regex(" stands where a count from 1 to ([0-9]+) belongs"),
       " steht statt einer Anzahl von 1 bis $1"},
      {std::regex(" numbers where ([0-9]+) belong"), " Zahlen statt $1"},
      {std::regex("(\"xxh128\"), out\\b"), "$1"},
      {std::regex("\\bis not (?=m, cm, mm)"), "ist nicht "},
      {std::regex(", not m, cm, mm, um or in"), ", nicht m, cm, mm, um oder in"},
      {std::regex("\\bm, cm, mm, um or in"), "m, cm, mm, um oder in"},
      {std::regex("(obj_info \\S+) is not three numbers"), "$1 ist nicht drei Zahlen"},
      {std::regex("(obj_info \\S+) is not a length"), "$1 ist keine Länge"},
      {std::regex("(obj_info \\S+) is not a direction"), "$1 ist keine Richtung"},
      {std::regex("(obj_info \\S+) is not a whole number"), "$1 ist keine ganze Zahl"},
      {std::regex("(^|; )scan again$"), "$1neu scannen"},
      {std::regex("(^|; )there are (?=[a-z0-9_]+:?(,|$))"), "$1es gibt "},
      {std::regex("its pictures are of a (\\S+) stage, this is of a (\\S+) one"),
       "seine Bilder sind von einem Tisch der Art $1, dies ist von einem der Art $2"},
      {std::regex("\\bscans ([0-9]+) and ([0-9]+) lie (?=[0-9.]+ mm apart)"), "die Scans $1 und $2 liegen "},
      {std::regex(" \\(apart from 1 other\\b"), " (neben 1 anderen"},
      {std::regex(" \\(apart from ([0-9]+) others\\b"), " (neben $1 anderen"},
      {std::regex(" and ([0-9]+) more scans?(?=$|;)"), " und $1 weitere"},
      {std::regex("\\b1 scan is stored"), "1 Scan ist gespeichert"},
      {std::regex("\\b([0-9]+) scans are stored"), "$1 Scans sind gespeichert"},
      {std::regex("(\\btype) is not (?=[A-Z])"), "$1 ist nicht "},
      {std::regex("\\bwrite (?=m, cm, mm)"), "zu schreiben ist "},
      {std::regex("(^|; )it has (?=[a-z0-9_]+(,|$))"), "$1es hat "},
      {std::regex("\\baxis (\\S+) (?=turns,|goes straight,)"), "Achse $1 "},
  };
  return by_rules(text, kRules);
}

std::string with_german_numbers(const std::string& english) {
  std::string text = english;
  for (const auto& [from, to] : kOfTheSystem) {
    if (const std::size_t at = text.find(from); at != std::string::npos) {
      text.replace(at, from.size(), to);
    }
  }
  static const Rule kRules[] = {
      {std::regex("(zulässig ist )one of "), "$1eins von "},
      {std::regex("(zulässig ist )a whole number"), "$1eine ganze Zahl"},
      {std::regex("(zulässig ist )a number"), "$1eine Zahl"},
      {std::regex("\\bthere is no scan (?=[0-9])"), "es gibt keinen Scan "},
      {std::regex("\\bno scan (?=[0-9])"), "kein Scan "},
      {std::regex("\\bpoint (?=[0-9])"), "Punkt "},
      {std::regex("\\bscan(s?) (?=[0-9])"), "Scan$1 "},
      {std::regex("(\\bScans [0-9, to]*[0-9]) and (?=[0-9])"), "$1 und "},
      {std::regex("\\bpin (?=[0-9])"), "Nadel "},
      {std::regex("\\bheader line (?=[0-9]+:)"), "Kopfzeile "},
      {std::regex("\\bline (?=[0-9]+[:)])"), "Zeile "},
      {std::regex("\\b(?:vertex|Vertex) (?=[0-9])"), "Punkt "},
      {std::regex("\\bface (?=[0-9])"), "Fläche "},
      {std::regex("\\bsample (?=[0-9]+:)"), "Messpunkt "},
      {std::regex("\\bfacet (?=[0-9]+:)"), "Facette "},
      {std::regex("\\bchunk (?=[0-9])"), "Block "},
      {std::regex("\\bformat (?=')"), "Format "},
      {std::regex("\\bversion (?=[0-9])"), "Version "},
      {std::regex("\\bmore than (?=[0-9])"), "mehr als "},
      {std::regex("\\bfrom (-?[0-9][0-9.e+-]*) to (?=-?[0-9])"), "von $1 bis "},
      {std::regex("([0-9]) to (?=[0-9])"), "$1 bis "},
      {std::regex("([0-9]) of (?=[0-9])"), "$1 von "},
      {std::regex(", not (?=[0-9])"), ", nicht "},
      {std::regex("\\bis (?=-?[0-9]|')"), "ist "},
      {std::regex("\\bhas (?=[0-9]|')"), "hat "},
      {std::regex("\\bholds (?=[0-9])"), "enthält "},
      {std::regex("\\bclaims (?=[0-9])"), "nennt "},
      {std::regex("\\blies (?=[0-9])"), "liegt "},
      {std::regex("([0-9]) bytes\\b"), "$1 Byte"},
      {std::regex("([0-9]) levels\\b"), "$1 Ebenen"},
      {std::regex("([0-9]) entries\\b"), "$1 Einträge"},
      {std::regex("([0-9]) numbers\\b"), "$1 Zahlen"},
      {std::regex("([0-9]) elements\\b"), "$1 Elemente"},
      {std::regex("([0-9]) samples\\b"), "$1 Messpunkte"},
      {std::regex("([0-9]) vertices\\b"), "$1 Punkte"},
      {std::regex("([0-9]) days\\b"), "$1 Tagen"},
  };
  return by_rules(text, kRules);
}

}  // namespace dubsar::ui
