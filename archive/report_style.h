// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

namespace dubsar {

/// The report's only style sheet. No font, picture or script from outside; black on white paper in print.
inline constexpr const char* kReportStyle = R"css(
:root { --ink: #1d1b19; --soft: #6b645c; --rule: #d9d2c7; --paper: #fff; --red: #b3161f; --green: #2f6b45; }
* { box-sizing: border-box; }
html { background: var(--paper); color: var(--ink); }
body { margin: 0; font: 17px/1.55 "Iowan Old Style", "Palatino Linotype", Palatino, "Book Antiqua", Georgia,
  "DejaVu Serif", serif; font-variant-numeric: oldstyle-nums; }
main { max-width: 62rem; margin: 0 auto; padding: 3.5rem 1.5rem 5rem; }
h1, h2, h3, p, li, dt, dd, th, td, figcaption { unicode-bidi: plaintext; }
h1, h2, h3, p, li, dt, dd { text-align: left; }
header { border-bottom: 1px solid var(--rule); padding-bottom: 1.2rem; margin-bottom: 2rem; }
.kicker { margin: 0; color: var(--soft); font-variant-caps: all-small-caps; letter-spacing: .09em; }
h1 { font-size: 2.3rem; line-height: 1.15; font-weight: 500; margin: .2rem 0 1rem; overflow-wrap: anywhere; }
h2 { font-size: 1.3rem; font-weight: 600; margin: 0 0 .7rem; }
h3 { font-size: 1.05rem; font-weight: 600; margin: 1.4rem 0 .5rem; }
section { margin: 0 0 2.8rem; }
p, ul, ol { margin: 0 0 .8rem; max-width: 44rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1.4rem; margin: .8rem 0 0; }
dt { color: var(--soft); }
dd { margin: 0; overflow-wrap: anywhere; }
.aside, figcaption { color: var(--soft); font-size: .88em; }
.verdict { border-left: 5px solid var(--red); padding: .9rem 1.3rem .3rem; background: #f9efe9; }
.verdict.yes { border-color: var(--green); background: #eef4ee; }
.verdict h2 { font-size: 1.7rem; color: var(--red); margin-bottom: .3rem; }
.verdict.yes h2 { color: var(--green); }
.cross { display: grid; justify-items: center; align-items: center; gap: 1rem 3mm; margin: 0 auto .8rem;
  max-width: calc(var(--wide) * var(--scale) + 6mm);
  grid-template-columns: minmax(0, var(--left)) minmax(0, var(--column)) minmax(0, var(--right));
  grid-template-areas: ". top ." "left obverse right" ". bottom ." ". reverse bar"; }
.cross figure { width: 100%; }
.bar { align-self: end; justify-self: stretch; white-space: nowrap; color: var(--soft); font-size: .88em; text-align: left; }
.bar::before { content: ""; display: block; width: var(--share); height: 7px; margin-bottom: .2rem;
  border: solid var(--ink); border-width: 0 1px 2px; }
figure { margin: 0; text-align: center; }
figure img { display: block; margin: 0 auto .25rem; max-width: 100%; }
.cross img { width: var(--share); height: auto; max-width: none; }
.sheet img { width: auto; height: auto; max-height: 60rem; }
.swatch { display: inline-block; width: .8em; height: .8em; margin: 0 .35em 0 1em; border: 1px solid #0003; }
.swatch.ring { border: 2px solid #143cc8; border-radius: 50%; }
.places { display: grid; grid-template-columns: repeat(auto-fill, minmax(13rem, 1fr)); gap: 1.2rem; margin: 0 0 1.4rem; }
.places figure { text-align: left; }
.places img { width: 100%; height: auto; border: 1px solid var(--rule); }
.places figcaption { line-height: 1.35; overflow-wrap: anywhere; }
.places figcaption b { color: #143cc8; font-variant-numeric: lining-nums; }
.places .open figcaption, .void { color: var(--red); }
.signed code { font: .8rem/1.3 "DejaVu Sans Mono", Consolas, monospace; overflow-wrap: anywhere; }
.line { border-bottom: 1px solid var(--ink); padding-top: 2.2rem; max-width: 26rem; color: var(--soft); font-size: .88em; }
.wide { overflow-x: auto; }
@media screen and (max-width: 48rem) {
  main { padding: 1.5rem 1rem 3rem; }
  dl { grid-template-columns: 1fr; gap: 0; }
  dd { margin-bottom: .4rem; }
  .wide { border-right: 1px dotted var(--soft); }
  .faces, .sampling, .regions { min-width: 40rem; }
  .scans { min-width: 48rem; }
}
table { border-collapse: collapse; font-size: .88rem; line-height: 1.35; font-variant-numeric: tabular-nums lining-nums;
  border-top: 2px solid var(--ink); border-bottom: 1px solid var(--ink); }
th { text-align: left; font-weight: 600; padding: .35rem .9rem .35rem 0; border-bottom: 1px solid var(--ink);
  vertical-align: bottom; }
td { padding: .28rem .9rem .28rem 0; border-bottom: 1px solid var(--rule); vertical-align: top;
  overflow-wrap: break-word; }
.scans td:nth-child(2), td:last-child { overflow-wrap: anywhere; min-width: 7rem; }
.regions tr.open td:nth-child(2), .scans tr.open td:nth-child(3), .faces tr.open td:last-child { color: var(--red); }
tr.sum td { border-top: 1px solid var(--ink); font-weight: 600; }
.faces td:nth-child(n+2):nth-child(-n+6), .faces th:nth-child(n+2):nth-child(-n+6),
.sampling td:nth-child(n+2), .sampling th:nth-child(n+2),
.scans td:nth-child(n+4):nth-child(-n+10), .scans th:nth-child(n+4):nth-child(-n+10),
.regions td:nth-child(5), .regions th:nth-child(5), .times td:nth-child(2), .times th:nth-child(2)
  { text-align: right; }
footer { border-top: 1px solid var(--rule); padding-top: 1rem; color: var(--soft); font-size: .88em; }
@page { margin: 15mm; }
@media print {
  html { background: #fff; }
  body { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  section { break-inside: auto; margin-bottom: 8mm; }
  h2, h3 { break-after: avoid; }
  table { font-size: 8.5pt; }
  th, td { padding-right: .5rem; }
  .places { grid-template-columns: repeat(4, 1fr); gap: 4mm; }
  .places figcaption { font-size: 7.5pt; }
  .verdict { background: none; }
  figure, tr, .cross { break-inside: avoid; }
  .cross { --scale: var(--print-scale) !important; }
  .sheet img { max-height: 215mm; }
  .wide { overflow: visible; }
}
)css";

}  // namespace dubsar
