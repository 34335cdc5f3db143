// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::report {

/// A page in Mustache: {{...}} is escaped, {{{...}}} is a picture of this program and is not escaped. Elements are closed as XML requires,
/// so that any XML tool can check and parse the page. Sizes are in rem, so that the whole page shrinks to one A4 page on paper.
inline constexpr const char* kPageTemplate = R"html(<!DOCTYPE html>
<html xmlns="http://www.w3.org/1999/xhtml" lang="{{language}}" xml:lang="{{language}}">
<head>
<meta charset="utf-8" />
<meta name="generator" content="{{mark}}" />
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'" />
<meta name="viewport" content="width=device-width, initial-scale=1" />
<title>{{title}}{{#subtitle}}: {{subtitle}}{{/subtitle}}</title>
<style>
html { font-size: 15px; }
body { font-family: system-ui, sans-serif; font-variant-numeric: tabular-nums; line-height: 1.3; color: #000; background: #fff;
  margin: 1.5rem auto; max-width: 84rem; padding: 0 1.5rem; }
h1 { font-size: 1.7rem; margin: 0 0 0.6rem; }
h2 { font-size: 1.1rem; margin: 0 0 0.3rem; }
dl.facts { display: grid; grid-template-columns: auto minmax(0, 1fr); gap: 0.1rem 0.8rem; margin: 0 0 0.8rem; }
dl dt { color: #555; }
dl dd { margin: 0; overflow-wrap: anywhere; }
p.alert { border: 1px solid #D55E00; border-left-width: 0.4rem; background: #FDF1E8; font-weight: bold; margin: 0 0 0.4rem; padding: 0.2rem 0.6rem; }
section { display: grid; grid-template-columns: minmax(0, 1fr); gap: 0 2rem; }
figure, div.block { margin: 0 0 0.9rem; break-inside: avoid; }
figure svg { width: 100%; height: auto; display: block; overflow: visible; }
table { border-collapse: collapse; width: 100%; }
th { color: #555; font-weight: normal; text-align: left; vertical-align: bottom; border-bottom: 1px solid #999; }
th, td { padding: 0 0.5rem 0 0; }
th.number, td.number { text-align: right; }
td.number { white-space: nowrap; }
td.heading { color: #555; font-weight: bold; padding-top: 0.15rem; }
tbody tr:hover { background: #eee; }
div.block p { margin: 0.15rem 0 0; overflow-wrap: anywhere; }
p.footnote { color: #555; font-size: 0.88rem; }
@media print, (min-width: 50rem) {
  dl.facts { grid-template-columns: repeat(3, auto minmax(0, 1fr)); }
  section.pictures { grid-template-columns: repeat(2, minmax(0, 1fr)); }
}
@media print, (min-width: 80rem) { section.tables { grid-template-columns: repeat(2, minmax(0, 1fr)); } }
footer { margin: 1.2rem 0 0; color: #595959; font-size: 0.85rem; }
@media screen { div.block { overflow-x: auto; } }
@media print {
  @page { size: A4; margin: 9mm; }
  html { font-size: 7.8px; }
  body { margin: 0; max-width: none; padding: 0; line-height: 1.22; }
  section { gap: 0 5mm; }
  p.alert { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
</style>
</head>
<body>
<main>
<h1>{{title}}{{#subtitle}}: {{subtitle}}{{/subtitle}}</h1>
<dl class="facts">
{{#facts}}<dt>{{name}}</dt><dd>{{value}}</dd>
{{/facts}}</dl>
{{#alerts}}<p class="alert" role="note">{{text}}</p>
{{/alerts}}
{{#sections}}<section class="{{kind}}">
{{#columns}}<div>
{{#blocks}}{{#is_figure}}<figure>
<h2>{{title}}</h2>
{{{svg}}}</figure>
{{/is_figure}}{{#is_table}}<div class="block">
<h2>{{title}}</h2>
<table>
<thead><tr>{{#heads}}<th scope="col"{{#is_number}} class="number"{{/is_number}}>{{text}}</th>{{/heads}}</tr></thead>
<tbody>
{{#rows}}<tr>{{#cells}}<td{{#is_number}} class="number"{{/is_number}}{{#is_heading}} class="heading" colspan="{{across}}"{{/is_heading}}>{{#has_link}}<a href="{{link}}">{{text}}</a>{{/has_link}}{{^has_link}}{{text}}{{/has_link}}</td>{{/cells}}</tr>
{{/rows}}</tbody>
</table>
{{#footnotes}}<p class="footnote">{{text}}</p>
{{/footnotes}}</div>
{{/is_table}}{{#is_notes}}<div class="block">
<h2>{{title}}</h2>
{{#items}}<p>{{text}}</p>
{{/items}}</div>
{{/is_notes}}{{/blocks}}</div>
{{/columns}}</section>
{{/sections}}
<footer>{{intended_use}}</footer>
</main>
</body>
</html>
)html";

}  // namespace dts::report
